#include "haptolith/core/files/table.h"

#include <gmock/gmock.h>

#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::array<std::string_view, 3> kNames{"code", "x", "yes"};
constexpr std::array<std::string_view, 1> kCodes{"code"};
constexpr TableFormat kFormat{
    .columns = kNames, .limits = {.bytes = 1 << 20, .line_bytes = 1000, .rows = 5}, .codes = kCodes};

/// The column x of a table.
std::vector<double> numbersIn(const std::string& text) {
  std::istringstream stream(text);
  Table table(stream, "a.csv", kFormat);
  const Table::Column x = table.columns(std::array<std::string_view, 1>{"x"})[0];
  std::vector<double> numbers;
  while (table.next()) {
    numbers.push_back(table.number(x));
  }
  return numbers;
}

/// All cells of a table, rows after each other.
std::vector<std::string> cellsIn(const std::string& text) {
  std::istringstream stream(text);
  Table table(stream, "a.csv", kFormat);
  std::vector<std::string> cells;
  while (table.next()) {
    cells.insert(cells.end(), table.cells().begin(), table.cells().end());
  }
  return cells;
}

std::string refusalOf(const std::string& text) {
  try {
    (void)numbersIn(text);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "no refusal";
}

TEST(Table, ReadsNumbersAsPeopleWriteThem) {
  EXPECT_THAT(numbersIn("x\n1\n+1.5\n1e3\n-.5\n"), ElementsAre(1, 1.5, 1000, -0.5));
  EXPECT_THAT(numbersIn("x;code\n1,5;a\n-1,5e-1;b\n2;c\n"), ElementsAre(1.5, -0.15, 2));
  EXPECT_THAT(numbersIn("X\tcode\n1.5\ta\n"), ElementsAre(1.5));
  for (const char* word : {"+-1", "++1", "+", "1 2", "1.5.2", "0x1", "1_000", "5%", "inf", "1e999", "NA", "''"}) {
    EXPECT_THAT(refusalOf(std::string("code,x\na,") + word + "\n"), HasSubstr("a.csv:2: column x = '")) << word;
  }
}

TEST(Table, HasOneDecimalMark) {
  EXPECT_THAT(refusalOf("x;code\n1,5;a\n2.5;b\n"), HasSubstr("a.csv:3: column x = '2.5' is not valid: must be a number "
                                                             "with a decimal comma, as in line 2"));
  EXPECT_THAT(refusalOf("x;code\n1.234,5;a\n"), HasSubstr("a finite number"));
  EXPECT_THAT(refusalOf("x,code\n\"1,5\",a\n"), HasSubstr("decimal commas take ; or tabs"));
}

TEST(Table, TakesTheSeparatorThatGivesItsNames) {
  EXPECT_THAT(numbersIn("a;b;c;d,x\n1,2\n"), ElementsAre(2)) << "one cell is called a;b;c;d";
  EXPECT_THAT(numbersIn("x;\"a,b,c,d\"\n1;2\n"), ElementsAre(1));
  EXPECT_THAT(numbersIn("sep=\t\r\nx\tcode\r\n1,5\tb\r\n"), ElementsAre(1.5));
}

TEST(Table, ReadsQuotesOfSpreadsheetsAndOfR) {
  EXPECT_THAT(cellsIn("code,x\n\"a, \"\"b\"\"\",1\n"), ElementsAre("a, \"b\"", "1"));
  EXPECT_THAT(cellsIn("code,x\n\"a\r\nb\rc\",1\n"), ElementsAre("a\nb\nc", "1"));
  EXPECT_THAT(cellsIn("code,x\n\"say \\\"hm\\\"\",1\n\"C:\\\",2\n"), ElementsAre("say \"hm\"", "1", "C:\\", "2"));
  EXPECT_THAT(cellsIn("code,x\n5\" pipe,1\n"), ElementsAre("5\" pipe", "1")) << "a quote in the middle is a letter";
  EXPECT_THAT(cellsIn("code,x\n \" a \" , 1\n"), ElementsAre("a", "1"));
}

TEST(Table, AHashBeginsACommentOrACode) {
  EXPECT_THAT(cellsIn("code,x\n# 1,2\n#1,2\n#,3\n## x,4\n#x\n\"# 5\",6\n"),
              ElementsAre("#1", "2", "#", "3", "# 5", "6"));
  EXPECT_THAT(cellsIn("x,code\n#1,2\n"), testing::IsEmpty()) << "no code stands first";
  EXPECT_THAT(numbersIn("# made by numpy\n# code, x\n1,2\n"), ElementsAre(2));
  EXPECT_THAT(numbersIn("# columns code, x\nx,yes\n1,2\n"), ElementsAre(1)) << "a heading follows";
}

TEST(Table, KnowsWordsForYesAndNo) {
  std::istringstream text("yes\nTRUE\nT\nyes\nY\n1.0\n");
  Table table(text, "a.csv", kFormat);
  while (table.next()) {
    EXPECT_EQ(table.flag(0U), true) << table.cell(0);
  }
  EXPECT_EQ(table.rows(), 5U);
  std::istringstream other("x;yes\n1;False\n1;0,0\n1;NA\n1;\n1;2\n");
  Table no(other, "b.csv", kFormat);
  for (const std::optional<bool> expected : {std::optional(false), std::optional(false), {}, {}}) {
    ASSERT_TRUE(no.next());
    EXPECT_EQ(no.flag(1U), expected) << no.cell(1);
    EXPECT_EQ(no.isMissing(1U), !expected) << no.cell(1);
  }
  ASSERT_TRUE(no.next());
  EXPECT_THROW((void)no.flag(1U), InvalidParameter);
}

TEST(Table, HasEveryColumnOnce) {
  EXPECT_THAT(refusalOf("x,a,a\n1,2,3\n"), HasSubstr("a.csv:1: header = column 'a' twice"));
  EXPECT_THAT(refusalOf("X,a,x\n1,2,3\n"), HasSubstr("columns 'X' and 'x'"));
  EXPECT_THAT(numbersIn("x,a,A,,\n1,2,3,,\n"), ElementsAre(1)) << "others do not matter, nor names that are empty";
  EXPECT_THAT(refusalOf("yes\n1\n"), HasSubstr("columns x, in any order and among others: there is no x"));
  EXPECT_THAT(refusalOf("1,2\n3,4\n"), HasSubstr("names of columns, code,x,yes among them"));
}

TEST(Table, SaysThatAFileIsCutOff) {
  EXPECT_THAT(refusalOf("code,x\na,1\nb"), AllOf(HasSubstr("a.csv:3: row = 'b'"), HasSubstr("is the file cut off?")));
  EXPECT_THAT(refusalOf("code,x\na,1\nb,1e"), AllOf(HasSubstr("column x = '1e'"), HasSubstr("is the file cut off?")));
  EXPECT_THAT(refusalOf("code,x\na,1\n\"b,1\n"), AllOf(HasSubstr("a.csv:3: quote"), HasSubstr("cut off")));
  EXPECT_THAT(refusalOf("code,x\na,1\nb\n"), testing::Not(HasSubstr("cut off")));
}

TEST(Table, EndsAtItsLimits) {
  EXPECT_THAT(refusalOf("x\n1\n2\n3\n4\n5\n6\n"), HasSubstr("at most 5 rows"));
  EXPECT_THAT(refusalOf("x,code\n1,\"" + std::string(2000, '\n')), HasSubstr("closed within 1000 bytes"));
  EXPECT_THAT(refusalOf("x\n1\n" + std::string(2000, 'a')), HasSubstr("a.csv:3: line"));
}

TEST(TimeColumn, IsInSecondsWhateverItsClockCounts) {
  const auto timesIn = [](const std::string& text) {
    std::istringstream stream(text);
    Table table(stream, "a.csv", kFormat);
    TimeColumn time(table, 0U);
    std::vector<double> times_s;
    while (table.next()) {
      times_s.push_back(time.read());
    }
    return times_s;
  };
  EXPECT_THAT(timesIn("x\n-5\n0\n1e6\n"), ElementsAre(-5, 0, 1e6));
  const std::vector<double> since_1970{1764288000.25, 1764288000.5};
  EXPECT_EQ(timesIn("x\n1764288000.25\n1764288000.5\n"), since_1970);
  EXPECT_EQ(timesIn("x\n1764288000250\n1764288000500\n"), since_1970);
  EXPECT_EQ(timesIn("x\n1764288000250000\n1764288000500000\n"), since_1970);
  EXPECT_EQ(timesIn("x\n1764288000250000000\n1764288000500000000\n"), since_1970);
  try {
    (void)timesIn("x\n\n1\n# a comment\n1.0\n");
    FAIL();
  } catch (const InvalidParameter& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.csv:5: column x = '1.0' is not valid: must be later than 1 s, the time in "
                                        "line 3"));
  }
}

}  // namespace
}  // namespace haptolith

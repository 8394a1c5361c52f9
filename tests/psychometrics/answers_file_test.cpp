#include "haptolith/psychometrics/answers_file.h"

#include <gmock/gmock.h>

#include <sstream>

#include "haptolith/core/error.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

std::vector<AnswersOf> read(const std::string& text) {
  std::istringstream stream(text);
  return readAnswers(stream, "answers.csv").people;
}

std::string refusalOf(const std::string& text) {
  try {
    (void)read(text);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "no refusal";
}

TEST(AnswersFile, RowsOfLevels) {
  const std::vector<AnswersOf> answers = read("# a comment\nx,k,n\n2,3,4\n\n1.5e0, 1, 4\n");
  ASSERT_EQ(answers.size(), 1u);
  ASSERT_EQ(answers[0].levels.size(), 2u);
  EXPECT_EQ(answers[0].levels[0].x, 1.5);
  EXPECT_EQ(answers[0].levels[0].k, 1);
  EXPECT_EQ(answers[0].levels[1].n, 4);
}

TEST(AnswersFile, RowsOfTrials) {
  const std::vector<AnswersOf> answers = read("x,response\n1,1\n1,0\n1,yes\n2,True\n2,no\n2,n/a\n2,\n");
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].levels[0].k, 2);
  EXPECT_EQ(answers[0].levels[0].n, 3);
  EXPECT_EQ(answers[0].levels[1].k, 1);
  EXPECT_EQ(answers[0].levels[1].n, 2);
}

TEST(AnswersFile, ExportOfAStudyPartsPeopleAndBlocks) {
  const std::vector<AnswersOf> answers = read(
      "participant,block,kind,state,level,value,response,note\n"
      "S01,friction,practice,answered,P1,1.21,0,\n"
      "S01,friction,main,answered,P1,1.21,1,\"a, b\"\n"
      "S01,friction,main,lost,P1,1.21,0,\n"
      "S02,friction,main,answered,P1,1.21,0,\n"
      "S01,gravity,main,answered,Mars,3.721,1,\n");
  ASSERT_EQ(answers.size(), 3u);
  EXPECT_EQ(answers[0].participant, "S01");
  EXPECT_EQ(answers[0].block, "friction");
  EXPECT_EQ(answers[0].levels[0].n, 1);
  EXPECT_EQ(answers[0].levels[0].k, 1);
  EXPECT_EQ(answers[1].participant, "S02");
  EXPECT_EQ(answers[2].block, "gravity");
}

TEST(AnswersFile, ColumnNamesAreMatchedWhole) {
  EXPECT_EQ(read("max,x,reaction,response\n9,1,0.3,1\n")[0].levels[0].x, 1);
  EXPECT_THAT(refusalOf("xx,responses\n1,1\n"), HasSubstr("x,k,n"));
}

TEST(AnswersFile, TabsSemicolonsQuotesAndWindowsLineEndsAreUnderstood) {
  EXPECT_EQ(read("x\tk\tn\r\n1\t2\t3\r\n")[0].levels[0].k, 2);
  EXPECT_EQ(read("x;k;n\n1;2;3\n")[0].levels[0].k, 2);
  EXPECT_EQ(read("\xef\xbb\xbf\"x\",\"k\",\"n\"\n\"1\",2,3\n")[0].levels[0].k, 2);
}

TEST(AnswersFile, NonsenseIsToldWithLineAndColumn) {
  EXPECT_THAT(refusalOf("x,k,n\n1,2,3\nabc,2,3\n"), HasSubstr("answers.csv:3: column x = 'abc'"));
  EXPECT_THAT(refusalOf("x,k,n\n1,4,3\n"), HasSubstr(":2: column k"));
  EXPECT_THAT(refusalOf("x,k,n\n1,-1,3\n"), HasSubstr("column k"));
  EXPECT_THAT(refusalOf("x,k,n\n1,1,2.5\n"), HasSubstr("column n"));
  EXPECT_THAT(refusalOf("x,k,n\n1,nan,3\n"), HasSubstr("column k"));
  EXPECT_THAT(refusalOf("x,k,n\n1,2\n"), HasSubstr("answers.csv:2:"));
  EXPECT_THAT(refusalOf("x,response\n1,maybe\n"), HasSubstr(":2: column response"));
  EXPECT_THAT(refusalOf("x,x,k,n\n1,1,2,3\n"), HasSubstr("twice"));
  EXPECT_THAT(refusalOf(""), HasSubstr("nothing in it"));
  EXPECT_THAT(refusalOf("x,k,n\n"), HasSubstr("without a response"));
  EXPECT_THAT(refusalOf("x,k,n\n1,0,0\n"), HasSubstr("without a response"));
}

std::vector<std::string> warningsOf(const std::string& text) {
  std::istringstream stream(text);
  return readAnswers(stream, "answers.csv").warnings;
}

TEST(AnswersFile, ColumnsOfOnesOwnChangeNothing) {
  EXPECT_EQ(read("x,response,state\n1,1,Bavaria\n1,0,\n")[0].levels[0].n, 2);
  EXPECT_EQ(read("x,response,kind\n1,1,square\n1,0,round\n")[0].levels[0].n, 2);
  EXPECT_EQ(read("x,response,kind\n1,1,practice\n1,0,Main\n")[0].levels[0].n, 1) << "words of an export";
  EXPECT_THAT(
      refusalOf("x,response,state\n1,1,answered\n1,0,Bavaria\n"),
      HasSubstr("answers.csv:3: column state = 'Bavaria' is not valid: must be begun, answered, repeated, lost, "
                "as in line 2"));
}

TEST(AnswersFile, ACodeInTwoGroupsIsTwoPeople) {
  const std::string table = "participant,group,x,k,n\n1,A,1,2,3\n2,A,1,2,3\n1,B,1,1,4\n";
  const std::vector<AnswersOf> answers = read(table);
  ASSERT_EQ(answers.size(), 3U);
  EXPECT_EQ(answers[0].levels[0].n, 3);
  EXPECT_EQ(answers[2].group, "B");
  EXPECT_THAT(namesOf(answers), testing::ElementsAre("1 (A)", "2", "1 (B)"));
  EXPECT_THAT(
      warningsOf(table),
      testing::ElementsAre("answers.csv: participant '1' is in the groups 'A', 'B': counted as different participants "
                           "in each group"));
}

TEST(AnswersFile, RowsWithoutACodeAreTold) {
  EXPECT_THAT(
      warningsOf("participant,x,k,n\nS1,1,2,3\n,1,2,4\nNA,1,2,5\n"),
      testing::ElementsAre(HasSubstr(":3: column participant = ''"), HasSubstr(":4: column participant = 'NA'")));
  EXPECT_THAT(warningsOf("x,k,n\n1,2,3\n"), testing::IsEmpty()) << "no codes at all";
}

TEST(AnswersFile, RowsThatRepeatOthersAreTold) {
  const std::string levels = "1,2,3\n2,2,3\n", trials = "1,0\n1,0\n1,1\n2,1\n2,1\n";
  EXPECT_THAT(warningsOf("x,k,n\n" + levels + levels),
              testing::ElementsAre(HasSubstr("answers.csv:4: the same row as in line 2 (and 1 more rows)")));
  EXPECT_THAT(warningsOf("x,response\n" + trials + trials),
              testing::ElementsAre(HasSubstr("answers.csv:7: the rows from here")));
  EXPECT_THAT(warningsOf("x,response\n" + trials), testing::IsEmpty()) << "trials may be alike";
  EXPECT_THAT(warningsOf("trial,x,response\n1,1,1\n1,1,1\n"), testing::SizeIs(1));
}

TEST(AnswersFile, CodesMayBeginWithAHash) {
  const std::vector<AnswersOf> answers = read("participant,x,k,n\n# a comment\n#1,1,2,3\n#2,1,2,3\n");
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers[0].participant, "#1");
}

TEST(AnswersFile, MissingFilesAreToldByName) {
  EXPECT_THROW((void)readAnswersFile("/missing/answers.csv"), InvalidParameter);
  EXPECT_THROW((void)readAnswersFile("/"), InvalidParameter);
}

TEST(AnswersFile, WhatATableHasTooMuchOfIsRefusedWithItsBeginning) {
  const std::string line = refusalOf("x,k,n\n" + std::string(1'000'000, 'x'));
  EXPECT_THAT(line, testing::AllOf(HasSubstr("answers.csv:2: line = 'xxx"), HasSubstr("at most 100000 bytes")));
  EXPECT_LT(line.size(), 300U);
  std::string names = "x,k,n";
  for (int i = 0; i < 1000; ++i) {
    names += ',';
    names += std::to_string(i);
  }
  EXPECT_THAT(refusalOf(names + "\n"), HasSubstr("at most 1000"));
  EXPECT_LT(refusalOf("x,response\n1," + std::string(90'000, '\033') + "\n").size(), 700U);
}

TEST(AnswersFile, WhatHasNoEndIsNoTable) {
  EXPECT_THROW((void)readAnswersFile("/dev/zero"), InvalidParameter);
}

}  // namespace
}  // namespace haptolith

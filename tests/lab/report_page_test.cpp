#include "haptolith/lab/report/report_page.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class ReportPageTest : public testing::Test {
 protected:
  ReportPageTest() { fs::create_directories(folder_); }
  ~ReportPageTest() override { fs::remove_all(folder_); }

  static std::string textOf(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  [[nodiscard]] fs::path draw(const std::string& name) const {
    Figure figure(folder_ / name, 500, 300);
    figure.data("points", {{0, 0}, {1, 900}, {2, 1700}});
    figure.command("plot $points using 1:2 with linespoints title 'shear stress'");
    figure.save();
    return folder_ / name;
  }

  [[nodiscard]] ReportPage page() const {
    return {
        .title = "Virtual soil laboratory",
        .introduction = {"What a bed of macroparticles does in the tests of a soil laboratory.",
                         "Targets are measurements of others."},
        .facts = {{"Preset", "P3"}, {"Gravity", "1.625 m/s²"}},
        .rows = {{.test = "Direct shear",
                  .measured = "friction angle",
                  .target = "36 ± 2°",
                  .contact = {"35.1 ± 0.4°", Verdict::kPass},
                  .icra2021 = {"12 ± 3°", Verdict::kFail}},
                 {.test = "Heap",
                  .measured = "angle of repose",
                  .target = "30 to 38°",
                  .contact = {"33°", Verdict::kPass},
                  .icra2021 = {"no heap", Verdict::kInfo}}},
        .figures = {{draw("shear.svg"), "Shear stress over normal stress"}, {draw("heap.png"), "The heap's surface"}}};
  }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith-report-test-" + std::to_string(getpid()));
};

/// The tags that are still open or were closed in the wrong order, empty when all is well.
std::vector<std::string> unbalancedTags(const std::string& html) {
  static const std::regex kTag(R"(<(/?)([a-z][a-z0-9]*)[^<>]*>)");
  static const std::set<std::string> kWithoutEnd{"meta", "img"};
  std::vector<std::string> open;
  for (std::sregex_iterator tag(html.begin(), html.end(), kTag), end; tag != end; ++tag) {
    const std::string name = (*tag)[2];
    if (kWithoutEnd.contains(name)) {
      continue;
    }
    if ((*tag)[1].length() == 0) {
      open.push_back(name);
    } else if (!open.empty() && open.back() == name) {
      open.pop_back();
    } else {
      open.push_back("/" + name);
    }
  }
  return open;
}

/// The page without its pictures, whose base64 is too long for a regular expression.
std::string withoutPictures(const std::string& html) {
  std::string text;
  std::size_t from = 0;
  for (std::size_t at = html.find("base64,"); at != std::string::npos; at = html.find("base64,", from)) {
    text += html.substr(from, at - from);
    from = html.find('"', at);
  }
  return text + html.substr(from);
}

TEST(HtmlEscaped, LeavesNothingThatABrowserWouldRead) {
  EXPECT_EQ(htmlEscaped("a < b & \"c\" > 'd'"), "a &lt; b &amp; &quot;c&quot; &gt; &#39;d&#39;");
  EXPECT_EQ(htmlEscaped("36 ± 2°"), "36 ± 2°");
}

TEST_F(ReportPageTest, ShowsEveryRowFactAndParagraph) {
  const ReportPage shown = page();
  const std::string html = reportHtml(shown);
  EXPECT_THAT(html, HasSubstr("<title>Virtual soil laboratory</title>"));
  EXPECT_THAT(html, HasSubstr("<h1>Virtual soil laboratory</h1>"));
  for (const std::string& paragraph : shown.introduction) {
    EXPECT_THAT(html, HasSubstr("<p>" + paragraph + "</p>"));
  }
  EXPECT_THAT(html, HasSubstr("<dt>Gravity</dt><dd>1.625 m/s²</dd>"));
  for (const ReportRow& row : shown.rows) {
    EXPECT_THAT(html, HasSubstr("<tr><th scope=\"row\">" + row.test + "</th><td>" + row.measured + "</td><td>" +
                                row.target + "</td><td>" + row.contact.text + " <span"));
    EXPECT_THAT(html, HasSubstr("<td>" + row.icra2021.text + " <span"));
  }
  EXPECT_THAT(html, HasSubstr("<td>12 ± 3° <span class=\"verdict fail\">fail</span></td>"));
  EXPECT_THAT(html, HasSubstr("<td>no heap <span class=\"verdict info\">info</span></td>"));
}

TEST_F(ReportPageTest, IsWellFormed) {
  const std::string html = withoutPictures(reportHtml(page()));
  EXPECT_THAT(html, testing::StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(unbalancedTags(html), testing::IsEmpty());
  EXPECT_THAT(unbalancedTags("<p><b></p>"), Not(testing::IsEmpty()));
}

TEST_F(ReportPageTest, EscapesEveryTextThatCallersGive) {
  const std::string evil = "<script>'\"&";
  ReportPage hostile{.title = evil,
                     .introduction = {evil},
                     .facts = {{evil, evil}},
                     .rows = {{evil, evil, evil, {evil, Verdict::kPass}, {evil, Verdict::kFail}}},
                     .figures = {{draw("a.png"), evil}}};
  const std::string html = withoutPictures(reportHtml(hostile));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(unbalancedTags(html), testing::IsEmpty());
  std::size_t found = 0;
  for (std::size_t at = html.find("&lt;script&gt;&#39;&quot;&amp;"); at != std::string::npos;
       at = html.find("&lt;script&gt;&#39;&quot;&amp;", at + 1)) {
    ++found;
  }
  EXPECT_EQ(found, 12U);  // the title twice, the caption twice
}

TEST_F(ReportPageTest, HasItsFiguresInside) {
  const ReportPage shown = page();
  const std::string html = reportHtml(shown);
  EXPECT_THAT(html, HasSubstr("src=\"data:image/svg+xml;base64," + base64(textOf(shown.figures[0].file)) + "\""));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64," + base64(textOf(shown.figures[1].file)) + "\""));
  EXPECT_THAT(html, HasSubstr("<figcaption>The heap&#39;s surface</figcaption>"));
}

TEST_F(ReportPageTest, NeedsNothingFromOutside) {
  const std::string html = withoutPictures(reportHtml(page()));
  for (const char* outside : {"http", "<script", "<link", "url(", "@import"}) {
    EXPECT_THAT(html, Not(HasSubstr(outside)));
  }
  EXPECT_THAT(html, HasSubstr("prefers-color-scheme: dark"));
}

TEST_F(ReportPageTest, LeavesOutHeadingsWithoutContent) {
  const std::string html = reportHtml({.title = "Empty"});
  EXPECT_THAT(html, Not(ContainsRegex("<h2|<table|<dl")));
  EXPECT_THAT(unbalancedTags(html), testing::IsEmpty());
}

TEST_F(ReportPageTest, IsSavedWhole) {
  const fs::path file = folder_ / "report.html";
  const ReportPage report = page();
  saveReport(file, report);
  EXPECT_EQ(textOf(file), reportHtml(report));
}

TEST_F(ReportPageTest, SavesNothingWhenAFigureIsMissingOrOfAnotherKind) {
  ReportPage broken{.title = "Broken", .figures = {{folder_ / "missing.svg", "no file"}}};
  try {
    saveReport(folder_ / "report.html", broken);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("missing.svg: No such file"));
  }
  broken.figures[0].file = folder_ / "figure.pdf";
  EXPECT_THROW(saveReport(folder_ / "report.html", broken), InvalidParameter);
  std::ofstream(folder_ / "empty.png").close();
  broken.figures[0].file = folder_ / "empty.png";
  EXPECT_THROW(saveReport(folder_ / "report.html", broken), Failure);
  EXPECT_FALSE(fs::exists(folder_ / "report.html"));
}

}  // namespace
}  // namespace haptolith

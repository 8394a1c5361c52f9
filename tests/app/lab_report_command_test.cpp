#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

std::string textOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Reports of the quickest test alone; a result takes about a second.
class LabReportCommand : public testing::Test {
 protected:
  LabReportCommand() { fs::create_directories(folder_); }
  ~LabReportCommand() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string reportIn(const std::string& name, const std::string& options = "") const {
    return fmt::format("lab report --only free-fall --threads 1 --out {} {}", (folder_ / name).string(), options);
  }

  /// A shell command that starts a report, waits until its first result is there, and then does `then` with it ($p).
  [[nodiscard]] std::string stopped(const std::string& name, const std::string& options,
                                    const std::string& then) const {
    return fmt::format(
        "\"$HAPTOLITH\" {} & p=$!; for i in $(seq 6000); do [ -e {} ] && break; sleep 0.005; done; {}; wait $p",
        reportIn(name, options), firstResult(name).string(), then);
  }

  [[nodiscard]] fs::path firstResult(const std::string& name) const {
    return folder_ / name / "results" / "free-fall-contact-1.json";
  }
  [[nodiscard]] std::string page(const std::string& name) const { return textOf(folder_ / name / "report.html"); }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith_report_" + std::to_string(getpid()));
};

TEST_F(LabReportCommand, IsTheSameAfterAnInterruptAsWithoutOne) {
  const ProgramResult whole = runHaptolith(reportIn("whole", "--seeds 2"));
  ASSERT_EQ(whole.exit_status, 0) << whole.errors;
  EXPECT_THAT(whole.errors, ContainsRegex(R"(\[1/4\] free-fall, contact, seed 1: [^0-9]*1\.00000 \([0-9]+ s)"));
  EXPECT_THAT(whole.errors, ContainsRegex(R"(\[4/4\] free-fall, icra2021, seed 2: .* \([0-9]+ s\))"));
  EXPECT_THAT(whole.output, AllOf(HasSubstr("saved " + (folder_ / "whole" / "report.html").string()),
                                  Not(HasSubstr(".json")), Not(HasSubstr(".png"))));

  const ProgramResult interrupted = runInShell(stopped("parts", "--seeds 2", "kill -INT $p"));
  EXPECT_EQ(interrupted.exit_status, 1);
  EXPECT_THAT(interrupted.errors, ContainsRegex("interrupted: [1-3] of 4 results are saved in .*parts; .*--resume"));
  EXPECT_THAT(page("parts"),
              AllOf(HasSubstr("(unfinished)"), ContainsRegex("Missing: free-fall .*icra2021: seeds? .*2"),
                    HasSubstr("of 2 seeds so far)")));
  const std::string first = textOf(firstResult("parts"));

  const ProgramResult resumed = runHaptolith(reportIn("parts", "--seeds 2 --resume"));
  ASSERT_EQ(resumed.exit_status, 0) << resumed.errors;
  EXPECT_THAT(resumed.errors, ContainsRegex("[1-3] of 4 results are already available"));
  EXPECT_EQ(textOf(firstResult("parts")), first);
  EXPECT_EQ(page("parts"), page("whole"));
  EXPECT_THAT(page("whole"), AllOf(HasSubstr("1.00000 ± 0.00000"), HasSubstr("<dt>Seeds</dt><dd>1 to 2</dd>"),
                                   HasSubstr("standard deviation"), Not(HasSubstr("unfinished"))));
}

TEST_F(LabReportCommand, ResultsSurviveAKillAndOneProcessWorksAtATime) {
  const ProgramResult killed = runInShell(
      stopped("parts", "--seeds 1",
              fmt::format("kill -STOP $p; \"$HAPTOLITH\" {}; kill -KILL $p", reportIn("parts", "--resume"))));
  EXPECT_THAT(killed.errors, HasSubstr("another process writes the report in"));
  const json first = json::parse(textOf(firstResult("parts")));
  EXPECT_EQ(first.at("test"), "free-fall");
  EXPECT_EQ(first.at("friction"), "contact");
  EXPECT_EQ(first.at("soil"), "lunar-0-15cm");
  EXPECT_NEAR(first.at("findings").at(0).at("number").get<double>(), 1, 1e-3);
  EXPECT_EQ(first.at("result").at("acceleration_ratio"), first.at("findings").at(0).at("number"));

  const ProgramResult resumed = runHaptolith(reportIn("parts", "--seeds 1 --resume"));
  ASSERT_EQ(resumed.exit_status, 0) << resumed.errors;
  EXPECT_EQ(json::parse(textOf(firstResult("parts"))), first);
  EXPECT_THAT(page("parts"), AllOf(HasSubstr("1.00000 <span"), HasSubstr("Values are of one seed"),
                                   HasSubstr("free-fall: lunar-0-15cm, contact friction, Moon, particles of R = 7 mm, "
                                             "seed 1</figcaption>")));
}

TEST_F(LabReportCommand, ReplacesNothingUnasked) {
  ASSERT_EQ(runHaptolith(reportIn("one", "--seeds 1")).exit_status, 0);
  const std::string before = textOf(firstResult("one"));
  const ProgramResult again = runHaptolith(reportIn("one", "--seeds 1"));
  EXPECT_EQ(again.exit_status, 1);
  EXPECT_THAT(again.errors, AllOf(HasSubstr("already exists"), HasSubstr("--resume"), HasSubstr("--overwrite")));
  const ProgramResult elsewhere = runHaptolith(reportIn("one", "--resume --body Mars --soil dry-sand"));
  EXPECT_EQ(elsewhere.exit_status, 1);
  EXPECT_THAT(elsewhere.errors,
              AllOf(HasSubstr("soil was \"lunar-0-15cm\" and is \"dry-sand\""),
                    HasSubstr("body was \"Moon\" and is \"Mars\""), HasSubstr("seeds was 1 and is 3")));
  EXPECT_EQ(textOf(firstResult("one")), before);
  const ProgramResult anew = runHaptolith(reportIn("one", "--seeds 1 --overwrite --body Mars"));
  ASSERT_EQ(anew.exit_status, 0) << anew.errors;
  EXPECT_EQ(json::parse(textOf(firstResult("one"))).at("body"), "Mars");

  fs::create_directories(folder_ / "mine");
  std::ofstream(folder_ / "mine" / "notes.txt") << "mine";
  for (const char* option : {"--overwrite", "--resume"}) {
    const ProgramResult foreign = runHaptolith(reportIn("mine", option));
    EXPECT_EQ(foreign.exit_status, 1) << option;
    EXPECT_THAT(foreign.errors, HasSubstr("does not contain a report"));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "mine"), {}), 1);
}

TEST_F(LabReportCommand, RefusesNonsense) {
  const auto refuses = [&](const std::string& options, const std::string& why) {
    const ProgramResult result = runHaptolith(reportIn("never", options));
    EXPECT_EQ(result.exit_status, 2) << options;
    EXPECT_THAT(result.errors, HasSubstr(why));
  };
  refuses("--seeds 0", "--seeds: 0 is not valid: must be a whole number, 1 to 100");
  refuses("--only dig", "'dig' is not valid: must be settle");
  refuses("--resume --overwrite", "cannot both be given");
  refuses("--body Nowhere", "Nowhere");
  EXPECT_THAT(runHaptolith("lab report --out old.html").errors, HasSubstr("the name of a folder"));
  EXPECT_FALSE(fs::exists(folder_ / "never"));
}

}  // namespace
}  // namespace haptolith

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "../viewer/ws_client.h"
#include "program.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::json;
namespace fs = std::filesystem;

/// A folder with a study, and what can be done with it without a browser. The whole of it with one:
/// web/tests/browser/whole_study.test.ts.
class StudyRunCommands : public testing::Test {
 protected:
  StudyRunCommands() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~StudyRunCommands() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }
  void makeStudy(const std::string& protocol = "icra2021-friction") const {
    ASSERT_EQ(runHaptolith(fmt::format("study new {} --protocol {} --seed 7", file("a.study"), protocol)).exit_status,
              0);
  }
  /// Until Ctrl-C after a second.
  [[nodiscard]] ProgramResult runForASecond(const std::string& arguments) const {
    return runInShell(fmt::format("timeout --preserve-status -s INT 3 \"$HAPTOLITH\" study {}", arguments));
  }
  [[nodiscard]] Json status() const {
    return Json::parse(runHaptolith("study status --json " + file("a.study")).output);
  }

  fs::path folder_ = fs::path(testing::TempDir()) / fmt::format("haptolith_study_run_{}", getpid());
};

TEST_F(StudyRunCommands, RunRefusesAConsentWithBracketsLeft) {
  makeStudy();
  const ProgramResult run = runForASecond(fmt::format("run {} --port 0", file("a.study")));
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_THAT(run.errors, AllOf(HasSubstr("consent = [DURATION"), HasSubstr("filled in")));
}

TEST_F(StudyRunCommands, RunGivesTheNextCodeAndTwoPages) {
  makeStudy();
  const ProgramResult run = runForASecond(fmt::format("run {} --trial-run --port 0", file("a.study")));
  EXPECT_EQ(run.exit_status, 0) << run.errors;
  EXPECT_THAT(run.errors,
              AllOf(HasSubstr("S01 participates"), HasSubstr("&study=participant"), HasSubstr("&study=experimenter")));
  EXPECT_THAT(run.output, AllOf(HasSubstr("0 responses"), HasSubstr("study resume")));
  EXPECT_EQ(status()["participants"][0]["state"], "stopped") << "its session has ended";
  const Json session = status()["participants"][0]["sessions"][0];
  EXPECT_EQ(session["kind"], "run");
  EXPECT_THAT(session["device"], HasSubstr("(virtual-hand)"));
  EXPECT_EQ(session["loop_rate_hz"], 1000);
  EXPECT_GT(session["ticks"], 0);
  EXPECT_TRUE(session["ended_at"].is_string());
  EXPECT_EQ(session["simulation"], nullptr);
  EXPECT_TRUE(fs::is_directory(folder_ / "a-recordings"));
}

/// `study run` in the background, until the end of the test.
class RunningStudy : public StudyRunCommands {
 protected:
  ~RunningStudy() override {
    if (pid_t pid = 0; std::ifstream(file("pid")) >> pid) {
      kill(pid, SIGINT);
    }
    if (program_.joinable()) {
      program_.join();
    }
  }

  void start(const std::string& arguments = "", const std::string& environment = "",
             const std::string& protocol = "icra2021") {
    makeStudy(protocol);
    program_ = std::thread(
        [command = fmt::format("{} \"$HAPTOLITH\" study run {} --trial-run --port 0 {} > {} 2> {} & echo $! > {}; wait",
                               environment, file("a.study"), arguments, file("out"), file("err"), file("pid"))] {
          std::ignore = std::system(command.c_str());
        });
    for (int i = 0; i < 3000 && said().find("study=experimenter") == std::string::npos; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::smatch found;
    const std::string text = said();
    ASSERT_TRUE(std::regex_search(text, found, std::regex("127.0.0.1:([0-9]+)/.token=([^&]+)&study=participant")))
        << text;
    port_ = static_cast<std::uint16_t>(std::stoi(found[1]));
    participants_ = found[2];
    ASSERT_TRUE(std::regex_search(text, found, std::regex("token=([^&]+)&study=experimenter"))) << text;
    experimenters_ = found[1];
  }
  [[nodiscard]] std::string said() const {
    std::ifstream stream(file("err"));
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] std::unique_ptr<WsClient> pageWith(const std::string& token) const {
    auto page = std::make_unique<WsClient>(port_);
    page->target_ = "/ws?token=" + token;
    EXPECT_EQ(page->upgrade(), 101U);
    return page;
  }
  static Json ask(WsClient& page, Json message) {
    message.update({{"id", 1}, {"do", "study"}});
    page.send(message.dump());
    return page.receive("reply").value_or(Json());
  }

  std::thread program_;
  std::uint16_t port_ = 0;
  std::string participants_, experimenters_;
};

TEST_F(RunningStudy, AParticipantsAddressIsNoExperimenters) {
  start();
  EXPECT_NE(participants_, experimenters_);
  WsClient stranger(port_);
  EXPECT_EQ(stranger.upgrade(), 401U) << "a token is wanted on this machine, too";

  const auto participant = pageWith(participants_);
  const Json scene = participant->receive("scene").value();
  EXPECT_EQ(scene["soil"]["preset"], nullptr);
  EXPECT_EQ(scene["body"], nullptr);
  EXPECT_EQ(scene["sliders"], Json::array());
  EXPECT_EQ(ask(*participant, {{"act", "join"}, {"as", "experimenter"}})["ok"], false);
  EXPECT_EQ(ask(*participant, {{"act", "note"}, {"text", "before joining"}})["ok"], false);
  EXPECT_EQ(ask(*participant, {{"act", "join"}, {"as", "participant"}})["ok"], true);
  EXPECT_EQ(ask(*participant, {{"act", "join"}, {"as", "experimenter"}})["ok"], false) << "nor later";
  for (const char* act : {"pause", "resume", "repeat", "note", "end"}) {
    EXPECT_EQ(ask(*participant, {{"act", act}, {"text", "mine"}, {"reason", "mine"}})["ok"], false) << act;
  }
  const Json shown = participant->receive("study").value();
  EXPECT_EQ(shown["as"], "participant");
  EXPECT_FALSE(shown.contains("next"));

  const auto experimenter = pageWith(experimenters_);
  EXPECT_TRUE(experimenter->receive("scene").value()["body"].is_string());
  EXPECT_EQ(ask(*experimenter, {{"act", "join"}, {"as", "participant"}})["ok"], false);
  EXPECT_EQ(ask(*experimenter, {{"act", "join"}, {"as", "experimenter"}})["ok"], true);
  EXPECT_EQ(ask(*experimenter, {{"act", "note"}, {"text", "sits well"}})["ok"], true);
  EXPECT_TRUE(experimenter->receive("study").value().contains("next"));
  EXPECT_EQ(ask(*experimenter, {{"act", "answer"}, {"choice", 1}})["ok"], false);
}

TEST_F(RunningStudy, NothingThatAParticipantIsSentNamesAStimulus) {
  std::ofstream(file("names.toml")) << R"(title = "A study"
[[block]]
name = "one"
question = "Which was it?"
answers = ["the first", "the second"]
varies = "preset"
reference = "P3"
levels = ["P1", "P6"]
task = "two-interval"
catch_trials = 1
catch_levels = ["P2"]
interval_s = 0.3
[block.scene]
body = "Ceres"
)";
  start("", "", file("names.toml"));
  const auto participant = pageWith(participants_);
  participant->send(R"({"id": 1, "do": "study", "act": "join", "as": "participant"})");
  std::set<std::string> types;
  int trials = 0;
  while (trials < 3) {
    const std::optional<std::string> message = participant->receive();
    ASSERT_TRUE(message) << "after " << trials << " trials";
    if (!participant->gotText()) {
      continue;
    }
    Json told = Json::parse(*message);
    for (const char* name : {"P1", "P2", "P3", "P6", "Ceres", "Moon", "lunar", "icra2021"}) {
      EXPECT_THAT(*message, testing::Not(HasSubstr(fmt::format("\"{}\"", name))));
    }
    for (const char* running : {"time_s", "tick_us", "rate_hz", "remaining_s"}) {  // any number, also a stimulus's
      told.erase(running);
    }
    for (const char* number : {"0\\.835", "0\\.6", "1\\.21"}) {
      EXPECT_THAT(told.dump(), testing::Not(testing::ContainsRegex(fmt::format("[:,\\[]{}[],}}]", number))));
    }
    types.insert(told["type"].get<std::string>());
    if (told["type"] == "study" && told["phase"] == "question" && told["progress"]["trial"] == trials + 1) {
      ++trials;
      participant->send(R"({"id": 2, "do": "study", "act": "answer", "choice": 1})");
    }
  }
  EXPECT_THAT(types, testing::IsSupersetOf({"hello", "scene", "status", "study"}));
}

/// Two blocks of work for a robot in the paper's small bed.
constexpr const char* kPresses = R"(title = "A press far away"
[[block]]
name = "felt"
interval_s = 4
repeats = 1
between_trials_s = 0
[block.teleop]
task = "press"
felt = "model"
round_trip_s = 0.2
site = "icra2021"
[[block]]
name = "unfelt"
interval_s = 4
repeats = 1
between_trials_s = 0
[block.teleop]
task = "press"
felt = "none"
round_trip_s = 0.2
site = "icra2021"
)";

/// The rows of a table without quotes, by their columns.
std::vector<std::map<std::string, std::string>> tableIn(const std::string& file) {
  std::ifstream stream(file);
  std::vector<std::string> heads;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream parts(line);
    std::vector<std::string> fields;
    for (std::string field; std::getline(parts, field, ',');) {
      fields.push_back(field);
    }
    if (heads.empty()) {
      heads = fields;
      continue;
    }
    rows.emplace_back();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      rows.back()[heads[i]] = fields[i];
    }
  }
  return rows;
}

TEST_F(RunningStudy, ARobotBehindALinkFollowsInEachTrialAndIsMeasured) {
  std::ofstream(file("press.toml")) << kPresses;
  start("", "", file("press.toml"));
  const auto participant = pageWith(participants_);
  participant->send(R"({"id": 1, "do": "study", "act": "join", "as": "participant"})");
  bool followed = false, told = false;
  while (!followed || !told) {
    const std::optional<std::string> message = participant->receive();
    ASSERT_TRUE(message) << "followed " << followed << ", told " << told;
    if (participant->gotText()) {
      const Json news = Json::parse(*message);
      followed = followed || (news["type"] == "status" && news["robot"].is_object() &&
                              news["robot"]["state"] == "following" && news["robot"]["learned"].is_null());
      told = told || (news["type"] == "study" && news["work"].is_string());
    }
  }
  for (int i = 0; i < 300 && status()["participants"][0]["state"] == "running"; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  const std::string table = file("press.csv");
  ASSERT_EQ(runHaptolith(fmt::format("study export {} --out {}", file("a.study"), table)).exit_status, 0) << said();
  const auto rows = tableIn(table);
  ASSERT_EQ(rows.size(), 2U);
  for (std::map<std::string, std::string> row : rows) {
    EXPECT_EQ(row["state"], "answered");
    EXPECT_EQ(row["teleop_done"], "0") << "nobody pressed";
    EXPECT_NEAR(std::stod(row["teleop_time_s"]), 4, 0.5);
    EXPECT_GT(std::stod(row["teleop_follows_s"]), 0.2) << "the way there and back";
    EXPECT_EQ(row["recording_state"], "whole");
    EXPECT_EQ(row["x"], "0.2");
  }
  EXPECT_TRUE(fs::exists(folder_ / "a-recordings" / "S01-felt-001-1-first.h5"));
}

TEST_F(StudyRunCommands, AVirtualOperatorDoesWorkForARobot) {
  // In soil of the Moon: a bed of 256 particles is too thin for a model to detect a completed press.
  const std::string on_the_moon = std::regex_replace(std::string(kPresses), std::regex("site = \"icra2021\"\n"), "");
  std::ofstream(file("press.toml")) << "scene = \"teleop-model\"\n"
                                    << std::regex_replace(on_the_moon, std::regex("interval_s = 4"), "interval_s = 60");
  makeStudy(file("press.toml"));
  const ProgramResult run = runHaptolith(fmt::format("study simulate {} --participants 2", file("a.study")));
  ASSERT_EQ(run.exit_status, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("4 trials of robot tasks"));
  ASSERT_EQ(runHaptolith(fmt::format("study export {} --out {}", file("a.study"), file("a.csv"))).exit_status, 0);
  std::set<std::string> times;
  for (std::map<std::string, std::string> row : tableIn(file("a.csv"))) {
    EXPECT_EQ(row["teleop_done"], "1") << row["level"];
    EXPECT_NEAR(std::stod(row["teleop_reached"]), 8, 0.8);
    times.insert(row["teleop_time_s"]);
    if (row["block"] == "unfelt") {
      EXPECT_NEAR(std::stod(row["teleop_force_error"]), 1, 1e-6) << "all that was met was not felt";
    }
  }
  EXPECT_EQ(times.size(), 4U) << "each trial has soils of its own";
  const ProgramResult figure = runHaptolith(fmt::format("study figure --json {}", file("a.study")));
  ASSERT_EQ(figure.exit_status, 0) << figure.errors;
  const Json blocks = Json::parse(figure.output)["teleop"];
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(blocks[1]["measures"][1]["measure"], "task time");
  EXPECT_EQ(blocks[1]["measures"][1]["of_people"]["people"], 2);
  EXPECT_TRUE(blocks[1]["measures"][1]["more_than_first"]["low"].is_number());
  EXPECT_THAT(runHaptolith("study figure " + file("a.study")).output, HasSubstr("task time (s)"));
  EXPECT_THAT(runHaptolith("study status " + file("a.study")).output, HasSubstr("task time (s)"));
  const ProgramResult drawn = runHaptolith(fmt::format("study figure {} --figure {}", file("a.study"), file("a.svg")));
  ASSERT_EQ(drawn.exit_status, 0) << drawn.errors;
  std::ifstream picture(file("a.svg"));
  const std::string svg{std::istreambuf_iterator<char>(picture), {}};
  for (const char* shown : {"task time, s", "error of force, share", "unfelt, 0.2 s"}) {
    EXPECT_THAT(svg, HasSubstr(shown));
  }
  EXPECT_EQ(runHaptolith("study plan --protocol " + file("press.toml")).exit_status, 2);
}

TEST_F(StudyRunCommands, ADelayBeyondItsRangeIsRefused) {
  std::ofstream(file("press.toml")) << std::regex_replace(std::string(kPresses), std::regex("round_trip_s = 0.2"),
                                                          "round_trip_s = 99");
  const ProgramResult run =
      runHaptolith(fmt::format("study new {} --protocol {}", file("a.study"), file("press.toml")));
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_THAT(run.errors, HasSubstr("round_trip_s = 99 is not valid: must be 0 to 20"));
  EXPECT_FALSE(fs::exists(file("a.study")));
}

TEST_F(RunningStudy, TokensThatAreGivenStayTheSame) {
  start("--participant-token the_participants_token", "HAPTOLITH_TOKEN=the_experimenters_token");
  EXPECT_EQ(participants_, "the_participants_token");
  EXPECT_EQ(experimenters_, "the_experimenters_token");
}

TEST_F(StudyRunCommands, WhoHasNotFinishedComesFirst) {
  makeStudy();
  (void)runForASecond(fmt::format("run {} --trial-run --port 0", file("a.study")));
  const ProgramResult next = runForASecond(fmt::format("run {} --trial-run --port 0", file("a.study")));
  EXPECT_EQ(next.exit_status, 1);
  EXPECT_THAT(next.errors, AllOf(HasSubstr("S01 has not finished"), HasSubstr("study resume")));
  const ProgramResult back = runForASecond(fmt::format("resume {} --port 0", file("a.study")));
  EXPECT_EQ(back.exit_status, 0) << back.errors;
  EXPECT_THAT(back.errors, HasSubstr("S01 participates"));
  const ProgramResult other =
      runForASecond(fmt::format("run {} --trial-run --port 0 --participant B2", file("a.study")));
  EXPECT_EQ(other.exit_status, 0) << other.errors;
  EXPECT_EQ(status()["participants"].size(), 2U);
}

TEST_F(StudyRunCommands, NobodyRunsAStudyTwiceAtTheSameTime) {
  makeStudy();
  const ProgramResult both =
      runInShell(fmt::format("\"$HAPTOLITH\" study run {0} --trial-run --port 0 2> {1} & sleep 2; \"$HAPTOLITH\" study "
                             "run {0} --trial-run --port 0; "
                             "code=$?; kill -INT $!; wait; exit $code",
                             file("a.study"), file("first.err")));
  EXPECT_EQ(both.exit_status, 1);
  EXPECT_THAT(both.errors, HasSubstr("a.study")) << both.errors;
}

TEST_F(StudyRunCommands, WrongUseIsToldAndHasStatusTwo) {
  makeStudy();
  for (const auto& [arguments, told] : {
           std::pair<std::string, std::string>{"run --trial-run " + file("none.study"), "none.study"},
           {"run", "study"},
           {"resume " + file("a.study"), "participant"},
           {"run --trial-run " + file("a.study") + " --participant 'S 1'", "S 1"},
           {"run --trial-run " + file("a.study") + " --device nosuch", "nosuch"},
           {"run --trial-run " + file("a.study") + " --bind nowhere", "nowhere"},
           {"run --trial-run " + file("a.study") + " --token short", "16 to 128 of A to Z"},
           {"run --trial-run " + file("a.study") + " --participant-token 'a b c d e f g h i'", "16 to 128 of A to Z"},
           {"run --trial-run " + file("a.study") + " --token aaaabbbbccccdddd --participant-token aaaabbbbccccdddd",
            "token = repeated"},
           {"simulate " + file("a.study") + " --weber 0", "weber_fraction = 0"},
           {"simulate " + file("a.study") + " --lapse 2", "lapse = 2"},
           {"simulate " + file("a.study") + " --blind 1.5", "--blind"},
           {"simulate " + file("a.study") + " --blind 0.1 --lapse 0.1", "--lapse"},
           {"simulate " + file("a.study") + " --motion stir", "--judge"},
           {"figure " + file("a.study") + " --block gravity", "gravity"},
           {"figure " + file("a.study") + " --sigmoid round", "round"},
           {"plan --protocol nosuch", "nosuch"},
           {"plan --participants 0", "participants = 0"},
           {"plan --studies 1", "studies = 1"},
           {"plan --alternative 0", "alternative = 0"},
       }) {
    const ProgramResult result = runInShell("timeout 20 \"$HAPTOLITH\" study " + arguments);
    EXPECT_EQ(result.exit_status, 2) << arguments << "\n" << result.errors;
    EXPECT_THAT(result.errors, HasSubstr(told)) << arguments;
  }
}

TEST_F(StudyRunCommands, SimulatedPeopleMakeAFigureThatFindsTheirWeberFraction) {
  makeStudy("icra2021");
  const ProgramResult simulated = runHaptolith("study simulate --participants 30 --weber 0.29 " + file("a.study"));
  EXPECT_EQ(simulated.exit_status, 0) << simulated.errors;
  EXPECT_THAT(simulated.output, HasSubstr("900 counted responses"));
  const ProgramResult figure =
      runHaptolith(fmt::format("study figure {} --json --figure {}", file("a.study"), file("fig.svg")));
  EXPECT_EQ(figure.exit_status, 0) << figure.errors;
  const Json told = Json::parse(figure.output);
  const Json& blocks = told["blocks"];
  ASSERT_EQ(blocks.size(), 2U);
  const Json& headline = blocks[0]["headline"];
  EXPECT_EQ(headline["of"], "median person");
  EXPECT_NEAR(headline["weber_fraction"].get<double>(), 0.29, 0.06);
  EXPECT_NEAR(headline["pse"].get<double>(), 0.835, 0.06);
  EXPECT_EQ(headline["n_trials"], 450);
  EXPECT_FALSE(blocks[0].contains("pooled")) << "only when it is asked for";
  ASSERT_EQ(told["differences"].size(), 1U);
  EXPECT_EQ(told["differences"][0]["participants_in_both"], 30);
  EXPECT_LT(told["differences"][0]["weber_fraction"]["interval"][0], 1) << "everybody has the same Weber fraction";
  EXPECT_TRUE(fs::exists(folder_ / "fig-friction.svg"));
  EXPECT_TRUE(fs::exists(folder_ / "fig-gravity.svg"));
  const ProgramResult one = runHaptolith(
      fmt::format("study figure {} --block friction --pooled --figure {}", file("a.study"), file("one.png")));
  EXPECT_TRUE(fs::exists(folder_ / "one.png")) << one.errors;
  EXPECT_THAT(one.output,
              AllOf(HasSubstr("30 participants,"), HasSubstr("Weber fraction"), HasSubstr("PSE"),
                    HasSubstr("Lapses: the rate is fitted"), HasSubstr("ignores differences between participants")));
}

// The script in an export is an independent program for the same model.
TEST_F(StudyRunCommands, TheScriptOfAnExportMakesTheNumbersOfAFigureAgain) {
  if (runInShell("/usr/bin/python3 -c 'import scipy'").exit_status != 0) {
    GTEST_SKIP() << "scipy is not installed";
  }
  makeStudy();
  ASSERT_EQ(runHaptolith("study simulate --participants 8 --weber 0.29 --bias 0.1 " + file("a.study")).exit_status, 0);
  const ProgramResult figure = runHaptolith(fmt::format("study figure {} --json", file("a.study")));
  ASSERT_EQ(figure.exit_status, 0) << figure.errors;
  const Json headline = Json::parse(figure.output)["blocks"][0]["headline"];
  ASSERT_EQ(runHaptolith(fmt::format("study export {} --out {}", file("a.study"), file("a.csv"))).exit_status, 0);
  const ProgramResult script = runInShell("/usr/bin/python3 '" + file("a-analysis.py") + "' --json --no-glmm");
  ASSERT_EQ(script.exit_status, 0) << script.errors;
  const Json again = Json::parse(script.output)[0];
  for (const char* key : {"weber_fraction", "pse"}) {
    const auto of_figure = headline[key].get<double>();
    EXPECT_NEAR(again[key].get<double>(), of_figure, 0.01 * of_figure) << key;
    const std::string interval = std::string(key) + "_interval";
    for (const int end : {0, 1}) {
      const auto wanted = headline[interval][end].get<double>();
      EXPECT_NEAR(again[interval][end].get<double>(), wanted, 0.02 * wanted) << interval;
    }
  }
}

TEST_F(StudyRunCommands, SimulatedAnswersStandBesideNoPersons) {
  makeStudy();
  (void)runForASecond(fmt::format("run {} --trial-run --port 0", file("a.study")));
  const ProgramResult refused = runHaptolith("study simulate " + file("a.study"));
  EXPECT_EQ(refused.exit_status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("S01 has participated"));
}

TEST_F(StudyRunCommands, AHandThatFeelsTellsFrictionApart) {
  makeStudy();
  const ProgramResult simulated =
      runHaptolith("study simulate --participants 1 --motion stir --judge mean-force --weber 0.001 " + file("a.study"));
  EXPECT_EQ(simulated.exit_status, 0) << simulated.errors;
  const Json levels = status()["blocks"][0]["levels"];
  ASSERT_EQ(levels.size(), 5U);
  EXPECT_EQ(levels[4]["level"], "P1");
  EXPECT_EQ(levels[4]["k"], 3) << "the stickiest always resists more than the reference";
}

TEST_F(StudyRunCommands, AFigureOfNothingIsAFailure) {
  makeStudy();
  const ProgramResult figure = runHaptolith("study figure " + file("a.study"));
  EXPECT_EQ(figure.exit_status, 1);
  EXPECT_THAT(figure.errors, HasSubstr("there are no responses yet"));
}

TEST_F(StudyRunCommands, FormerOptionsStillWork) {
  makeStudy("paper");
  const ProgramResult plan = runHaptolith("study plan --against 0 --people --spread 0.1");
  EXPECT_EQ(plan.exit_status, 2);
  EXPECT_THAT(plan.errors, AllOf(HasSubstr("--against is now --alternative"), HasSubstr("--people is now --find-n"),
                                 HasSubstr("--spread is now --between-sd"), HasSubstr("alternative = 0")));
  const ProgramResult table = runHaptolith(fmt::format("study export {} --to {}", file("a.study"), file("a.csv")));
  EXPECT_EQ(table.exit_status, 0) << table.errors;
  EXPECT_THAT(table.errors, HasSubstr("--to is now --out"));
  const ProgramResult figure = runHaptolith(fmt::format("study figure {} --out {}", file("a.study"), file("a.svg")));
  EXPECT_EQ(figure.exit_status, 1) << "it has no responses";
  EXPECT_THAT(figure.errors, HasSubstr("--out is now --figure"));
}

TEST_F(StudyRunCommands, APlanTellsHowManyPeopleAreNeeded) {
  const ProgramResult plan = runHaptolith(
      fmt::format("study plan --participants 4,16 --repeats 3 --studies 40 --alternative 0.5 --json --figure {}",
                  file("plan.svg")));
  ASSERT_EQ(plan.exit_status, 0) << plan.errors;
  const Json sizes = Json::parse(plan.output)["sizes"];
  ASSERT_EQ(sizes.size(), 2U);
  EXPECT_EQ(sizes[1]["answers"], 16 * 3 * 5);
  EXPECT_GT(sizes[1]["power"]["share"].get<double>(), sizes[0]["power"]["share"].get<double>());
  EXPECT_TRUE(fs::exists(folder_ / "plan.svg"));
}

}  // namespace
}  // namespace haptolith

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "program.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;
namespace fs = std::filesystem;

/// A folder with a study that two people have taken part in, written as the tables are described.
class StudyCommands : public testing::Test {
 protected:
  StudyCommands() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_study_commands_{}", getpid())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~StudyCommands() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const {
    return fmt::format("'{}'", (folder_ / name).string());
  }

  void makeStudy(const std::string& protocol = "icra2021") const {
    const ProgramResult made =
        runHaptolith(fmt::format("study new {} --protocol {} --seed 7", file("a.study"), protocol));
    ASSERT_EQ(made.exit_status, 0) << made.errors;
  }

  /// Two people; the second has said once that P1 has more, once that it has not, and once in practice.
  void fillStudy() const {
    std::ofstream(folder_ / "fill.py") << R"py(
import sqlite3
study = sqlite3.connect('a.study')
study.execute("INSERT INTO participant (number, code, state, begun_at) "
              "VALUES (1, 'S01', 'running', 'then'), (2, 'S02', 'finished', 'then')")
for number, (kind, positive) in enumerate([('practice', 1), ('main', 1), ('main', 0)]):
    trial = study.execute(
        "INSERT INTO trial (participant, block, position, trial, attempt, kind, block_name, level, reference, value, "
        "reference_value, test_first, seed, state, begun_at) "
        "VALUES (2, 0, 0, ?, 0, ?, 'friction', 'P1', 'P3', 1.21, 0.835, 0, 1, 'answered', 'then')", (number, kind)).lastrowid
    study.execute("INSERT INTO answer (trial, positive, reaction_s, timed_out) VALUES (?, ?, 0.5, 0)",
                  (trial, positive))
study.execute("INSERT INTO personal_answer VALUES (2, 'demographics', 'name', 'Grace', 'then')")
study.commit()
)py";
    const ProgramResult filled = runInShell(fmt::format("cd '{}' && /usr/bin/python3 fill.py", folder_.string()));
    ASSERT_EQ(filled.exit_status, 0) << filled.errors;
  }

  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream stream(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  fs::path folder_;
};

// --- new
// --------------------------------------------------------------------------------------------------------------

TEST_F(StudyCommands, NewTellsWhatItHasMade) {
  const ProgramResult made = runHaptolith(fmt::format("study new {} --protocol icra2021 --seed 7", file("a.study")));
  EXPECT_EQ(made.exit_status, 0) << made.errors;
  EXPECT_THAT(made.output,
              AllOf(HasSubstr("seed 7"), HasSubstr("5 levels against P3, 15 trials"), HasSubstr("gravity")));
  EXPECT_THAT(made.errors, HasSubstr("[BRACKETS]"));
  EXPECT_TRUE(fs::exists(folder_ / "a.study"));
}

TEST_F(StudyCommands, NewDrawsASeedThatDiffersFromTimeToTime) {
  const auto seed = [&](const std::string& name) {
    EXPECT_EQ(runHaptolith(fmt::format("study new {} --protocol icra2021-gravity", file(name))).exit_status, 0);
    return Json::parse(runHaptolith(fmt::format("study status --json {}", file(name))).output)["seed"]
        .get<std::uint64_t>();
  };
  const std::uint64_t one = seed("a.study");
  EXPECT_NE(one, seed("b.study"));
  EXPECT_LT(one, std::uint64_t{1} << 53);
}

TEST_F(StudyCommands, NewTakesAProtocolFromAFile) {
  std::ofstream(folder_ / "mine.toml")
      << "title = 'Mine'\n[[block]]\nname = 'a'\nquestion = 'q'\nanswers = ['l', 'm']\n"
         "varies = 'preset'\nreference = 'P3'\nlevels = ['P1', 'P6']\n";
  const ProgramResult made =
      runHaptolith(fmt::format("study new {} --protocol {}", file("a.study"), file("mine.toml")));
  EXPECT_EQ(made.exit_status, 0) << made.errors;
  EXPECT_THAT(made.output, AllOf(HasSubstr("Mine"), HasSubstr("2 levels against P3, 6 trials")));
  EXPECT_EQ(made.errors, "");
}

TEST_F(StudyCommands, GroupsAreAssignedCountedExportedAndCompared) {
  const std::string block =
      "[[block]]\nname = '{}'\nquestion = 'q'\nanswers = ['l', 'm']\nvaries = 'preset'\nreference = 'P3'\n"
      "levels = ['P1', 'P2', 'P4', 'P5', 'P6']\nrepeats = 4\n";
  std::ofstream(folder_ / "mine.toml")
      << "title = 'Mine'\n[assignment]\nmethod = 'stratified'\nstrata = ['left']\n"
         "[[groups]]\nname = 'one'\nblocks = ['seen', 'both']\n[[groups]]\nname = 'two'\nblocks = ['unseen', 'both']\n"
         "[[demographics]]\nkey = 'left'\nlabel = 'Do you write with the left hand?'\nkind = 'yes-no'\nrequired = "
         "true\n"
      << fmt::format(fmt::runtime(block), "seen") << fmt::format(fmt::runtime(block), "unseen")
      << fmt::format(fmt::runtime(block), "both");
  const ProgramResult made =
      runHaptolith(fmt::format("study new {} --protocol {} --seed 7", file("a.study"), file("mine.toml")));
  ASSERT_EQ(made.exit_status, 0) << made.errors;
  EXPECT_THAT(made.output, HasSubstr("group one        seen, both, share 1"));
  ASSERT_EQ(
      runHaptolith(fmt::format("study simulate {} --participants 8 --group-factor 2", file("a.study"))).exit_status, 0);
  const ProgramResult excluded = runHaptolith(fmt::format("study exclude {} sim001 --reason asleep", file("a.study")));
  EXPECT_THAT(excluded.output, AllOf(HasSubstr("\n  one: "), HasSubstr("\n  two: "), HasSubstr("1 excluded (asleep)")));
  const Json status = Json::parse(runHaptolith(fmt::format("study status --json {}", file("a.study"))).output);
  ASSERT_EQ(status["groups"].size(), 2U);
  EXPECT_EQ(status["groups"][0]["assigned"].get<int>() + status["groups"][1]["assigned"].get<int>(), 8);
  EXPECT_EQ(status["groups"][0]["strata"][0]["stratum"], "left yes");
  EXPECT_EQ(status["participants"][0]["blocks"].size(), 2U) << "those of the group";
  EXPECT_THAT(runHaptolith(fmt::format("study status {}", file("a.study"))).output,
              HasSubstr("Assigned from each stratum"));
  const Json figure = Json::parse(runHaptolith(fmt::format("study figure --json {}", file("a.study"))).output);
  ASSERT_EQ(figure["blocks"].size(), 4U);
  EXPECT_EQ(figure["blocks"][0]["of_group"], "one");
  std::vector<std::string> compared;
  for (const Json& of : figure["differences"]) {
    compared.push_back(of.contains("first_group")
                           ? fmt::format("{} {}, {} {}", of["first_group"].get<std::string>(),
                                         of["first"].get<std::string>(), of["second_group"].get<std::string>(),
                                         of["second"].get<std::string>())
                           : fmt::format("{}, {}", of["first"].get<std::string>(), of["second"].get<std::string>()));
    EXPECT_LT(of["weber_fraction"]["interval"][0], of["weber_fraction"]["ratio"]);
  }
  EXPECT_THAT(compared,
              testing::ElementsAre("seen, both", "unseen, both", "one both, two both", "one seen, two unseen"));
  ASSERT_EQ(runHaptolith(fmt::format("study export {} --out {}", file("a.study"), file("a.csv"))).exit_status, 0);
  const ProgramResult script = runInShell("/usr/bin/python3 " + file("a-analysis.py") + " --json --no-glmm");
  ASSERT_EQ(script.exit_status, 0) << script.errors;
  for (const Json& again : Json::parse(script.output)) {
    const auto same = std::ranges::find_if(figure["blocks"], [&again](const Json& of) {
      return of["block"] == again["block"] && of["of_group"] == again["of_group"];
    });
    ASSERT_NE(same, figure["blocks"].end()) << again;
    EXPECT_NEAR((*same)["headline"]["weber_fraction"], again["weber_fraction"],
                0.01 * again["weber_fraction"].get<double>());
  }
  ASSERT_EQ(
      runHaptolith(fmt::format("study export {} --out {} --format bids", file("a.study"), file("bids"))).exit_status,
      0);
  const ProgramResult of_folder =
      runInShell(fmt::format("/usr/bin/python3 {0}/code/analysis.py {0} --json --no-glmm", file("bids")));
  const auto sorted = [](const std::string& text) {  // a folder has another order
    std::vector<Json> results = Json::parse(text);
    std::ranges::sort(results);
    return results;
  };
  EXPECT_EQ(sorted(of_folder.output), sorted(script.output));
}

TEST_F(StudyCommands, NewRefusesGroupsThatAreNone) {
  std::ofstream(folder_ / "bad.toml")
      << "title = 'Mine'\n[[groups]]\nname = 'one'\nblocks = ['b']\n[[block]]\nname = 'a'\n"
         "question = 'q'\nanswers = ['l', 'm']\nvaries = 'preset'\nreference = 'P3'\n"
         "levels = ['P1', 'P6']\n";
  const ProgramResult bad = runHaptolith(fmt::format("study new {} --protocol {}", file("a.study"), file("bad.toml")));
  EXPECT_EQ(bad.exit_status, 2);
  EXPECT_THAT(bad.errors, HasSubstr("bad.toml:4: [[groups]] blocks = [ 'b' ] is not valid: must be one or more of a"));
}

TEST_F(StudyCommands, NewRefusesAProtocolOfOnesOwnWithBracketsLeft) {
  std::ofstream(folder_ / "mine.toml")
      << "title = 'Mine'\nconsent = 'Ask [NAME OF THE LABORATORY].'\n[[block]]\nname = 'a'\nquestion = 'q'\n"
         "answers = ['l', 'm']\nvaries = 'preset'\nreference = 'P3'\nlevels = ['P1', 'P6']\n";
  const ProgramResult made =
      runHaptolith(fmt::format("study new {} --protocol {}", file("a.study"), file("mine.toml")));
  EXPECT_EQ(made.exit_status, 2);
  EXPECT_THAT(made.errors, HasSubstr("consent = [NAME OF THE LABORATORY] is not valid"));
  EXPECT_FALSE(fs::exists(file("a.study")));
}

TEST_F(StudyCommands, NewRefusesWhatIsWrongAndLeavesNoFile) {
  std::ofstream(folder_ / "bad.toml") << "title = 'Mine'\n[[block]]\nname = 'a'\nquestion = 'q'\nanswers = ['l', 'm']\n"
                                         "varies = 'preset'\nreference = 'P3'\nlevels = ['P1']\n";
  const ProgramResult bad = runHaptolith(fmt::format("study new {} --protocol {}", file("a.study"), file("bad.toml")));
  EXPECT_EQ(bad.exit_status, 2);
  EXPECT_THAT(bad.errors, HasSubstr("bad.toml:8: [[block]] levels = [ 'P1' ] is not valid: must be two or more"));
  const ProgramResult unknown = runHaptolith(fmt::format("study new {} --protocol papr", file("a.study")));
  EXPECT_EQ(unknown.exit_status, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("icra2021-friction"));
  EXPECT_EQ(runHaptolith(fmt::format("study new {} --protocol icra2021 --seed 9007199254740992", file("a.study")))
                .exit_status,
            2);
  EXPECT_EQ(runHaptolith(fmt::format("study new {} --protocol icra2021 --seed -1", file("a.study"))).exit_status, 2);
  EXPECT_EQ(runHaptolith(fmt::format("study new {}", file("a.study"))).exit_status, 2);
  EXPECT_FALSE(fs::exists(folder_ / "a.study"));
}

TEST_F(StudyCommands, WriteNoFileOfTheNameOfStandardOutput) {
  makeStudy();
  for (const std::string& command :
       {std::string("new - --protocol icra2021"), "export " + file("a.study") + " --out -"}) {
    const ProgramResult refused = runHaptolith("study " + command);
    EXPECT_EQ(refused.exit_status, 2) << command;
    EXPECT_THAT(refused.errors, HasSubstr("must be a file name")) << command;
  }
}

TEST_F(StudyCommands, NewNeverOverwritesAStudy) {
  makeStudy();
  const std::string before = read("a.study");
  const ProgramResult again = runHaptolith(fmt::format("study new {} --protocol icra2021", file("a.study")));
  EXPECT_EQ(again.exit_status, 1);
  EXPECT_THAT(again.errors, HasSubstr("already exists"));
  EXPECT_EQ(read("a.study"), before);
}

// --- status
// -----------------------------------------------------------------------------------------------------------

TEST_F(StudyCommands, StatusTellsHowFarEverybodyIs) {
  makeStudy();
  EXPECT_THAT(runHaptolith("study status " + file("a.study")).output, HasSubstr("There are no participants yet"));
  fillStudy();
  const ProgramResult status = runHaptolith("study status " + file("a.study"));
  EXPECT_EQ(status.exit_status, 0) << status.errors;
  EXPECT_THAT(status.output, AllOf(HasSubstr("S01"), HasSubstr("finished"), HasSubstr("2 of 15"), HasSubstr("1 of 2")));
}

TEST_F(StudyCommands, StatusAsJsonHasAnswersByLevel) {
  makeStudy();
  fillStudy();
  const ProgramResult status = runHaptolith("study status --json " + file("a.study"));
  ASSERT_EQ(status.exit_status, 0) << status.errors;
  const Json json = Json::parse(status.output);
  EXPECT_EQ(json["seed"], 7);
  ASSERT_EQ(json["participants"].size(), 2U);
  EXPECT_EQ(json["participants"][1]["participant"], "S02");
  EXPECT_EQ(json["participants"][1]["blocks"][0]["answered"], 2);
  EXPECT_EQ(json["participants"][0]["blocks"][0]["answered"], 0);
  EXPECT_EQ(json["participants"][1]["blocks"][0]["trials"], 15);
  ASSERT_EQ(json["blocks"][0]["levels"].size(), 1U);
  EXPECT_EQ(json["blocks"][0]["levels"][0], Json({{"level", "P1"}, {"x", 1.21}, {"k", 1}, {"n", 2}}));
  EXPECT_TRUE(json["blocks"][1]["levels"].empty());
}

TEST_F(StudyCommands, StatusTellsWhatSimulatedThem) {
  makeStudy("icra2021-friction");
  const auto simulate = [&] {
    return runHaptolith(fmt::format("study simulate {} --participants 1 --weber 0.25 --lapse 0.02", file("a.study")));
  };
  ASSERT_EQ(simulate().exit_status, 0);
  const auto participants = [&] {
    return Json::parse(runHaptolith("study status --json " + file("a.study")).output)["participants"];
  };
  const Json session = participants()[0]["sessions"][0];
  EXPECT_EQ(session["kind"], "simulate");
  EXPECT_EQ(session["simulation"]["weber"], 0.25);
  EXPECT_EQ(session["simulation"]["lapse"], 0.02);
  EXPECT_EQ(session["simulation"]["judge"], "value");
  EXPECT_FALSE(session["program_version"].get<std::string>().empty());
  EXPECT_TRUE(session["ended_at"].is_string());
  EXPECT_EQ(session["ticks"], nullptr);
  EXPECT_EQ(participants()[0]["consent"]["language"], "en");
  EXPECT_THAT(runHaptolith("study status " + file("a.study")).output, HasSubstr("1 simulate by haptolith"));
  ASSERT_EQ(runHaptolith(fmt::format("study forget {} sim001", file("a.study"))).exit_status, 0);
  ASSERT_EQ(simulate().exit_status, 0);
  EXPECT_EQ(participants()[0]["participant"], "sim002");
}

TEST_F(StudyCommands, StatusRefusesWhatIsNoStudy) {
  std::ofstream(folder_ / "text") << std::string(2000, 'x');
  const ProgramResult text = runHaptolith("study status " + file("text"));
  EXPECT_EQ(text.exit_status, 1);
  EXPECT_THAT(text.errors, HasSubstr("is not a study"));
  EXPECT_EQ(runHaptolith("study status " + file("nothing")).exit_status, 2);
}

// --- export
// -----------------------------------------------------------------------------------------------------------

TEST_F(StudyCommands, ExportWritesATable) {
  makeStudy();
  fillStudy();
  const ProgramResult result = runHaptolith(fmt::format("study export {} --out {}", file("a.study"), file("a.csv")));
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_THAT(read("a.csv"), AllOf(HasSubstr("participant,participant_number,participant_state,excluded_for,block"),
                                   HasSubstr("S02,2,finished,,friction,1,3,1,main"), Not(HasSubstr("Grace"))));
  EXPECT_EQ(runHaptolith(fmt::format("study export {} --out {}", file("a.study"), file("a.csv"))).exit_status, 1);
  const ProgramResult personal =
      runHaptolith(fmt::format("study export {} --out {} --personal --overwrite", file("a.study"), file("a.csv")));
  EXPECT_EQ(personal.exit_status, 0) << personal.errors;
  EXPECT_THAT(read("a.csv"), HasSubstr("Grace"));
}

TEST_F(StudyCommands, ExportMakesABidsFolder) {
  makeStudy();
  fillStudy();
  const ProgramResult result =
      runHaptolith(fmt::format("study export {} --out {} --format bids", file("a.study"), file("bids")));
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_TRUE(fs::exists(folder_ / "bids/sub-S02/beh/sub-S02_task-friction_beh.tsv"));
  EXPECT_EQ(runHaptolith(fmt::format("study export {} --out {} --format spss", file("a.study"), file("b"))).exit_status,
            2);
}

TEST_F(StudyCommands, FitTakesWhatExportHasWritten) {
  makeStudy();
  fillStudy();
  ASSERT_EQ(runHaptolith(fmt::format("study export {} --out {}", file("a.study"), file("a.csv"))).exit_status, 0);
  const ProgramResult fit = runHaptolith(
      fmt::format("study fit --data {} --sigmoid weber --reference 0.835 --simulations 10 --json", file("a.csv")));
  ASSERT_EQ(fit.exit_status, 0) << fit.errors;
  EXPECT_EQ(Json::parse(fit.output)["n_trials"], 2);
}

// --- exclude
// ----------------------------------------------------------------------------------------------------------

TEST_F(StudyCommands, ExcludeLeavesOutOfFiguresAndMarksInExports) {
  makeStudy();
  fillStudy();
  const auto exclude = [&](const std::string& more) {
    return runHaptolith(fmt::format("study exclude {} S02 {}", file("a.study"), more));
  };
  EXPECT_EQ(exclude("").exit_status, 2);
  const ProgramResult excluded = exclude("--reason 'catch trials'");
  EXPECT_EQ(excluded.exit_status, 0) << excluded.errors;
  EXPECT_THAT(excluded.output, HasSubstr("2 began, 1 excluded (catch trials), 1 analysed (1 not finished)"));
  const Json after = Json::parse(runHaptolith("study status --json " + file("a.study")).output);
  EXPECT_TRUE(after["blocks"][0]["levels"].empty()) << "answers of somebody who is excluded";
  EXPECT_EQ(exclude("--reason 'catch trials'").exit_status, 2);
  EXPECT_THAT(runHaptolith("study status " + file("a.study")).output,
              AllOf(HasSubstr("excluded"), HasSubstr("1 excluded (catch trials)")));
  EXPECT_THAT(runHaptolith("study figure " + file("a.study")).errors, HasSubstr("there are no responses yet"));
  ASSERT_EQ(runHaptolith(fmt::format("study export {} --out {}", file("a.study"), file("a.csv"))).exit_status, 0);
  EXPECT_THAT(read("a.csv"), HasSubstr("S02,2,excluded,catch trials,friction"));
  EXPECT_EQ(runHaptolith(fmt::format("study fit --data {}", file("a.csv"))).exit_status, 2) << "no answer is left";
  EXPECT_EQ(exclude("--undo --reason 'another criterion'").exit_status, 0);
  EXPECT_THAT(runHaptolith("study status " + file("a.study")).output, HasSubstr("2 analysed"));
}

// --- forget
// -----------------------------------------------------------------------------------------------------------

TEST_F(StudyCommands, ExportStaysInItsFolderWhateverTheStudySays) {
  makeStudy();
  fillStudy();
  const ProgramResult forged = runInShell(
      fmt::format("cd '{}' && /usr/bin/python3 -c \"import sqlite3; s = sqlite3.connect('a.study'); "
                  "s.execute('UPDATE participant SET code=\\'/../../../escaped\\' WHERE number=2'); s.commit()\"",
                  folder_.string()));
  ASSERT_EQ(forged.exit_status, 0) << forged.errors;
  const ProgramResult result =
      runHaptolith(fmt::format("study export {} --out {} --format bids", file("a.study"), file("out")));
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("code = '/../../../escaped'; must be 1 to 16 letters and digits"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_FALSE(fs::exists(folder_.parent_path() / "escaped"));
}

TEST_F(StudyCommands, ForgetDeletesWhatIsPersonalOrEverything) {
  makeStudy();
  fillStudy();
  ASSERT_THAT(read("a.study") + read("a.study-wal"), HasSubstr("Grace"));
  const ProgramResult personal = runHaptolith(fmt::format("study forget {} S02 --personal", file("a.study")));
  EXPECT_EQ(personal.exit_status, 0) << personal.errors;
  EXPECT_THAT(personal.output, HasSubstr("1 personal answers deleted"));
  EXPECT_THAT(read("a.study"), Not(HasSubstr("Grace")));
  EXPECT_THAT(runHaptolith("study status " + file("a.study")).output, HasSubstr("2 of 15"));
  EXPECT_EQ(runHaptolith(fmt::format("study forget {} S02", file("a.study"))).exit_status, 0);
  EXPECT_THAT(runHaptolith("study status " + file("a.study")).output, Not(HasSubstr("S02")));
  const ProgramResult again = runHaptolith(fmt::format("study forget {} S02", file("a.study")));
  EXPECT_EQ(again.exit_status, 0);
  EXPECT_THAT(again.output, HasSubstr("S02: already deleted"));
  const ProgramResult nobody = runHaptolith(fmt::format("study forget {} S09", file("a.study")));
  EXPECT_EQ(nobody.exit_status, 2);
  EXPECT_THAT(nobody.errors, HasSubstr("one of S01"));
}

TEST_F(StudyCommands, ForgetTakesRecordingsAndNamesWhatStays) {
  makeStudy();
  fillStudy();
  fs::create_directory(folder_ / "a-recordings");
  std::ofstream(folder_ / "a-recordings/S02-friction-001-1-first.h5") << "\x89HDF";
  ASSERT_EQ(runHaptolith(fmt::format("study export {} --out {}", file("a.study"), file("a.csv"))).exit_status, 0);
  const ProgramResult forget =
      runHaptolith(fmt::format("study forget {} S02 --reason 'asked for it'", file("a.study")));
  EXPECT_EQ(forget.exit_status, 0) << forget.errors;
  EXPECT_THAT(forget.output, AllOf(HasSubstr("S02: deleted, with 3 trials and 1 recording\n"),
                                   HasSubstr((folder_ / "a.csv").string()), HasSubstr("copies and backups")));
  EXPECT_FALSE(fs::exists(folder_ / "a-recordings/S02-friction-001-1-first.h5"));
}

TEST_F(StudyCommands, ForgetClaimsNothingWhileAnotherProgramReads) {
  makeStudy();
  fillStudy();
  // A database browser in the middle of reading.
  const ProgramResult forget = runInShell(fmt::format(
      "cd '{}' && /usr/bin/python3 -c \"import sqlite3, subprocess, os, sys; s = sqlite3.connect('a.study', "
      "isolation_level=None); s.execute('BEGIN'); s.execute('SELECT * FROM trial').fetchone(); "
      "sys.exit(subprocess.call([os.environ['HAPTOLITH'], 'study', 'forget', 'a.study', 'S02']))\"",
      folder_.string()));
  EXPECT_EQ(forget.exit_status, 1);
  EXPECT_EQ(forget.output, "");
  EXPECT_THAT(forget.errors, AllOf(HasSubstr("nothing has been deleted"), HasSubstr("close that program")));
  EXPECT_THAT(runHaptolith("study status " + file("a.study")).output, HasSubstr("2 of 15"));
}

}  // namespace
}  // namespace haptolith

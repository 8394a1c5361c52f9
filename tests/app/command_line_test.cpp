#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "../source_dir.h"
#include "program.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

TEST(Version, IsOneLine) {
  EXPECT_EQ(runHaptolith("version").output, runHaptolith("--version").output);
  EXPECT_EQ(runHaptolith("-V").output, runHaptolith("--version").output);
  EXPECT_THAT(runHaptolith("export run.h5").errors, testing::HasSubstr("--format is required: csv|particles-csv|"));
  const ProgramResult result = runHaptolith("--version");
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(result.output, "haptolith 0.2.0\n");
  EXPECT_THAT(result.errors, IsEmpty());
}

TEST(Help, GoesToStandardOutputWithExamples) {
  const ProgramResult result = runHaptolith("--help");
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.output, HasSubstr("Examples:\n  haptolith run"));
  EXPECT_THAT(result.errors, IsEmpty());
}

TEST(Help, NamesTheCommandItBelongsTo) {
  EXPECT_THAT(runHaptolith("completion --help").output, HasSubstr("Usage: haptolith completion "));
}

TEST(Help, ShowsExamplesOfTheCommandAndNotOfTheProgram) {
  for (const std::string command :
       {"teleop", "teleop link", "soil", "soil list", "soil icra2021", "lab", "study", "identify"}) {
    const std::string help = runHaptolith(command + " --help").output;
    EXPECT_THAT(help, HasSubstr("  haptolith " + command)) << command;
    EXPECT_THAT(help, Not(HasSubstr("haptolith completion bash"))) << command;
  }
}

// Half of the commands are in a separate executable, haptolith-workbench.
TEST(Workbench, HasEveryCommandThatTheHelpOfTheProgramLists) {
  const std::string listed = runHaptolith("--help").output;
  const ProgramResult all = runInShell("\"$(dirname \"$HAPTOLITH\")/haptolith-workbench\" --help");
  EXPECT_EQ(all.exit_status, 0) << all.errors;
  EXPECT_EQ(all.output, listed);
}

TEST(Workbench, IsFoundNextToTheProgramAndWhereItIsInstalled) {
  const std::string folder = testing::TempDir() + "workbench_found";
  for (const std::string place : {"bin", "libexec/haptolith"}) {
    const ProgramResult result = runInShell(fmt::format(
        "rm -rf {0} && mkdir -p {0}/bin {0}/libexec/haptolith && cp \"$HAPTOLITH\" {0}/bin/haptolith && "
        "cp \"$(dirname \"$HAPTOLITH\")/haptolith-workbench\" {0}/{1}/ && {0}/bin/haptolith lab shear --help",
        folder, place));
    EXPECT_EQ(result.exit_status, 0) << place << result.errors;
    EXPECT_THAT(result.output, HasSubstr("Usage: haptolith lab shear ")) << place;
  }
  std::filesystem::remove_all(folder);
}

TEST(Workbench, IsMissedByNameWhereItIsNot) {
  const std::string folder = testing::TempDir() + "workbench_missing";
  const ProgramResult result = runInShell(fmt::format(
      "rm -rf {0} && mkdir -p {0}/bin && cp \"$HAPTOLITH\" {0}/bin/haptolith && {0}/bin/haptolith lab shear", folder));
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("haptolith lab is not installed: haptolith-workbench is neither in"));
  std::filesystem::remove_all(folder);
}

TEST(Help, SaysWhatToWriteAndWhatIsTakenOtherwise) {
  const std::string bench = runHaptolith("bench --help").output;
  EXPECT_THAT(bench, HasSubstr("--friction-model contact|icra2021,..."));
  EXPECT_THAT(bench, HasSubstr("--threads N,...             Numbers of threads, 1 to 256 [1,2]\n"));
  EXPECT_THAT(bench, HasSubstr("--duration-s SECONDS        Simulated time of each row [1]\n"));
  EXPECT_THAT(bench, HasSubstr("--figure FILE "));
  EXPECT_THAT(runHaptolith("lab shear --help").output,
              HasSubstr("Number of threads; the result does not depend on it, 1 to 256 [all]\n"));
  EXPECT_THAT(runHaptolith("snapshot --help").output, HasSubstr("or with --film .mp4 or .webm; required\n"));
  EXPECT_THAT(runHaptolith("soil icra2021 profile --help").output,
              HasSubstr("Gravity in m/s², instead of a body; not with --body\n"));
  for (const char* command :
       {"run", "bench", "lab shear", "soil calibrate", "soil icra2021 profile", "study fit", "completion"}) {
    const std::string help = runHaptolith(fmt::format("{} --help", command)).output;
    for (const char* of_the_parser : {"ENUM", "FLOAT", "INT", "Excludes:", "REQUIRED", ":{"}) {
      EXPECT_THAT(help, Not(HasSubstr(of_the_parser))) << command;
    }
  }
}

/// Commands that a help lists, under "Subcommands:" or "Run commands:".
std::vector<std::string> commandsIn(const std::string& help) {
  std::vector<std::string> names;
  bool lists = false;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(' ')) {
      lists = line.ends_with("ommands:");
    } else if (lists && !line.starts_with("   ")) {
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
  }
  return names;
}

/// Descriptions of options and positional arguments, without line breaks.
std::vector<std::string> descriptionsIn(const std::string& help) {
  constexpr std::size_t kColumn = 30;
  std::vector<std::string> descriptions;
  bool lists = false;
  std::istringstream lines(help.substr(0, help.find("\nExample")));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(' ')) {
      lists = line.ends_with(':') && !line.ends_with("ommands:");
      continue;
    }
    const bool begins = !line.starts_with("   ");
    if (lists && begins) {
      descriptions.emplace_back();
    }
    if (lists && line.size() > kColumn && (!begins || line[kColumn - 1] == ' ')) {
      descriptions.back() += line.substr(kColumn) + ' ';
    }
  }
  return descriptions;
}

std::ptrdiff_t columnsOf(const std::string& line) {
  return std::ranges::count_if(line, [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; });
}

/// Words of docs/make/words.txt that are easily found.
constexpr std::array kAvoided{"somebody", "nobody", "whoever", " tells ",  " told ", "goes on",        "beside",
                              " anew",    "mend ",  "hence",   "likewise", "hardly", "there and back", " of its own"};

void expectPlainHelp(const std::string& command, std::set<std::string>& checked) {
  const ProgramResult result = runInShell("\"$(dirname \"$HAPTOLITH\")/haptolith-workbench\" " + command + " --help");
  ASSERT_EQ(result.exit_status, 0) << command << result.errors;
  checked.insert(command);
  std::istringstream lines(result.output);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(columnsOf(line), 100) << command << ": " << line;
    EXPECT_FALSE(line.ends_with(' ')) << command << ": " << line;
  }
  for (const std::string& description : descriptionsIn(result.output)) {
    EXPECT_TRUE(!description.empty() && std::isupper(static_cast<unsigned char>(description.front())))
        << command << ": " << description;
    for (const char* word : kAvoided) {
      EXPECT_THAT(description, Not(HasSubstr(word))) << command;
    }
  }
  for (const std::string& below : commandsIn(result.output)) {
    expectPlainHelp(command.empty() ? below : command + " " + below, checked);
  }
}

TEST(Help, IsPlainAndAtMost100ColumnsWideInEveryCommand) {
  std::set<std::string> checked;
  expectPlainHelp("", checked);
  EXPECT_THAT(checked, testing::IsSupersetOf(
                           {"run", "lab shear", "soil icra2021 list", "study run", "teleop bench", "version"}));
}

TEST(Help, GroupsTheCommandsAndTheOptionsOfLongCommands) {
  const std::string program = runHaptolith("--help").output;
  for (const char* group : {"Run", "Record", "Soil", "Study", "Remote", "Developer"}) {
    EXPECT_THAT(program, HasSubstr(fmt::format("\n\n{} commands:\n  ", group)));
  }
  const std::string run = runHaptolith("run --help").output;
  for (const char* group : {"Soil and scene", "Hand and device", "Run", "Output", "Browser view"}) {
    EXPECT_THAT(run, HasSubstr(fmt::format("\n\n{}:\n  --", group)));
  }
}

TEST(Usage, NoCommandShowsTheHelpAsAnError) {
  const ProgramResult result = runHaptolith("");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_THAT(result.errors, HasSubstr("Usage: haptolith"));
}

TEST(Usage, UnknownCommandsAreNamedAndTheNearestIsOffered) {
  const ProgramResult result = runHaptolith("completoin bash");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_THAT(result.errors, HasSubstr("haptolith: error: unknown command 'completoin'; did you mean completion?\n"));
}

TEST(Usage, UnknownOptionsAreNamed) {
  const ProgramResult result = runHaptolith("--bogus");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, HasSubstr("haptolith: error: unknown option '--bogus'\n"));
}

TEST(Usage, TheWordsOfACommandAreSuggestedToo) {
  EXPECT_THAT(runHaptolith("lab sheer").errors,
              StartsWith("haptolith: error: unknown command 'sheer'; did you mean shear?\n"));
  EXPECT_THAT(runHaptolith("lab").errors, StartsWith("haptolith: error: a command is missing: must be "));
  EXPECT_THAT(runHaptolith("run icra2021 --duration 3").errors,
              StartsWith("haptolith: error: unknown option '--duration'; did you mean --duration-s?\n"));
  EXPECT_THAT(runHaptolith("soil icra2021 profile --gravity 3").errors, HasSubstr("did you mean --gravity-m-s2?"));
  EXPECT_THAT(runHaptolith("devices now").errors, StartsWith("haptolith: error: unexpected argument 'now'\n"));
}

TEST(Usage, WrongValuesOfOptionsAreToldWithWhatIsValid) {
  const auto errorOf = [](const std::string& arguments) {
    const ProgramResult result = runHaptolith(arguments);
    EXPECT_EQ(result.exit_status, 2) << arguments;
    return result.errors;
  };
  EXPECT_THAT(errorOf("run --motion dig"),
              StartsWith("haptolith: error: --motion: 'dig' is not valid: must be carry, cut, "
                         "furrows, press, scoop, shake, still or stir"));
  EXPECT_THAT(errorOf("run --motion shak"), HasSubstr("; did you mean shake?\n"));
  EXPECT_THAT(errorOf("run --port 99999"),
              StartsWith("haptolith: error: --port: 99999 is not valid: must be a whole number, 0 to 65535\n"));
  EXPECT_THAT(errorOf("run --duration-s -1"),
              StartsWith("haptolith: error: --duration-s: -1 is not valid: must be 0 to 10000000\n"));
  EXPECT_THAT(errorOf("run --duration-s soon"), HasSubstr("'soon' is not valid: must be a number, 0 to 10000000\n"));
  EXPECT_THAT(errorOf("run --cpu first"), HasSubstr("--cpu: 'first' is not valid: must be a whole number\n"));
  EXPECT_THAT(errorOf("run --port"), StartsWith("haptolith: error: --port needs a value\n"));
  EXPECT_THAT(errorOf("run --preset P1 --soil dry-sand"), HasSubstr("cannot both be given\n"));
}

TEST(Usage, ErrorsOfACommandPointToItsHelp) {
  const ProgramResult result = runHaptolith("completion tcsh");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_THAT(result.errors, StartsWith("haptolith: error: "));
  EXPECT_THAT(result.errors, HasSubstr("'haptolith completion --help'"));
}

TEST(Run, ASceneThatIsWrongIsAUsageErrorWithItsLine) {
  const std::string path = testing::TempDir() + "haptolith_wrong_scene.toml";
  std::ofstream(path) << "[bed]\nlayers = 0\n";
  const ProgramResult result = runHaptolith("run '" + path + "'");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_THAT(result.errors, StartsWith("haptolith: error: " + path + ":2: [bed] layers = 0 is not valid"));
}

/// Instrumented, what takes half a minute to settle takes ten.
bool takesMinutesToSettle([[maybe_unused]] const std::filesystem::path& scene) {
#ifdef __SANITIZE_ADDRESS__
  return scene.filename() == "fine-grains.toml";
#else
  return false;
#endif
}

TEST(Run, EveryShippedSceneRuns) {
  for (const auto& entry : std::filesystem::directory_iterator(sourceDir() / "scenes")) {
    if (entry.path().extension() == ".toml" && !takesMinutesToSettle(entry.path())) {
      const ProgramResult result = runHaptolith("run '" + entry.path().string() + "' --no-realtime --duration-s 0.05");
      EXPECT_EQ(result.exit_status, 0) << entry.path() << ": " << result.errors;
    }
  }
}

TEST(Run, BuiltInScenesHaveNamesEverywhere) {
  const ProgramResult result = runInShell("cd / && \"$HAPTOLITH\" run rain --no-realtime --duration-s 0.05");
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_THAT(result.output, StartsWith("Loose soil from rain"));
  const std::string scenes = runHaptolith("scenes").output;
  EXPECT_THAT(scenes, HasSubstr("sandbox        A sandbox of 1 m x 1 m"));
  EXPECT_THAT(scenes, HasSubstr("Soil at the robot's site, for the operator's model in teleop-model.toml"));
  EXPECT_THAT(runHaptolith("run sandbx").errors, HasSubstr("did you mean sandbox?"));
}

TEST(Run, AnOldPathOfAShippedSceneStillRuns) {
  const ProgramResult result =
      runHaptolith(fmt::format("run '{}/scenarios/rain.toml' --no-realtime --duration-s 0.05", sourceDir().string()));
  EXPECT_EQ(result.exit_status, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("scenes/rain.toml"));
}

TEST(Run, ScenesOptionsAndKeysOfAnEarlierVersionStillWork) {
  const ProgramResult plate = runHaptolith(
      fmt::format("run '{}/scenes/plate-in-sand.toml' --no-realtime --duration-s 0.01", sourceDir().string()));
  EXPECT_EQ(plate.exit_status, 0) << plate.errors;
  EXPECT_THAT(plate.errors, HasSubstr("scenes/plate-recorded.toml"));
  const ProgramResult paper = runHaptolith(
      "run paper --unpaced --hand still --duration-s 0.01 --set safety.calm_s=2 --set hand.manoeuvre=press");
  EXPECT_EQ(paper.exit_status, 0) << paper.errors;
  for (const char* told : {"--unpaced is now --no-realtime", "--hand is now --motion",
                           "safety.calm_s is now safety.recovery_s", "hand.manoeuvre is now hand.motion"}) {
    EXPECT_THAT(paper.errors, HasSubstr(told));
  }
}

TEST(Run, AKeyWithoutEffectIsAWarning) {
  const std::string path = testing::TempDir() + "haptolith_idle_key.toml";
  std::ofstream(path) << "[soil]\npreset = 'P3'\ncontact_friction = 0.4\n";
  const std::string run = "run '" + path + "' --no-realtime --duration-s 0.01";
  EXPECT_THAT(runHaptolith(run).errors,
              HasSubstr("warning: " + path + ":3: [soil] contact_friction has no effect: it needs"));
  EXPECT_THAT(runHaptolith(run + " --friction-model contact").errors, Not(HasSubstr("no effect")));
}

TEST(Run, SaysWhatItSaved) {
  const std::string path = testing::TempDir() + "haptolith_told.csv";
  const std::string run = "run icra2021 --no-realtime --overwrite --duration-s 0.05 --trace '" + path + "'";
  const ProgramResult told = runHaptolith(run);
  EXPECT_THAT(told.output, testing::ContainsRegex("saved " + path + ": 50 rows of [0-9]+ columns\n"));
  EXPECT_THAT(told.output, HasSubstr("deadlines  none: not in real time"));
  const ProgramResult json = runHaptolith(run + " --json");
  EXPECT_THAT(json.output, Not(HasSubstr("saved")));
  EXPECT_THAT(json.errors, HasSubstr("saved " + path));
}

TEST(Run, RefusesTwoOutputsOfOneName) {
  const std::string folder = testing::TempDir(), name = folder + "haptolith_twice";
  for (const std::string& two :
       {fmt::format("--record {0}.h5 --trace {0}.h5", name), fmt::format("--trace {0}.svg --figure {0}.svg", name),
        fmt::format("--trace {0}.svg --figure {1}/./haptolith_twice.svg", name, folder)}) {
    const ProgramResult refused = runHaptolith("run icra2021 --no-realtime --duration-s 0.05 --overwrite " + two);
    EXPECT_EQ(refused.exit_status, 2) << two;
    EXPECT_THAT(refused.errors, HasSubstr("name the same file")) << two;
  }
  EXPECT_THAT(runHaptolith("run icra2021 --no-realtime --duration-s 0.05 --trace -").errors,
              HasSubstr("must be a file name"));
}

TEST(Run, APortThatWasAskedForIsThatOrAFailure) {
  const ProgramResult result = runInShell(
      "python3 -c 'import socket, subprocess, os, sys\n"
      "taken = socket.create_server((\"127.0.0.1\", 0))\n"
      "sys.exit(subprocess.call([os.environ[\"HAPTOLITH\"], \"run\", \"--duration-s\", \"0.1\", \"--port\", "
      "str(taken.getsockname()[1])]))'");
  EXPECT_EQ(result.exit_status, 1) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("cannot listen on 127.0.0.1, port "));
}

TEST(StatusLine, IsCutToTheTerminalsWidth) {
  const ProgramResult result = runInShell(
      "script -qec 'stty cols 60; \"$HAPTOLITH\" run icra2021 --no-serve --duration-s 0.5 > /dev/null' /dev/null");
  std::size_t longest = 0;
  for (std::size_t at = result.output.find("\033[K"); at != std::string::npos;) {
    const std::size_t next = result.output.find("\033[K", at + 3);
    std::string line = result.output.substr(at + 3, next == std::string::npos ? next : next - at - 3);
    line = line.substr(0, line.find_first_of("\r\n"));
    if (line.find("force") != std::string::npos) {  // no warning
      longest = std::max(longest, line.size());
    }
    at = next;
  }
  EXPECT_GT(longest, 30U) << result.output;
  EXPECT_LE(longest, 59U + std::string("\033[36m\033[0m").size());
}

TEST(StandardError, IsNotColouredInAFile) {
  EXPECT_THAT(runHaptolith("--bogus").errors, Not(HasSubstr("\033")));
}

TEST(StandardOutput, AFullDiskIsAFailure) {
  for (const char* arguments : {"--version > /dev/full", "--help > /dev/full", "completion bash > /dev/full"}) {
    const ProgramResult result = runHaptolith(arguments);
    EXPECT_EQ(result.exit_status, 1) << arguments;
    EXPECT_THAT(result.errors, HasSubstr("cannot write to standard output: No space left on device")) << arguments;
  }
}

TEST(StandardOutput, AClosedPipeIsAFailure) {
  const ProgramResult result = runHaptolith("completion zsh >&-");
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.errors, HasSubstr("cannot write to standard output"));
}

/// Completions of bash after `words`, which are words of a bash array; the last is the one under the cursor.
std::string bashOffers(const std::string& words) {
  return runHaptolith(
             "completion bash > /dev/null; bash -c 'source <(\"$HAPTOLITH\" completion bash);"
             " COMP_WORDS=(haptolith " +
             words + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _haptolith; echo \"${COMPREPLY[*]}\"'")
      .output;
}

TEST(StandardError, ThatNobodyReadsIsNoReasonToCrash) {
  for (const char* arguments : {"run --preset P9", "nonsense", "run /no/such/scene.toml"}) {
    const ProgramResult result =
        runInShell(std::string("bash -c '\"$HAPTOLITH\" ") + arguments + " 2> >(exec true); exit $?'");
    EXPECT_EQ(result.exit_status, 2) << arguments;
  }
  EXPECT_EQ(runInShell("\"$HAPTOLITH\" run --preset P9 2>&-").exit_status, 2);
  EXPECT_EQ(runInShell("\"$HAPTOLITH\" run --preset P9 2> /dev/full").exit_status, 2);
}

TEST(Completion, BashOffersCommandsOptionsAndChoices) {
  EXPECT_EQ(bashOffers("compl"), "completion\n");
  EXPECT_EQ(bashOffers("--ver"), "--version\n");
  EXPECT_EQ(bashOffers("completion b"), "bash\n");
  EXPECT_EQ(bashOffers("completion --"), "--help\n");
  EXPECT_EQ(bashOffers("run --motion s"), "scoop shake still stir\n");
  EXPECT_EQ(bashOffers("run --body E"), "Europa Earth\n");
  EXPECT_EQ(bashOffers("run --soil lunar"), "lunar-0-15cm lunar-trafficability\n");
  EXPECT_EQ(bashOffers("run --friction-model c"), "contact\n");
  EXPECT_EQ(bashOffers("soil cal"), "calibrate\n");
  EXPECT_EQ(bashOffers("soil icra"), "icra2021\n");
  EXPECT_EQ(bashOffers("soil icra2021 p"), "profile\n");
  EXPECT_EQ(bashOffers("soil icra2021 profile --preset P3 --body E"), "Europa Earth\n");
  EXPECT_EQ(bashOffers("bench --friction-model c"), "contact\n");
  EXPECT_EQ(bashOffers("lab plate --preparation l"), "loose\n");
  EXPECT_EQ(bashOffers("run sand"), "sandbox\n");
  EXPECT_EQ(bashOffers("study new x --protocol icra2021-f"), "icra2021-friction\n");
}

TEST(Completion, OtherShellsHaveTheirOwn) {
  EXPECT_THAT(runHaptolith("completion zsh").output, StartsWith("#compdef haptolith\n"));
  EXPECT_THAT(runHaptolith("completion fish").output, HasSubstr("complete -c haptolith "));
}

TEST(Completion, ScriptsPassTheirShellsSyntaxCheck) {
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    if (std::system(("command -v " + shell + " > /dev/null").c_str()) == 0) {
      const ProgramResult result = runHaptolith(fmt::format("completion {0} | {0} -n", shell));
      EXPECT_EQ(result.exit_status, 0) << shell << ": " << result.errors;
    }
  }
}

TEST(CommandLine, WhatATerminalWouldObeyIsShownInErrors) {
  const ProgramResult result = runInShell("\"$HAPTOLITH\" run \"$(printf '\\033]0;pwned\\007.toml')\"");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, testing::HasSubstr("\\u001b]0;pwned\\u0007.toml: no such file"));
  EXPECT_THAT(result.errors, testing::Not(testing::HasSubstr("\033")));
}

}  // namespace
}  // namespace haptolith

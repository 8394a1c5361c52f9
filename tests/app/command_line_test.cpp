#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "../source_dir.h"
#include "program.h"

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

TEST(Version, IsOneLine) {
  const ProgramResult result = runHaptolith("--version");
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(result.output, "haptolith 0.1.0\n");
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

TEST(Run, EveryShippedSceneRuns) {
  for (const auto& entry : std::filesystem::directory_iterator(sourceDir() / "scenarios")) {
    if (entry.path().extension() == ".toml") {
      const ProgramResult result = runHaptolith("run '" + entry.path().string() + "' --unpaced --duration-s 0.05");
      EXPECT_EQ(result.exit_status, 0) << entry.path() << ": " << result.errors;
    }
  }
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

/// What bash offers after `words`, which are words of a bash array; the last is the one under the cursor.
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
  EXPECT_EQ(bashOffers("run --hand s"), "scoop shake still stir\n");
  EXPECT_EQ(bashOffers("run --body E"), "Europa Earth\n");
  EXPECT_EQ(bashOffers("run --soil lunar"), "lunar-0-15cm lunar-trafficability\n");
  EXPECT_EQ(bashOffers("run --friction p"), "pairwise paper\n");
  EXPECT_EQ(bashOffers("soil prof"), "profile\n");
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

#include "program.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace haptolith {

namespace {

std::string takeFile(const std::string& path) {
  std::ifstream file(path);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::filesystem::remove(path);
  return text;
}

}  // namespace

ProgramResult runInShell(const std::string& command) {
  const std::string stem = fmt::format("{}haptolith_app_{}", testing::TempDir(), getpid());
  setenv("HAPTOLITH", HAPTOLITH_EXECUTABLE, 1);
  setenv("HAPTOLITH_CACHE", "off", 1);  // the user's is neither read nor filled
  setenv("XDG_STATE_HOME", stem.c_str(), 1);
  setenv("RECORDING_HELPER", RECORDING_HELPER_EXECUTABLE, 1);
  const int status =
      std::system(fmt::format("{{ {}; }} > '{}.out' 2> '{}.err' < /dev/null", command, stem, stem).c_str());
  std::filesystem::remove_all(stem);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, takeFile(stem + ".out"), takeFile(stem + ".err")};
}

ProgramResult runHaptolith(const std::string& arguments) {
  return runInShell("\"$HAPTOLITH\" " + arguments);
}

}  // namespace haptolith

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

ProgramResult runHaptolith(const std::string& arguments) {
  const std::string stem = fmt::format("{}haptolith_app_{}", testing::TempDir(), getpid());
  const std::string command =
      fmt::format("{{ '{}' {}; }} > '{}.out' 2> '{}.err' < /dev/null", HAPTOLITH_EXECUTABLE, arguments, stem, stem);
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, takeFile(stem + ".out"), takeFile(stem + ".err")};
}

}  // namespace haptolith

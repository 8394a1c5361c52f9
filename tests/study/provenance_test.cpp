#include "haptolith/study/store/provenance.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

TEST(Provenance, HashesTextsAsTheStandardDoes) {
  // FIPS 180-4's examples.
  EXPECT_EQ(sha256Of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256Of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Provenance, NamesTheMachineByWhatItIsAndNotByItsName) {
  const fs::path root = fs::path(testing::TempDir()) / fmt::format("haptolith_provenance_{}", getpid());
  fs::create_directories(root / "etc");
  fs::create_directories(root / "proc");
  std::ofstream(root / "etc/os-release") << "NAME=\"Debian\"\nPRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\n";
  std::ofstream(root / "proc/cpuinfo") << "processor\t: 0\nmodel name\t: A CPU @ 3 GHz\nmodel name\t: another\n";
  const Machine machine = thisMachine(root);
  EXPECT_EQ(machine.os, "Debian GNU/Linux 12 (bookworm)");
  EXPECT_EQ(machine.cpu, "A CPU @ 3 GHz");
  EXPECT_THAT(machine.kernel, HasSubstr("Linux"));
  std::array<char, 256> host{};
  ASSERT_EQ(gethostname(host.data(), host.size() - 1), 0);
  EXPECT_THAT(machine.kernel, Not(HasSubstr(host.data())));
  EXPECT_EQ(thisMachine(root / "nothing").os, "");
  fs::remove_all(root);
}

}  // namespace
}  // namespace haptolith

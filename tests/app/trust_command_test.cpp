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
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

class TrustCommand : public testing::Test {
 protected:
  TrustCommand() { fs::create_directories(folder_); }
  ~TrustCommand() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] static std::string textOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const fs::path folder_ = fs::temp_directory_path() / fmt::format("haptolith_trust_{}", getpid());
};

TEST_F(TrustCommand, SaysHowFarAForceCanBeBelieved) {
  const ProgramResult told = runHaptolith(
      "trust icra2021 --duration-s 1 --specimens 3 --only wide-x,step,awake,bits --figure " + path("a.svg"));
  ASSERT_EQ(told.exit_status, 0) << told.errors;
  EXPECT_THAT(told.output, AllOf(HasSubstr("Mean force within "), HasSubstr("box twice as wide, x"),
                                 HasSubstr("no particle sleeps"), HasSubstr("Bits on one and two threads: equal"),
                                 HasSubstr("Continued from a saved state: equal"), HasSubstr("a.svg")));
  EXPECT_THAT(told.output, Not(HasSubstr("box twice as wide, y")));
  EXPECT_THAT(textOf(path("a.svg")), HasSubstr("</svg>"));
}

TEST_F(TrustCommand, KeepsWhatItHasAndGoesOn) {
  const std::string command = "trust icra2021 --duration-s 1 --specimens 2 --only wide-y --json --out " + path("kept");
  const ProgramResult one = runHaptolith(command);
  ASSERT_EQ(one.exit_status, 0) << one.errors;
  EXPECT_THAT(textOf(path("kept/trust.md")),
              AllOf(HasSubstr("haptolith trust icra2021"), HasSubstr("**Mean force within"), HasSubstr("trust.svg")));
  const ProgramResult refused = runHaptolith(command);
  EXPECT_EQ(refused.exit_status, 1);
  fs::remove(path("kept/results/wide-y-1.json"));
  const ProgramResult again = runHaptolith(command + " --resume");
  ASSERT_EQ(again.exit_status, 0) << again.errors;
  EXPECT_THAT(again.errors, AllOf(HasSubstr("3 of 4 results are already available"), HasSubstr("[4/4]")));
  Json first = Json::parse(one.output), second = Json::parse(again.output);
  EXPECT_EQ(first.at("effects"), second.at("effects"));
  EXPECT_EQ(first.at("sentence"), second.at("sentence"));

  std::ofstream(path("kept/results/wide-y-1.json")) << "{\"mean_n\": 1}";
  const ProgramResult damaged = runHaptolith(command + " --resume");
  EXPECT_EQ(damaged.exit_status, 1);
  EXPECT_THAT(damaged.errors, HasSubstr("is not a result of trust"));
  EXPECT_EQ(runHaptolith(command + " --resume --set hand.depth_mm=10").exit_status, 1) << "another scene";
}

// A narrow box, a shallow bed and coarse particles are reported.
TEST_F(TrustCommand, NoticesWhatIsTooSmall) {
  const auto sentence = [](const std::string& options) {
    const ProgramResult told =
        runHaptolith("trust icra2021 --specimens 3 --json --only wide-x,wide-y,deep,radius " + options);
    EXPECT_EQ(told.exit_status, 0) << told.errors;
    return Json::parse(told.output).at("sentence").get<std::string>();
  };
  EXPECT_THAT(sentence("--set bed.width_mm=63 --set bed.particles=128"), HasSubstr("too narrow along x"));
  EXPECT_THAT(sentence("--set bed.length_mm=50 --set bed.particles=100"), HasSubstr("too narrow along"));
  EXPECT_THAT(sentence("--set hand.motion=press --set bed.particles=128 --set bed.layers=2"),
              HasSubstr("the floor is felt"));
}

TEST_F(TrustCommand, SaysWhenThereIsNoForce) {
  const ProgramResult told = runHaptolith("trust icra2021 --motion still --specimens 2 --only specimen");
  EXPECT_EQ(told.exit_status, 0) << told.errors;
  EXPECT_THAT(told.output, HasSubstr("does not touch the soil"));
}

TEST_F(TrustCommand, RefusesNonsense) {
  for (const char* wrong : {"--specimens 1", "--minutes 0", "--minutes nan", "--duration-s 0.1", "--only wide",
                            "--quick --minutes 3", "--resume", "--set bed.width_mm=1"}) {
    EXPECT_EQ(runHaptolith(fmt::format("trust icra2021 {}", wrong)).exit_status, 2) << wrong;
  }
  EXPECT_EQ(runHaptolith("trust icra2021 --set hand.home_mm=[5000,0,85]").exit_status, 1);
}

TEST_F(TrustCommand, ABandTestGoesOnFromSavedScenes) {
  fs::create_directories(folder_ / "band/results");
  const std::string version = runHaptolith("version").output;
  std::ofstream(folder_ / "band/conditions.json")
      << Json{{"force_band", version.substr(0, version.find('\n'))}, {"simd", "SCALAR"}}.dump();
  const auto window = [](double reference_n) {
    return Json{{"force_n", 2.7}, {"contacts", 3.4}, {"particle_n", 0.08}, {"reference_n", reference_n}};
  };
  std::ofstream(folder_ / "band/results/scene-450.json") << Json{{"windows", {window(3), window(9)}}}.dump();
  const std::string command = "HAPTOLITH_SIMD=SCALAR \"$HAPTOLITH\" lab force-band --scenes 1 --resume --json --out ";
  const ProgramResult resumed = runInShell(command + path("band"));
  ASSERT_EQ(resumed.exit_status, 0) << resumed.errors;
  EXPECT_EQ(Json::parse(resumed.output).at("windows"), 2);
  EXPECT_EQ(Json::parse(resumed.output).at("held"), 0.5) << "the band is 1.8 to 3.8 N";

  std::ofstream(folder_ / "band/results/scene-450.json") << R"({"windows": [{"force_n": 1}]})";
  const ProgramResult damaged = runInShell(command + path("band"));
  EXPECT_EQ(damaged.exit_status, 1);
  EXPECT_THAT(damaged.errors, AllOf(HasSubstr("scene-450.json"), HasSubstr("contacts"), HasSubstr("--resume repeats")));
}

}  // namespace
}  // namespace haptolith

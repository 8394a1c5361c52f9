#include <fmt/format.h>
#include <gmock/gmock.h>
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
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

std::string textOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Claims that the quickest tests alone measure.
class LabValidateCommand : public testing::Test {
 protected:
  LabValidateCommand() { fs::create_directories(folder_); }
  ~LabValidateCommand() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string validation(const std::string& name, const std::string& options) const {
    return fmt::format("lab validate --threads 1 --out {} {}", (folder_ / name).string(), options);
  }
  [[nodiscard]] std::string claims(const std::string& text) const {
    const fs::path path = folder_ / "claims.toml";
    std::ofstream(path) << text;
    return "--claims " + path.string();
  }
  [[nodiscard]] std::string page(const std::string& name) const { return textOf(folder_ / name / "validation.md"); }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith_validate_" + std::to_string(getpid()));
};

const std::string kFall =
    "[[claim]]\nid = 'fall'\ngroup = 'Newton'\nclaim = 'Falls with g'\nreference = 'Newton'\ntest = 'free-fall'\n"
    "soil = 'dry-sand'\nours = '/acceleration_ratio'\n";

TEST_F(LabValidateCommand, SaysOfEachClaimHowItStandsAndGoesOnWithWhatIsMissing) {
  const std::string file =
      claims(kFall + "expected = 1\nwithin = 0.01\n" +
             "[[claim]]\nid = 'wrong'\ngroup = 'Newton'\nclaim = 'Falls with half of it'\n"
             "test = 'free-fall'\nsoil = 'dry-sand'\nours = '/acceleration_ratio'\nexpected = 0.5\n"
             "factor = 1.2\nnote = 'Galilei would not have it.'\n");
  const ProgramResult one = runHaptolith(validation("a", file + " --seeds 1"));
  ASSERT_EQ(one.exit_status, 0) << one.errors;
  EXPECT_THAT(one.errors, ContainsRegex(R"(\[1/1\] free-fall, dry-sand, Earth, seed 1)")) << "one test for both claims";
  EXPECT_THAT(page("a"),
              AllOf(HasSubstr("1.00 | 1.00 | ± 1 % | 1 | 🟡 open |"), HasSubstr("2.00 | factor 1.2 | 1 | 🟡 open"),
                    HasSubstr("Galilei"), HasSubstr("(validation-newton.svg)")));
  EXPECT_THAT(textOf(folder_ / "a" / "validation-newton.svg"), HasSubstr("</svg>"));

  const ProgramResult refused = runHaptolith(validation("a", file + " --seeds 2"));
  EXPECT_EQ(refused.exit_status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("--resume"));
  const ProgramResult more = runHaptolith(validation("a", file + " --seeds 2 --resume"));
  ASSERT_EQ(more.exit_status, 0) << more.errors;
  EXPECT_THAT(more.errors, AllOf(HasSubstr("1 of 2 results are already available"), HasSubstr("[2/2] free-fall"),
                                 Not(HasSubstr("seed 1"))));
  EXPECT_THAT(page("a"), AllOf(HasSubstr("| 2 | 🟢 holds |"), HasSubstr("factor 1.2 | 2 | 🔴 fails")));
}

TEST_F(LabValidateCommand, AcceptsTheNameOfATestInAnEarlierVersion) {
  std::string former = kFall;
  former.replace(former.find("free-fall"), 9, "fall");
  const ProgramResult run =
      runHaptolith(validation("former", claims(former + "expected = 1\nwithin = 0.01\n") + " --seeds 1"));
  ASSERT_EQ(run.exit_status, 0) << run.errors;
  EXPECT_THAT(run.errors, AllOf(HasSubstr("fall is now free-fall; the old name works"), HasSubstr("[1/1] free-fall")));
}

TEST_F(LabValidateCommand, SaysWhichClaimPointsWhereNoNumberIs) {
  std::string wrong = kFall;
  wrong.replace(wrong.find("/acceleration_ratio"), 19, "/acceleration");
  const ProgramResult run =
      runHaptolith(validation("wrong", claims(wrong + "expected = 1\nwithin = 0.01\n") + " --seeds 1"));
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_THAT(run.errors, AllOf(HasSubstr("claim fall: ours or other = '/acceleration' is not valid"),
                                HasSubstr("/acceleration_ratio")));
}

TEST_F(LabValidateCommand, MeasuresOneConditionOverAnother) {
  const ProgramResult run = runHaptolith(validation(
      "over",
      claims(kFall + "expected = 1\nwithin = 0.01\nbody = 'Earth'\n[claim.over]\nbody = 'Moon'\n") + " --seeds 2"));
  ASSERT_EQ(run.exit_status, 0) << run.errors;
  EXPECT_THAT(run.errors, AllOf(HasSubstr("Earth"), HasSubstr("Moon"), HasSubstr("[4/4]")));
  EXPECT_THAT(page("over"), HasSubstr("🟢"));
}

TEST_F(LabValidateCommand, RunsClaimsAboutAnySoilWithAnother) {
  const ProgramResult run = runHaptolith(validation("soil", "--only newton-fall --soil toyoura --seeds 1"));
  ASSERT_EQ(run.exit_status, 0) << run.errors;
  EXPECT_THAT(run.errors, HasSubstr("free-fall, toyoura, Moon"));
  const ProgramResult none = runHaptolith(validation("soil2", "--only moon-srp --soil toyoura"));
  EXPECT_EQ(none.exit_status, 2);
  EXPECT_THAT(none.errors, HasSubstr("any_soil"));
}

TEST_F(LabValidateCommand, FindsSoilFilesBesideTheClaims) {
  std::ofstream(folder_ / "mine.toml")
      << "name = 'mine'\n[target]\nbulk_density_kg_m3 = 1500\nfriction_angle_deg = "
         "35\ncohesion_pa = 0\n[soil]\nradius_mm = 7\nrho0_kg_m3 = 1500\nrho_max_kg_m3 = 2000\ngamma_nm = "
         "4e-5\nstiffness_n_m = 3000\nfriction_model = 'contact'\n"
         "contact_friction = 0.4\ncontact_cohesion_n = 0\n";
  std::string text = kFall + "expected = 1\nwithin = 0.01\n";
  text.replace(text.find("dry-sand"), 8, "mine.toml");
  const ProgramResult run = runHaptolith(validation("beside", claims(text) + " --seeds 2"));
  ASSERT_EQ(run.exit_status, 0) << run.errors;
  EXPECT_THAT(run.errors, HasSubstr("free-fall, mine, Earth"));
  EXPECT_THAT(page("beside"), HasSubstr("🟢"));

  fs::remove(folder_ / "mine.toml");
  const ProgramResult gone = runHaptolith(validation("gone", claims(text) + " --seeds 1"));
  EXPECT_NE(gone.exit_status, 0);
  EXPECT_THAT(gone.errors, HasSubstr((folder_ / "mine.toml").string()));
}

TEST_F(LabValidateCommand, RefusesNonsenseWithItsPlace) {
  const auto refused = [&](const std::string& text, const std::string& said) {
    const ProgramResult run = runHaptolith(validation("no", claims(text)));
    EXPECT_EQ(run.exit_status, 2) << text;
    EXPECT_THAT(run.errors, HasSubstr(said));
    EXPECT_FALSE(fs::exists(folder_ / "no"));
  };
  refused("", "empty");
  refused("claim = []\n", "each under [[claim]]");
  refused(kFall, "claims.toml:1: ");
  refused(kFall + "expected = 1\n", "exactly one of them");
  refused(kFall + "expected = 1\nwithin = 0.1\nfactor = 2\n", "2 of them");
  refused(kFall + "expected = 1\nwithin = 1.5\n", "claims.toml:10: ");
  refused(kFall + "expected = 1\nwithin = 0.1\nnonsense = 3\n", "nonsense");
  refused(kFall + "expected = 1\nwithin = 0.1\nkind = 'tuned'\n", "independent, calibrated or consistency");
  refused(kFall + "expected = 1\nwithin = 0.1\nbody = 'Vulcan'\n", "Vulcan");
  refused(kFall + "expected = 1\nwithin = 0.1\n[claim.options]\ndepth_mm = 3\n", "depth_mm");
  refused(kFall + "expected = 1\nwithin = 0.1\n" + kFall + "expected = 1\nwithin = 0.1\n", "another claim");
  std::string no_slash = kFall + "expected = 1\nwithin = 0.1\n";
  no_slash.erase(no_slash.find('/'), 1);
  refused(no_slash, "begins with /");
  const ProgramResult only = runHaptolith(validation("no", "--only nonsense"));
  EXPECT_EQ(only.exit_status, 2);
  EXPECT_THAT(only.errors, HasSubstr("a group: "));
}

TEST_F(LabValidateCommand, AWrongPlaceInTheResultIsTold) {
  std::string text = kFall + "expected = 1\nwithin = 0.1\n";
  text.replace(text.find("/acceleration_ratio"), 19, "/nowhere");
  const ProgramResult run = runHaptolith(validation("no", claims(text) + " --seeds 1"));
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_THAT(run.errors, HasSubstr("/nowhere"));
}

}  // namespace
}  // namespace haptolith

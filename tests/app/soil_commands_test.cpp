#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "program.h"

// The program as its users meet it: arguments in; stdout, stderr and the exit status out.

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class SoilCommands : public testing::Test {
 protected:
  SoilCommands() { fs::create_directories(folder_); }
  ~SoilCommands() override { fs::remove_all(folder_); }

  static std::string textOf(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  static json runJson(const std::string& arguments) {
    const ProgramResult answer = runHaptolith(arguments + " --json");
    EXPECT_EQ(answer.exit_status, 0) << answer.errors;
    EXPECT_THAT(answer.errors, IsEmpty());
    return json::parse(answer.output);
  }
  static void expectWrongUse(const std::string& arguments, const std::string& words) {
    const ProgramResult answer = runHaptolith(arguments);
    EXPECT_EQ(answer.exit_status, 2) << arguments;
    EXPECT_THAT(answer.output, IsEmpty()) << arguments;
    EXPECT_THAT(answer.errors, HasSubstr(words)) << arguments;
  }

  const fs::path folder_ = fs::temp_directory_path() / ("haptolith-soil-commands-test-" + std::to_string(getpid()));
};

TEST_F(SoilCommands, ProfileTellsTheWholeSoil) {
  const json profile = runJson("soil icra2021 profile --preset p3");
  EXPECT_EQ(profile["parameters"]["preset"], "P3");
  EXPECT_EQ(profile["parameters"]["body"], "Moon");
  EXPECT_EQ(profile["parameters"]["gravity_m_s2"], 1.625);
  EXPECT_TRUE(profile["parameters"]["stiffness_n_m"].is_null());  // infinite
  EXPECT_NEAR(profile["cohesion_pa"], 996, 1);
  EXPECT_NEAR(profile["friction_coefficient"], 0.838, 0.001);
  EXPECT_NEAR(profile["friction_angle_deg"], 40, 0.1);
  EXPECT_EQ(profile["layers"][0]["layer"], 0);
  EXPECT_NEAR(profile["layers"][0]["spacing_m"], 0.01143, 1e-5);
  EXPECT_GE(profile["layers"].back()["depth_m"], 0.59);
  const double ours[]{1485, 1562, 1715, 1638}, paper[]{1501, 1579, 1737, 1658};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(profile["bands"][i]["density_kg_m3"], ours[i], 1);
    EXPECT_EQ(profile["bands"][i]["paper_kg_m3"], paper[i]);
  }
}

TEST_F(SoilCommands, ProfileQuotesThePaperOnlyForThePapersSoil) {
  for (const char* change : {"--body Mars", "--gravity-m-s2 1.6", "--radius-mm 3", "--stiffness-n-m 100"}) {
    const json profile = runJson(std::string("soil icra2021 profile --preset P3 ") + change);
    EXPECT_TRUE(profile["bands"][0]["paper_kg_m3"].is_null()) << change;
  }
  const json same = runJson("soil icra2021 profile --preset P3 --body moon --radius-mm 7 --stiffness-n-m inf");
  EXPECT_EQ(same["bands"][0]["paper_kg_m3"], 1501);
}

TEST_F(SoilCommands, ProfileOfNumbersIsThatOfThePresetWithTheSameNumbers) {
  const json numbers =
      runJson("soil icra2021 profile --gamma-nm 4e-5 --rho0-kg-m3 1330 --rho-max-kg-m3 1824 --mu-hat 0.342");
  const json preset = runJson("soil icra2021 profile --preset P3");
  EXPECT_EQ(numbers["layers"], preset["layers"]);
  EXPECT_EQ(numbers["cohesion_pa"], preset["cohesion_pa"]);
  EXPECT_TRUE(numbers["parameters"]["preset"].is_null());
  EXPECT_TRUE(numbers["bands"][0]["paper_kg_m3"].is_null());
}

TEST_F(SoilCommands, ProfileOfSoilTooDenseToCompactHasNoCohesion) {
  const std::string soil = "soil icra2021 profile --gamma-nm 4e-5 --rho0-kg-m3 2000 --rho-max-kg-m3 2600 --mu-hat 0.3";
  EXPECT_TRUE(runJson(soil)["cohesion_pa"].is_null());
  EXPECT_THAT(runHaptolith(soil).output, HasSubstr("cohesion undefined"));
}

TEST_F(SoilCommands, ProfileDrawsFigures) {
  for (const char* soil : {"--preset P3", "--preset P1 --body Earth --stiffness-n-m 100000",
                           "--gamma-nm 4e-5 --rho0-kg-m3 1330 --rho-max-kg-m3 1824 --mu-hat 0.342"}) {
    const fs::path figure = folder_ / "figure.svg";
    fs::remove(figure);
    const ProgramResult answer =
        runHaptolith(std::string("soil icra2021 profile --figure ") + figure.string() + " " + soil);
    EXPECT_EQ(answer.exit_status, 0) << answer.errors;
    EXPECT_THAT(textOf(figure), HasSubstr("lunar law"));
  }
}

TEST_F(SoilCommands, TextIsForPeople) {
  const ProgramResult answer = runHaptolith("soil icra2021 profile --preset P3");
  EXPECT_EQ(answer.exit_status, 0);
  EXPECT_THAT(answer.output, HasSubstr("Soil P3 (Moon, gravity 1.625 m/s², R = 7 mm, k infinite)"));
  EXPECT_THAT(answer.output, HasSubstr("1500 ± 50   1501"));
  EXPECT_THAT(runHaptolith("soil icra2021 calibrate --friction-coefficient 0.9 --cohesion-pa 970").output,
              HasSubstr("1580 ± 50"));
  EXPECT_THAT(runHaptolith("soil icra2021 calibrate --friction-coefficient 0.9 --cohesion-pa 970 --body Earth").output,
              HasSubstr("outside the measurement"));
  EXPECT_THAT(runHaptolith("soil icra2021 list").output, HasSubstr("P6"));
}

TEST_F(SoilCommands, WrongUseOfProfileIsToldAndHasStatusTwo) {
  expectWrongUse("soil icra2021 profile", "--preset");
  expectWrongUse("soil icra2021 profile --gamma-nm 1e-5", "--rho0-kg-m3");
  expectWrongUse("soil icra2021 profile --preset P3 --gamma-nm 1e-5", "cannot both be given");
  expectWrongUse("soil icra2021 profile --preset P3 --body Moon --gravity-m-s2 1", "cannot both be given");
  expectWrongUse("soil icra2021 profile --preset P9", "P1, P2, P3, P4, P5, P6");
  expectWrongUse("soil icra2021 profile --preset P3 --body Sun", "Moon");
  expectWrongUse("soil icra2021 profile --preset P3 --gravity-m-s2 -1", "gravity_m_s2 = -1");
  expectWrongUse("soil icra2021 profile --preset P3 --radius-mm 0", "radius_mm = 0");
  expectWrongUse("soil icra2021 profile --preset P3 --radius-mm nan", "radius_mm = nan");
  expectWrongUse("soil icra2021 profile --preset P3 --stiffness-n-m 0", "stiffness_n_m = 0");
  expectWrongUse("soil icra2021 profile --gamma-nm 4e-5 --rho0-kg-m3 1330 --rho-max-kg-m3 1300 --mu-hat 0.3",
                 "rho_max_kg_m3");
  expectWrongUse("soil icra2021 profile --preset P3 --figure figure.pdf", ".svg or .png");
  expectWrongUse("soil", "a command is missing");
}

TEST_F(SoilCommands, ProfileTakesASoilByItsNameOrSaysWhatMeasuresIt) {
  EXPECT_EQ(runJson("soil icra2021 profile --soil p3"), runJson("soil icra2021 profile --preset P3"));
  expectWrongUse("soil icra2021 profile --soil dry-sand", "haptolith lab settle --soil dry-sand");
  expectWrongUse("soil icra2021 profile --soil no-such-soil", "dry-sand");
  expectWrongUse("soil icra2021 profile --soil P3 --preset P4", "--preset");
  expectWrongUse("soil icra2021 profile --soil P3 --mu-hat 0.3", "--mu-hat");
  expectWrongUse("soil icra2021 profile", "--preset, --soil, or all of");
}

TEST_F(SoilCommands, SoilThatCannotCarryItselfIsAFailure) {
  const ProgramResult answer =
      runHaptolith("soil icra2021 profile --preset P3 --body Earth --stiffness-n-m 100 --json");
  EXPECT_EQ(answer.exit_status, 1);
  EXPECT_THAT(answer.output, IsEmpty());
  EXPECT_THAT(answer.errors, HasSubstr("larger stiffness_n_m"));
}

TEST_F(SoilCommands, CalibrateGivesASoilThatProfileConfirms) {
  const json soil = runJson("soil icra2021 calibrate --friction-coefficient 0.9 --cohesion-pa 970 --radius-mm 3");
  EXPECT_EQ(soil["radius_mm"], 3);
  EXPECT_LT(soil["density_rms_kg_m3"], 15);
  std::ostringstream arguments;
  arguments.precision(17);
  arguments << "soil icra2021 profile --radius-mm 3 --gamma-nm " << soil["gamma_nm"] << " --rho0-kg-m3 "
            << soil["rho0_kg_m3"] << " --rho-max-kg-m3 " << soil["rho_max_kg_m3"] << " --mu-hat " << soil["mu_hat"];
  const json profile = runJson(arguments.str());
  EXPECT_NEAR(profile["cohesion_pa"], 970, 0.005 * 970);
  EXPECT_NEAR(profile["friction_coefficient"], 0.9, 1e-9);
}

TEST_F(SoilCommands, WrongUseOfCalibrateIsToldAndHasStatusTwo) {
  expectWrongUse("soil icra2021 calibrate --friction-coefficient 0.9", "--cohesion-pa is required");
  expectWrongUse("soil icra2021 calibrate --friction-coefficient -0.9 --cohesion-pa 970",
                 "friction_coefficient = -0.9");
  expectWrongUse("soil icra2021 calibrate --friction-coefficient 0.9 --cohesion-pa nan", "cohesion_pa = nan");
  expectWrongUse("soil icra2021 calibrate --friction-coefficient 0.9 --cohesion-pa 1e9", "must be > 0 and < ");
  expectWrongUse("soil icra2021 calibrate --friction-coefficient 0.9 --cohesion-pa 970 --radius-mm 25",
                 "radius_mm = 25");
}

TEST_F(SoilCommands, PresetsListsAllSix) {
  const json presets = runJson("soil icra2021 list")["presets"];
  ASSERT_EQ(presets.size(), 6u);
  EXPECT_EQ(presets[3]["name"], "P4");
  EXPECT_EQ(presets[3]["gamma_nm"], 6e-5);
}

TEST_F(SoilCommands, ListTellsWhatWasMeasuredOfTheNamedSoils) {
  const json soils = runJson("soil list")["soils"];
  const auto soil =
      std::find_if(soils.begin(), soils.end(), [](const json& row) { return row["name"] == "surveyor-3"; });
  ASSERT_NE(soil, soils.end());
  EXPECT_EQ((*soil)["bulk_density_kg_m3"], 1500);
  EXPECT_EQ((*soil)["friction_angle_deg"], 37.5);
  EXPECT_EQ((*soil)["friction_angle_range_deg"], json({35, 40}));
  EXPECT_EQ((*soil)["cohesion_pa"], 425);
  EXPECT_EQ((*soil)["friction"], "contact");
  EXPECT_THAT((*soil)["source"], HasSubstr("Surveyor III"));
  const ProgramResult text = runHaptolith("soil list");
  EXPECT_EQ(text.exit_status, 0);
  EXPECT_THAT(text.output, HasSubstr("lunar-0-15cm             1500     42.0        520   Lunar Sourcebook"));
}

TEST_F(SoilCommands, EveryCommandExplainsItselfWithAnExample) {
  for (const char* command : {"soil", "soil list", "soil show", "soil calibrate", "soil icra2021", "soil icra2021 list",
                              "soil icra2021 profile", "soil icra2021 calibrate"}) {
    const ProgramResult answer = runHaptolith(std::string(command) + " --help");
    EXPECT_EQ(answer.exit_status, 0);
    EXPECT_THAT(answer.output, HasSubstr("  haptolith soil ")) << command;
  }
}

// The command is in haptolith-workbench, its parent in the program.
TEST(SoilCalibrate, IsListedByTheProgramAndRunByTheWorkbench) {
  const std::string listed = runHaptolith("soil --help").output;
  EXPECT_THAT(listed, HasSubstr("Calibrate particles to a friction angle, cohesion and bulk density\n"));
  EXPECT_EQ(runInShell("\"$(dirname \"$HAPTOLITH\")/haptolith-workbench\" soil --help").output, listed);
  EXPECT_THAT(runHaptolith("soil calibrate --help").output,
              AllOf(HasSubstr("Usage: haptolith soil calibrate "), HasSubstr("--bulk-density-kg-m3 NUMBER")));
}

TEST(SoilCalibrate, AcceptsItsNameInAnEarlierVersion) {
  const ProgramResult result =
      runHaptolith("lab calibrate --friction-angle-deg 80 --cohesion-pa 0 --bulk-density-kg-m3 1500");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, AllOf(HasSubstr("lab calibrate is now soil calibrate; the old name works until"),
                                   HasSubstr("friction_angle_deg = 80 is not valid")));
}

TEST(SoilIcra2021, AcceptsTheNamesOfCommandsInAnEarlierVersion) {
  const ProgramResult former = runHaptolith("soil presets");
  EXPECT_EQ(former.exit_status, 0) << former.errors;
  EXPECT_EQ(former.output, runHaptolith("soil icra2021 list").output);
  EXPECT_THAT(former.errors, HasSubstr("soil presets is now soil icra2021 list; the old name works until version 0.4"));
}

TEST(SoilShow, HasTheWholeSourceOfASoilThatTheListCuts) {
  const ProgramResult shown = runHaptolith("soil show surveyor-3");
  EXPECT_EQ(shown.exit_status, 0) << shown.errors;
  EXPECT_THAT(shown.output, HasSubstr("Surveyor III"));
  EXPECT_THAT(shown.output, HasSubstr("bulk density"));
  EXPECT_THAT(runHaptolith("soil show sirveyor-3").errors, HasSubstr("surveyor-3"));
  const std::string list = runHaptolith("soil list").output;
  EXPECT_THAT(list, HasSubstr("..."));
}

}  // namespace
}  // namespace haptolith

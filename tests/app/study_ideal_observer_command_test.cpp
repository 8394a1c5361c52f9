#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "program.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kQuick =
    "study ideal-observer --block friction --friction-model icra2021 --motion stir --repeats 2 --rounds 1";

class StudyIdealObserverCommand : public testing::Test {
 protected:
  StudyIdealObserverCommand() { fs::create_directories(folder_); }
  ~StudyIdealObserverCommand() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::temp_directory_path() / ("haptolith_explore_" + std::to_string(getpid()));
};

TEST_F(StudyIdealObserverCommand, TellsWhatAHandFeelsOfEachStimulus) {
  const fs::path csv = folder_ / "all.csv";
  const fs::path forces = folder_ / "forces.svg";
  const fs::path weber = folder_ / "weber.svg";
  const ProgramResult result = runHaptolith(kQuick + " --json --csv " + csv.string() + " --figure " + forces.string() +
                                            " --weber-figure " + weber.string());
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json block = json::parse(result.output).at("blocks").at(0);
  EXPECT_EQ(block.at("reference"), "P3");
  ASSERT_EQ(block.at("stimuli").size(), 6U);
  EXPECT_EQ(block.at("stimuli").at(5).at("name"), "P1");
  const json& mean_force = block.at("cues").at(0);
  EXPECT_EQ(mean_force.at("cue"), "mean force");
  EXPECT_TRUE(mean_force.at("rises"));
  EXPECT_GT(mean_force.at("jnds_from_reference").at(5), 0.5);
  EXPECT_EQ(mean_force.at("jnds_between_neighbours").size(), 5U);
  std::ifstream file(csv);
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(file), {}, '\n'), 1 + 6 * 2);
  EXPECT_GT(fs::file_size(forces), 1000U);
  EXPECT_GT(fs::file_size(weber), 1000U);
}

TEST_F(StudyIdealObserverCommand, TellsWhatForceAndWhatThePictureTellOfATask) {
  std::ofstream(folder_ / "scene.toml") << "[soil]\nname = 'dry-sand'\n[bed]\nstart = 'packed'\ndepth_mm = 30\n"
                                           "[tool]\nshape = 'sphere'\ndiameter_mm = 30\n"
                                           "[hand]\nmotion = 'press'\nperiod_s = 1\nsurface_mm = 30\n";
  std::ofstream(folder_ / "p.toml") << "title = 'T'\nscene = 'scene.toml'\n[[block]]\nname = 'a'\nquestion = 'q'\n"
                                       "answers = ['1', '2']\nvaries = 'soil_depth_mm'\nreference = 30\n"
                                       "levels = [20, 60]\n";
  const std::string command =
      "study ideal-observer --repeats 4 --rounds 1 --resamplings 20 --protocol " + (folder_ / "p.toml").string();
  const ProgramResult result = runHaptolith(command + " --json");
  ASSERT_EQ(result.exit_status, 0) << result.errors;
  const json task = json::parse(result.output).at("tasks").at(0);
  EXPECT_EQ(task.at("reference"), "30");
  EXPECT_EQ(task.at("exploration_s"), 1);
  const json& level = task.at("levels").at(1);
  EXPECT_EQ(level.at("level"), "60");
  EXPECT_DOUBLE_EQ(level.at("picture").at("d_prime_per_s"), level.at("picture").at("d_prime"));
  EXPECT_GT(level.at("picture").at("d_prime"), 1);
  EXPECT_LE(level.at("force").at("d_prime_per_s_low"), level.at("force").at("d_prime_per_s_high"));
  const ProgramResult text = runHaptolith(command);
  EXPECT_THAT(text.output, testing::HasSubstr("force d'"));
  EXPECT_THAT(text.output, testing::HasSubstr("seen height (mm)"));
  EXPECT_EQ(runHaptolith(command + " --motion stir").exit_status, 2);
  EXPECT_EQ(runHaptolith("study ideal-observer --repeats 3 --protocol " + (folder_ / "p.toml").string()).exit_status,
            2);
  const ProgramResult none = runHaptolith("study ideal-observer --protocol buried-ston");
  EXPECT_EQ(none.exit_status, 2);
  EXPECT_THAT(none.errors, testing::HasSubstr("buried-stone"));
}

TEST_F(StudyIdealObserverCommand, IsTheSameForAnyNumberOfThreads) {
  EXPECT_EQ(runHaptolith(kQuick + " --json --threads 1").output, runHaptolith(kQuick + " --json --threads 3").output);
}

TEST_F(StudyIdealObserverCommand, NonsenseIsRefused) {
  EXPECT_EQ(runHaptolith("study ideal-observer --block weight").exit_status, 2);
  EXPECT_EQ(runHaptolith("study ideal-observer --repeats 1").exit_status, 2);
  EXPECT_EQ(runHaptolith("study ideal-observer --motion carry").exit_status, 2);
  EXPECT_EQ(runHaptolith(kQuick + " --csv /no/such/folder/file.csv").exit_status, 1);
}

TEST_F(StudyIdealObserverCommand, FormerNameStillWorks) {
  const ProgramResult result = runHaptolith("study explore --repeats 1");
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.errors, testing::HasSubstr("study explore is now study ideal-observer"));
}

}  // namespace
}  // namespace haptolith

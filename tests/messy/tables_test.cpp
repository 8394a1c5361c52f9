// Tables as spreadsheets, R, pandas, numpy and people write them: tests/data/messy/tables.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>

#include "haptolith/device/hand/pose_file.h"
#include "haptolith/identify/measured_movement.h"
#include "haptolith/psychometrics/answers_file.h"
#include "haptolith/scene_file/given_grains.h"
#include "haptolith/teleop/link/link_parameters.h"

#include "../shared/messy_inputs.h"
#include "../source_dir.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;

std::string textOf(const Pose& pose) {
  const Vec3& p = pose.position_m;
  const Quat& q = pose.orientation;
  return fmt::format("{} {} {} {} {} {} {}", p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
}

Reading posesIn(const fs::path& path) {
  const PoseFile poses = PoseFile::read(path);
  std::string text = fmt::format("{} poses, {} s\n", poses.size(), poses.duration());
  for (double time_s = 0; time_s <= poses.duration(); time_s += 0.25) {
    text += textOf(poses.at(time_s)) + "\n";
  }
  return {text};
}

Reading delaysIn(const fs::path& path) {
  std::string text;
  for (const DelayAt& delay : readDelays(path)) {
    text += fmt::format("{} {}\n", delay.time_s, delay.delay_s);
  }
  return {text};
}

/// With times from the first one on.
Reading measuredIn(const fs::path& path) {
  const std::vector<MeasuredSample> samples = readMeasured(path);
  std::string text;
  for (const MeasuredSample& sample : samples) {
    text += fmt::format("{} {} {} {} {}\n", sample.time_s - samples[0].time_s, textOf(sample.pose), sample.force_n.x(),
                        sample.force_n.y(), sample.force_n.z());
  }
  return {text};
}

Reading grainsIn(const fs::path& path) {
  return {grainsData(readGrains(path, 0.007))};
}

Reading answersIn(const fs::path& path) {
  const Answers answers = readAnswersFile(path);
  Reading reading;
  for (const AnswersOf& of : answers.people) {
    reading.text += fmt::format("{}, {}, {}\n", of.block, of.participant, of.group);
    for (const Level& level : of.levels) {
      reading.text += fmt::format("{} {} {}\n", level.x, level.k, level.n);
    }
  }
  for (const std::string& warning : answers.warnings) {
    reading.warnings += warning + "\n";
  }
  return reading;
}

TEST(MessyTables, AreReadOrRefusedAsExpected) {
  expectAsWritten(sourceDir() / "tests/data/messy/tables",
                  {{"poses", posesIn},
                   {"delays", delaysIn},
                   {"measured", measuredIn},
                   {"grains", grainsIn},
                   {"answers", answersIn}},
                  50);
}

}  // namespace
}  // namespace haptolith

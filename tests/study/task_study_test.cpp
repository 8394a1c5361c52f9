// Simulated people go through the tasks that ship, in a program that is killed again and again.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "haptolith/study/results/answers.h"
#include "haptolith/study/run/simulated_participant.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;

class TaskStudy : public testing::TestWithParam<const char*> {
 protected:
  TaskStudy() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_tasks_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~TaskStudy() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path newStudy(const char* name) const {
    const ProtocolText text = findProtocol(GetParam());
    StudyStore::create(folder_ / name, loadProtocolText(text.text, text.name), text.text, 11);
    return folder_ / name;
  }

  /// Begins or resumes, and takes part until the end.
  static void takePart(const fs::path& file) {
    StudyStore store(file, StudyStore::Access::kRun);
    RigWithoutBed rig;
    SimulatedParticipant participant({}, 3);
    Conductor conductor(store, rig, {.now_s = [&participant] { return participant.now(); }});
    if (store.participants().empty()) {
      conductor.begin("sim001");
    } else {
      conductor.resumeParticipant("");
    }
    participant.takePart(conductor);
  }

  static bool isFinished(const fs::path& file) {
    const std::vector<ParticipantRow> people = StudyStore(file, StudyStore::Access::kRead).participants();
    return !people.empty() && people.front().state == "finished";
  }

  /// Block and level of each answered trial, in their order.
  static std::vector<std::pair<std::string, std::string>> answered(const fs::path& file) {
    std::vector<std::pair<std::string, std::string>> trials;
    for (const TrialRow& row : StudyStore(file, StudyStore::Access::kRead).trials()) {
      if (row.state == TrialState::kAnswered) {
        trials.emplace_back(row.block_name, row.level);
      }
    }
    return trials;
  }

  fs::path folder_;
};

TEST_P(TaskStudy, LosesNoAnswerAndDoublesNoneWhenTheProgramIsKilled) {
  const fs::path whole = newStudy("whole.study");
  takePart(whole);
  const auto planned = answered(whole);
  EXPECT_EQ(planned.size(), 3U * (6 * 6 + 4));

  const fs::path killed = newStudy("killed.study");
  std::mt19937_64 random(5);
  int kills = 0;
  constexpr int kMostKills = 1000;
  while (!isFinished(killed) && kills < kMostKills) {
    const pid_t child = fork();
    if (child == 0) {
      try {
        takePart(killed);
      } catch (const std::exception& error) {
        (void)std::fputs(error.what(), stderr);
        _exit(1);
      }
      _exit(0);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + random() % 60));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) != 0);
    kills += WIFSIGNALED(status) ? 1 : 0;
  }
  EXPECT_EQ(answered(killed), planned) << "after " << kills << " kills";
  EXPECT_TRUE(isFinished(killed));
  RecordProperty("kills", kills);
}

TEST(TaskStudyFit, KnowsTheMiddleOfACurveWhoseLevelsAllLieOnOneSide) {
  StudyBlock block = loadProtocolText(findProtocol("buried-stone").text, "buried-stone").blocks.front();
  EXPECT_EQ(fitOptionsOf(block).threshold, block.reference.value);
  block.task = TaskKind::kReferenceFirst;  // a response bias shifts the centre
  EXPECT_FALSE(fitOptionsOf(block).threshold.has_value());
  const StudyBlock both_sides = loadProtocolText(findProtocol("firm-ground").text, "firm-ground").blocks.front();
  EXPECT_FALSE(fitOptionsOf(both_sides).threshold.has_value());
}

INSTANTIATE_TEST_SUITE_P(Of, TaskStudy, testing::Values("buried-stone", "firm-ground", "scoop-load", "soil-surface"),
                         [](const auto& of) {
                           std::string name = of.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace haptolith

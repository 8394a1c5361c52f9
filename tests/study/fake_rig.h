#pragma once

#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/run/rig.h"

namespace haptolith {

/// A mock rig without a bed: it records its calls, is ready immediately, and fails on demand.
class FakeRig final : public Rig {
 public:
  void prepare(const StudyBlock& /*block*/, const Stimulus& stimulus) override { prepared.push_back(stimulus.name); }
  void show(const StudyBlock& block, const Stimulus& stimulus) override {
    if (fails_to_show) {
      throw Failure("the bed cannot be made");
    }
    if (feels) {
      throw std::logic_error("another stimulus under a hand that feels");
    }
    shown.push_back(block.name + " " + stimulus.name);
  }
  [[nodiscard]] bool ready() override { return is_ready; }
  void feel() override { feels = true; }
  TrialSummary rest() override {
    if (!feels) {
      throw std::logic_error("rests twice");
    }
    feels = false;
    TrialSummary trial;
    trial.mean_force_n = static_cast<double>(shown.size());
    return trial;
  }
  bool workIsDone() override {
    if (robot_is_lost) {
      throw Failure("the robot has fallen silent");
    }
    return summary.done == 1;
  }
  std::string workText() const override { return "23 of 40 mm"; }
  TeleopSummary work() const override { return summary; }
  void pause() override { paused = true; }
  void resume() override { paused = false; }
  void startRecording(const std::filesystem::path& file) override {
    if (has_no_thread) {
      throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
    }
    recordings.push_back(file.filename().string());
  }
  void stopRecording() override {
    if (fails_to_record) {
      throw Failure("the disk is full");
    }
  }
  [[nodiscard]] double force() const override { return 1; }
  [[nodiscard]] std::uint32_t buttons() const override { return down; }
  [[nodiscard]] bool pageMayHold() const override { return true; }
  [[nodiscard]] std::string deviceName() const override { return "nothing"; }

  std::vector<std::string> prepared, shown, recordings;
  bool is_ready = true, feels = false, paused = false, fails_to_show = false, fails_to_record = false;
  bool has_no_thread = false, robot_is_lost = false;
  TeleopSummary summary;
  std::uint32_t down = 0;
};

}  // namespace haptolith

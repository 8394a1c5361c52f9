#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "haptolith/identify/model_learner.h"
#include "haptolith/study/run/rig.h"
#include "haptolith/teleop/bench/simulation.h"
#include "haptolith/teleop/link/link_profiles.h"
#include "haptolith/teleop/operator/force_agreement.h"

namespace haptolith {

// What a study says of work for a robot, in the words of teleoperation, and the other way round.

/// Half of the delay each way, and nothing else that a link does.
[[nodiscard]] LinkProfile linkOf(const TeleopWork& work);

/// What of a trial's work is told by forces. @param learned  none: the model does not learn.
[[nodiscard]] TeleopSummary summaryOf(const ForceAgreement& agreement, const std::optional<ModelSoil>& learned);

/// The scene whose soil the hand feels in such a block. @throws InvalidParameter, Failure as sceneOf().
[[nodiscard]] SceneFile modelOf(const StudyProtocol& protocol, const StudyBlock& block);

/// Another rig, but for work for a robot: a virtual operator does that in simulated time, in a run of its own for each
/// trial, while feel() waits.
class SimulatedTeleopRig final : public Rig {
 public:
  /// @param seed  of the first trial's soils and link; each one after that has the next.
  /// @param progress  of a trial's work.
  SimulatedTeleopRig(const StudyProtocol& protocol, std::unique_ptr<Rig> other, std::uint64_t seed,
                     TeleopProgress progress)
      : protocol_(protocol), other_(std::move(other)), next_seed_(seed), progress_(std::move(progress)) {}

  void prepare(const StudyBlock& block, const Stimulus& stimulus) override;
  void show(const StudyBlock& block, const Stimulus& stimulus) override;
  [[nodiscard]] bool ready() override { return work_ != nullptr || other_->ready(); }
  /// @throws InvalidParameter, Failure as simulateTeleop(); Failure also when `progress` gives up.
  void feel() override;
  TrialSummary rest() override;
  [[nodiscard]] bool workIsDone() override { return summary_.done == 1; }
  [[nodiscard]] TeleopSummary work() const override { return summary_; }
  void pause() override { other_->pause(); }
  void resume() override { other_->resume(); }
  void startRecording(const std::filesystem::path& file) override { other_->startRecording(file); }
  void stopRecording() override { other_->stopRecording(); }
  [[nodiscard]] double force() const override { return other_->force(); }
  [[nodiscard]] std::uint32_t buttons() const override { return other_->buttons(); }
  [[nodiscard]] bool pageMayHold() const override { return other_->pageMayHold(); }
  [[nodiscard]] std::string deviceName() const override { return other_->deviceName(); }

 private:
  StudyProtocol protocol_;
  std::unique_ptr<Rig> other_;
  std::uint64_t next_seed_;
  TeleopProgress progress_;
  const StudyBlock* work_ = nullptr;  ///< the block that is shown, where it is work for a robot
  TeleopSummary summary_;
  TrialSummary trial_summary_;
};

}  // namespace haptolith

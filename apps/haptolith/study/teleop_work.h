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

// Conversions between a study's teleoperation blocks and the teleoperation library.

/// Returns a link with half of the delay each way, without other effects.
[[nodiscard]] LinkProfile linkOf(const TeleopWork& work);

/// Returns the summary of a trial's forces. @param learned  empty: the model does not learn.
[[nodiscard]] TeleopSummary summaryOf(const ForceAgreement& agreement, const std::optional<ModelSoil>& learned);

/// Returns the scene of the operator's model in such a block. @throws InvalidParameter, Failure as sceneOf().
[[nodiscard]] SceneFile modelOf(const StudyProtocol& protocol, const StudyBlock& block);

/// Wrapper of another rig with simulated teleoperation: a virtual operator works in simulated time, in a separate run
/// per trial, while feel() waits.
class SimulatedTeleopRig final : public Rig {
 public:
  /// @param seed  seed of the first trial's soils and link; incremented for each further trial.
  /// @param progress  progress of a trial's work.
  SimulatedTeleopRig(const StudyProtocol& protocol, std::unique_ptr<Rig> other, std::uint64_t seed,
                     TeleopProgress progress)
      : protocol_(protocol), other_(std::move(other)), next_seed_(seed), progress_(std::move(progress)) {}

  void prepare(const StudyBlock& block, const Stimulus& stimulus) override;
  void show(const StudyBlock& block, const Stimulus& stimulus) override;
  [[nodiscard]] bool ready() override { return work_ != nullptr || other_->ready(); }
  /// @throws InvalidParameter, Failure as simulateTeleop(); Failure also if `progress` cancels.
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
  const StudyBlock* work_ = nullptr;  ///< current block if it is teleoperation, otherwise null
  TeleopSummary summary_;
  TrialSummary trial_summary_;
};

}  // namespace haptolith

#pragma once

#include <vector>

#include "haptolith/study/perception/exploration.h"
#include "haptolith/study/run/rig.h"

namespace haptolith {

/// Rig without a person, a device or a clock: a virtual hand explores each stimulus by a script. Its movements and
/// forces are the only information about the stimulus. There are no recordings.
class SimulatedRig final : public Rig {
 public:
  /// @param options  options of every exploration; the seed increases by 1 for each.
  /// @throws InvalidParameter as exploringHand() and requireReach().
  SimulatedRig(const StudyProtocol& protocol, const ExplorationOptions& options);

  /// Settles the stimulus' bed at its first use.
  void show(const StudyBlock& block, const Stimulus& stimulus) override;
  [[nodiscard]] bool ready() override { return true; }
  void feel() override;
  /// Explores the soil; blocks until that is done. @throws Failure as explore().
  TrialSummary rest() override;
  void pause() override {}
  void resume() override {}
  void startRecording(const std::filesystem::path& /*file*/) override {}
  void stopRecording() override {}
  [[nodiscard]] double force() const override { return 0; }
  [[nodiscard]] std::uint32_t buttons() const override { return 0; }
  [[nodiscard]] bool pageMayHold() const override { return false; }
  [[nodiscard]] std::string deviceName() const override { return "exploring hand"; }

 private:
  /// Settled bed and its scene.
  struct Shown {
    SceneFile scene;
    LevelBed bed;
  };

  StudyProtocol protocol_;
  ExplorationOptions next_;
  std::vector<Shown> shown_;  ///< stimuli used so far
  std::size_t now_ = 0;       ///< index in shown_
  bool feels_ = false;
};

}  // namespace haptolith

#pragma once

#include <vector>

#include "haptolith/study/perception/exploration.h"
#include "haptolith/study/run/rig.h"

namespace haptolith {

/// A study without a person, a device or a clock: a virtual hand explores each stimulus by a script, and what it really
/// felt is all that anybody learns. Nothing is recorded.
class SimulatedRig final : public Rig {
 public:
  /// @param options  of every exploration; the first has its seed, and each one after that the next seed.
  /// @throws InvalidParameter as exploringHand() and requireReach().
  SimulatedRig(const StudyProtocol& protocol, const ExplorationOptions& options);

  /// Settles the stimulus' bed when it is shown for the first time.
  void show(const StudyBlock& block, const Stimulus& stimulus) override;
  [[nodiscard]] bool ready() override { return true; }
  void feel() override;
  /// Explores, for as long as that takes. @throws Failure as explore().
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
  /// A bed that has been settled, and the scene that it lies in.
  struct Shown {
    SceneFile scene;
    LevelBed bed;
  };

  StudyProtocol protocol_;
  ExplorationOptions next_;
  std::vector<Shown> shown_;  ///< so far
  std::size_t now_ = 0;       ///< of shown_
  bool feels_ = false;
};

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Interface of a study to the rendered soil. All calls from one thread; none of them blocks.
class Rig {
 public:
  virtual ~Rig() = default;

  /// Prepares a stimulus, so that show() takes equally long for all; ready() reports completion. No force is rendered
  /// meanwhile. @throws InvalidParameter, Failure as show().
  virtual void prepare(const StudyBlock& /*block*/, const Stimulus& /*stimulus*/) {}

  /// Changes to another stimulus. The force fades out, the soil of `stimulus` under `block`'s conditions is reset to
  /// its level state, and the tool stays out of it until feel(). @throws InvalidParameter, Failure if the soil is not
  /// possible.
  virtual void show(const StudyBlock& block, const Stimulus& stimulus) = 0;
  /// Whether the last stimulus of show() is ready. @throws Failure if it could not be made.
  [[nodiscard]] virtual bool ready() = 0;

  /// Fades the tool into the soil, and starts the summary of movements and forces.
  virtual void feel() = 0;
  /// Fades the tool out of the soil. @return summary since feel().
  virtual TrialSummary rest() = 0;

  // Teleoperation blocks, from feel() to rest():

  /// Whether the task is observed to be complete at the robot's site. @throws Failure if the robot is lost.
  [[nodiscard]] virtual bool workIsDone() { return false; }
  /// Returns the observed progress: "23 of 40 mm"; empty if unknown.
  [[nodiscard]] virtual std::string workText() const { return ""; }
  /// Returns the summary of the task so far.
  [[nodiscard]] virtual TeleopSummary work() const { return {}; }

  /// Pauses time and sets the force to zero, until resume().
  virtual void pause() = 0;
  virtual void resume() = 0;

  /// Starts recording into this file, until stopRecording(). @throws Failure if it cannot be written.
  virtual void startRecording(const std::filesystem::path& file) = 0;
  /// @throws Failure if the recording is incomplete.
  virtual void stopRecording() = 0;

  /// Returns the magnitude of the current force on the hand, in N.
  [[nodiscard]] virtual double force() const = 0;
  /// Returns the device's buttons. Bit n: button n is down; a squeezed gripper counts as button 0.
  [[nodiscard]] virtual std::uint32_t buttons() const = 0;
  /// Whether the virtual hand holds the tool, so that the participant's page may take control of it.
  [[nodiscard]] virtual bool pageMayHold() const = 0;
  [[nodiscard]] virtual std::string deviceName() const = 0;
};

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// What a study does with the thing that participants feel. All calls from one thread; none of them waits.
class Rig {
 public:
  virtual ~Rig() = default;

  /// Gets ready for a stimulus, so that show() takes as long for it as for any other; ready() tells when that is done.
  /// Nothing is felt meanwhile. @throws InvalidParameter, Failure as show().
  virtual void prepare(const StudyBlock& /*block*/, const Stimulus& /*stimulus*/) {}

  /// Another stimulus: the force fades away, the soil of `stimulus` under `block`'s conditions lies fresh and level,
  /// and the tool stays out of it until feel(). @throws InvalidParameter, Failure when there can be no such soil.
  virtual void show(const StudyBlock& block, const Stimulus& stimulus) = 0;
  /// Whether what show() was told last is there. @throws Failure when it could not be made.
  [[nodiscard]] virtual bool ready() = 0;

  /// The tool fades into the soil, and what the hand does and feels is summed up from now on.
  virtual void feel() = 0;
  /// The tool fades out of the soil again. What the hand did and felt since feel().
  virtual TrialSummary rest() = 0;

  // Of a block with work for a robot, from feel() to rest():

  /// Whether the work is seen to be done at the robot's site. @throws Failure when the robot is lost.
  [[nodiscard]] virtual bool workIsDone() { return false; }
  /// How much of it is seen to be: "23 of 40 mm"; empty: nothing is known.
  [[nodiscard]] virtual std::string workText() const { return ""; }
  /// How it went so far.
  [[nodiscard]] virtual TeleopSummary work() const { return {}; }

  /// Time stands still and the hand is let go, until resume().
  virtual void pause() = 0;
  virtual void resume() = 0;

  /// Records into this file from now on, until stopRecording(). @throws Failure when it cannot be written.
  virtual void startRecording(const std::filesystem::path& file) = 0;
  /// @throws Failure when not all of it could be written.
  virtual void stopRecording() = 0;

  /// Force on the hand now, in N.
  [[nodiscard]] virtual double force() const = 0;
  /// Bit n: button n of the device is down; a gripper that is squeezed counts as button 0.
  [[nodiscard]] virtual std::uint32_t buttons() const = 0;
  /// Whether the virtual hand has the tool, so that the participant's page may take it.
  [[nodiscard]] virtual bool pageMayHold() const = 0;
  [[nodiscard]] virtual std::string deviceName() const = 0;
};

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "haptolith/recording/recording_format.h"

namespace haptolith {

struct RecordingOptions {
  bool overwrite = false;  ///< an existing file; it stays as it is until the new one has been made
  /// Action of add() when the disk is so slow that 64 MiB wait to be written: wait, as suits a loop that is not in real
  /// time, or end the recording. Particles are left out before, when 32 MiB wait.
  bool wait_when_full = false;
  bool robot = false;  ///< a robot follows the tool: the file has tables for its reports
};

/// Writes a recording. A separate thread does all work on the file, so that a slow disk delays no caller; faults of
/// the disk never throw into the owner. Added data is in the file within half a second, and a
/// program that is killed leaves a file that RecordingReader opens. Functions are for one owner, and not for the tick.
class RecordingWriter {
 public:
  /// Checks for an existing file as the constructor does, before long work begins. @throws Failure.
  static void requireFree(const std::filesystem::path& path, bool overwrite);

  /// Makes the file.
  /// @throws InvalidParameter when the header cannot be written as it is; Failure when the file exists or cannot be
  /// made.
  RecordingWriter(const std::filesystem::path& path, const RecordingHeader& header,
                  const RecordingOptions& options = {});
  /// As finish().
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Copies what is to be written. Does nothing after a problem().
  void add(std::span<const TickRecord> ticks);
  void add(const ParticleFrame& frame);
  void add(const RecordingEvent& event);
  /// Only with RecordingOptions::robot.
  void add(const RobotRow& report);
  void add(const SiteRow& seen);

  /// Writes the waiting data and closes the file; problem() then reports whether all is in it.
  /// @param lost  ticks that were to be recorded and are known to have been lost on the way here.
  void finish(std::uint64_t lost = 0) noexcept;

  /// Why nothing is recorded any more, and how much is in the file; empty when all is well.
  [[nodiscard]] std::string problem() const;

  /// Amount that is safe in the file.
  struct Written {
    std::uint64_t ticks = 0, frames = 0, events = 0, bytes = 0;
    std::uint64_t missing = 0;  ///< ticks that are not, and should be
  };
  [[nodiscard]] Written written() const;

  /// Frames that were left out because the disk was too slow for them.
  [[nodiscard]] std::uint64_t framesLeftOut() const;

 private:
  class Thread;
  std::unique_ptr<Thread> thread_;
};

}  // namespace haptolith

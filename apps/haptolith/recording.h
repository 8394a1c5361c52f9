#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "haptolith/haptics/haptic_loop.h"

#include "trace_file.h"

namespace haptolith {

/// What somebody who looks on has asked to be recorded: every tick, in a new file where the program was started.
/// Whatever goes wrong with it ends the recording and not the run.
class Recording {
 public:
  /// Begins; saves what was being recorded before. @throws Failure when either cannot be done.
  void start();
  /// Saves it, if there is one. @throws Failure when that cannot be done.
  void stop();
  /// Adds a tick while something is being recorded. After an hour, or when the disk takes no more, the recording ends,
  /// and a warning says so.
  void write(const TickRecord& record);

  /// Its file's name; empty when nothing is being recorded.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  std::unique_ptr<TraceFile> file_;
  std::string name_;
  std::uint64_t ticks_ = 0;
};

}  // namespace haptolith

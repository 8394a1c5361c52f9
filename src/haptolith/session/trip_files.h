#pragma once

#include <cstdint>
#include <string>

#include "haptolith/session/session.h"
#include "haptolith/session/session_recording.h"

namespace haptolith {

/// What there is to tell when the safety layer lets go of the hand, and files of the ticks before; not without end,
/// when it does so again and again.
class TripFiles {
 public:
  /// When the safety layer has let go of the hand since the last call: why, noted in the recording as well, and the
  /// last ticks before it in a new CSV file where the program was started. After 20 times no more files are written,
  /// and it tells once a second how often that was.
  /// @return what there is to tell; empty: nothing.
  std::string update(Session& session, SessionRecording& recording);

  /// What it has not told; empty: nothing.
  [[nodiscard]] std::string rest() const;

 private:
  std::uint64_t files_ = 0, untold_ = 0;
  double told_s_ = 0;
};

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <string>

#include "haptolith/session/session.h"

#include "output.h"
#include "recording.h"

namespace haptolith {

/// Tells when the safety layer lets go of the hand; not without end, when it does so again and again.
class TripTeller {
 public:
  /// When the safety layer has let go of the hand since the last call: says why, notes it in the recording, and writes
  /// the last ticks before it to a new CSV file where the program was started. After 20 times no more files are
  /// written, and it tells once a second how often that was.
  /// @return what it has told; empty: there was nothing to tell.
  std::string tell(Session& session, StatusLine& status, Recording& recording);

  /// Warns of what it has not told, if there is anything.
  void tellOfTheRest() const;

 private:
  std::uint64_t files_ = 0, untold_ = 0;
  double told_s_ = 0;
};

}  // namespace haptolith

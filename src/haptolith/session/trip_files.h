#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "haptolith/haptics/safety/trip_report.h"

namespace haptolith {

/// What there is to tell when the safety layer lets go of the hand, and files of the ticks before; not without end,
/// when it does so again and again.
class TripFiles {
 public:
  /// Writes the last ticks to a new CSV file in the user's folder for such things, $XDG_STATE_HOME/haptolith or
  /// ~/.local/state/haptolith. After 20 times no more files are written,
  /// and it tells once a second how often that was.
  /// @param problem  what the device says of it; may be empty.
  /// @return what there is to tell; empty: nothing.
  std::string tell(const TripReport& report, std::string_view problem);

  /// What it has not told; empty: nothing.
  [[nodiscard]] std::string rest() const;

 private:
  std::uint64_t files_ = 0, untold_ = 0;
  double told_s_ = 0;
};

}  // namespace haptolith

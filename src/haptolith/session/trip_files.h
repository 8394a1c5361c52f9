#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "haptolith/haptics/safety/trip_report.h"

namespace haptolith {

/// Reports safety trips, and writes files of the ticks before; limited for
/// repeated trips.
class TripFiles {
 public:
  /// Writes the last ticks to a new CSV file in the user's folder for such things, $XDG_STATE_HOME/haptolith or
  /// ~/.local/state/haptolith. After 20 times no more files are written,
  /// and it reports their number once a second.
  /// @param tool  whose hand's trip it was, where a scene has several; may be empty.
  /// @param problem  report of the device; may be empty.
  /// @return the report; may be empty.
  std::string tell(const TripReport& report, std::string_view tool, std::string_view problem);

  /// The part not yet reported; may be empty.
  [[nodiscard]] std::string rest() const;

 private:
  std::uint64_t files_ = 0, untold_ = 0;
  double told_s_ = 0;
};

}  // namespace haptolith

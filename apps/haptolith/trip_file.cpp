#include "trip_file.h"

#include <fmt/format.h>

#include "haptolith/core/atomic_file.h"
#include "haptolith/recording/recording_format.h"

#include "new_file_name.h"

namespace haptolith {

std::string writeTripFile(const TripReport& report) {
  std::string name = newFileName("haptolith-trip", ".csv");
  AtomicFile file(name);
  std::string text = fmt::format("# at {:.3f} s: {}\n", report.time_s, haptolith::text(report.trip)) + csvHeader();
  for (std::size_t i = 0; i < report.count; ++i) {
    appendCsv(text, report.ticks[i]);
  }
  file.write(text);
  file.commit();
  return name;
}

}  // namespace haptolith

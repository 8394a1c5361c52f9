#include "trip_file.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string>
#include <string_view>

#include "haptolith/core/atomic_file.h"
#include "haptolith/core/error.h"
#include "haptolith/recording/recording_format.h"

#include "new_file_name.h"

namespace haptolith {

namespace {

/// @return the file's name. @throws Failure when it cannot be written.
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

}  // namespace

std::string tellOfTrips(Session& session, StatusLine& status, Recording& recording) {
  if (!session.loop().trips().update()) {
    return {};
  }
  const TripReport& report = session.loop().trips().latest();
  status.clear();
  recording.note("trip", report.time_s, text(report.trip));
  std::string where;
  try {
    where = fmt::format("; the last {} ticks are in {}", report.count, writeTripFile(report));
  } catch (const Failure& failure) {
    where = fmt::format("; the last ticks could not be written: {}", failure.what());
  }
  const std::string_view reason = session.device().problem();
  std::string told = fmt::format("at {:.3f} s the hand was let go: {}{}{}{}", report.time_s, text(report.trip),
                                 reason.empty() ? "" : ": ", reason, where);
  spdlog::warn("{}", told);
  return told;
}

}  // namespace haptolith

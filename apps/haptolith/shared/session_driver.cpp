#include "shared/session_driver.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <thread>

namespace haptolith {

SessionRecording recordingFor(double frames_per_s, bool robot) {
  return SessionRecording({.frames_per_s = frames_per_s,
                           .program_version = HAPTOLITH_VERSION,
                           .robot = robot,
                           .warn = [](const std::string& text) { spdlog::warn("{}", text); }});
}

void SessionDriver::run(const std::function<bool(const News&)>& follow, std::chrono::milliseconds between) {
  while (!session_.done()) {
    if (view_ != nullptr) {
      view_->handleMessages();
    }
    if (!follow(look())) {
      return;
    }
    if (view_ != nullptr) {
      view_->show(news_.snapshot, news_.scene);
    }
    std::this_thread::sleep_for(between);
  }
}

const SessionDriver::News& SessionDriver::look() {
  news_.scene = session_.poll();
  news_.snapshot = session_.update();
  news_.ticks.clear();
  if (records_ != nullptr) {
    records_->take(news_.ticks);
  }
  recording_.check();
  if (news_.snapshot) {
    recording_.add(session_.snapshot());
  }
  news_.trip.clear();
  LatestValue<TripReport>& trips = session_.loop().trips();
  const bool new_trip = trips.update();
  const TripReport& trip = trips.latest();
  const SceneFile& scene_file = session_.sceneFile();
  const std::string_view tool = toolCount(scene_file) > 1 ? toolNames(scene_file).at(trip.tool) : "";
  if (new_trip) {
    news_.trip = trips_.tell(trip, tool, session_.device(trip.tool).problem());
  }
  if (!news_.trip.empty()) {
    recording_.note("trip", trip.time_s, tool.empty() ? trip.reason() : fmt::format("{}: {}", tool, trip.reason()));
    status_.clear();
    spdlog::warn("{}", news_.trip);
  }
  printInputWarnings();
  return news_;
}

void SessionDriver::printInputWarnings() {
  const std::vector<std::string> warnings = session_.device().inputWarnings();
  for (; input_warnings_ < warnings.size(); ++input_warnings_) {
    status_.clear();
    spdlog::warn("{}", warnings[input_warnings_]);
  }
}

void SessionDriver::tellTheRest() {
  if (const std::string rest = trips_.rest(); !rest.empty()) {
    spdlog::warn("{}", rest);
  }
}

}  // namespace haptolith

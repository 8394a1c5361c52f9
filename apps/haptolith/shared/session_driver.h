#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "haptolith/session/record_taker.h"
#include "haptolith/session/session.h"
#include "haptolith/session/session_recording.h"
#include "haptolith/session/trip_files.h"
#include "haptolith/viewer/live_view.h"

#include "shared/output.h"

namespace haptolith {

/// Returns the recording of a command, with warnings on standard error.
[[nodiscard]] SessionRecording recordingFor(double frames_per_s, bool robot = false);

/// Main-thread driver of a session while its loop runs on another thread. It handles requests of pages, and passes news
/// to the scene, the recording and the pages; safety trips are printed on standard error.
class SessionDriver {
 public:
  /// Events since the previous update.
  struct News {
    std::vector<TickRecord> ticks;  ///< recorded ticks; empty without a RecordTaker that keeps them
    bool snapshot = false;          ///< whether Session::snapshot() is newer
    bool scene = false;             ///< whether the scene or its settings have changed
    std::string trip;               ///< cause of a safety trip; empty: none
  };

  /// @param view, records  may be null.
  SessionDriver(Session& session, SessionRecording& recording, StatusLine& status, LiveView* view, RecordTaker* records)
      : session_(session), recording_(recording), status_(status), view_(view), records_(records) {}

  /// Repeats look(), `follow` with the news, display and sleep, until the loop has ended or `follow` returns false.
  void run(const std::function<bool(const News&)>& follow, std::chrono::milliseconds between);

  /// Updates once; for the last time after the loop has ended. The result is valid until the next call.
  const News& look();

  /// Prints pending warnings.
  void tellTheRest();

 private:
  void printInputWarnings();

  Session& session_;
  SessionRecording& recording_;
  StatusLine& status_;
  LiveView* const view_;
  RecordTaker* const records_;
  TripFiles trips_;
  std::size_t input_warnings_ = 0;  ///< number of the device's warnings printed so far
  News news_;
};

}  // namespace haptolith

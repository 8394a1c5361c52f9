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

/// The recording of a command, which warns on standard error.
[[nodiscard]] SessionRecording recordingFor(double frames_per_s, bool robot = false);

/// What the main thread does again and again while a session's loop runs on its own: what pages ask for, what is new in
/// the scene, in the recording, on the pages and, when the hand was let go, on standard error.
class SessionDriver {
 public:
  /// What has happened since the look before.
  struct News {
    std::vector<TickRecord> ticks;  ///< that were recorded; none without a RecordTaker that keeps them
    bool snapshot = false;          ///< Session::snapshot() is newer
    bool scene = false;             ///< another scene, or other settings
    std::string trip;               ///< why the hand was let go; empty: it was not
  };

  /// @param view, records  may be absent.
  SessionDriver(Session& session, SessionRecording& recording, StatusLine& status, LiveView* view, RecordTaker* records)
      : session_(session), recording_(recording), status_(status), view_(view), records_(records) {}

  /// Looks, lets `follow` see what is new, shows it and sleeps, again and again: until the loop has ended, or `follow`
  /// returns false.
  void run(const std::function<bool(const News&)>& follow, std::chrono::milliseconds between);

  /// One look; the last one after the loop has ended. Valid until the next.
  const News& look();

  /// Warns of what was not told when it happened.
  void tellTheRest();

 private:
  void printInputWarnings();

  Session& session_;
  SessionRecording& recording_;
  StatusLine& status_;
  LiveView* const view_;
  RecordTaker* const records_;
  TripFiles trips_;
  std::size_t input_warnings_ = 0;  ///< of the device, printed so far
  News news_;
};

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/recording/recording_writer.h"
#include "haptolith/session/session.h"

namespace haptolith {

/// A recording of the session that runs: of all of it (`run --record`), or of a part that a viewer has
/// asked for, in a new file where the program was started. Whatever goes wrong with it ends the recording and not the
/// run. From the thread that follows the loop, except add(ticks).
class SessionRecording {
 public:
  struct Options {
    double frames_per_s = 0;      ///< pictures of all particles; 0: none
    std::string program_version;  ///< for the file
    bool robot = false;           ///< a robot follows the tool: its reports are also recorded
    std::function<void(const std::string&)> warn = [](const std::string&) {};
  };

  explicit SessionRecording(Options options) : options_(std::move(options)) {}

  /// Begins a file with a new name; finishes the part that was being recorded before. @throws Failure as
  /// RecordingWriter, and when the whole run is being recorded.
  void start(const Session& session);
  /// Finishes a part. @throws Failure as stop(), also when ticks are missing, and when the whole run is being recorded.
  void stopPart();
  /// Begins this file; before the first tick. @throws Failure as RecordingWriter.
  void start(const Session& session, const std::string& file, bool overwrite);
  /// Finishes it, if there is one. A warning and problem() report missing ticks. @throws Failure when not
  /// all of what it was given could be written.
  void stop();

  /// Ends the recording when the disk is full, or after an hour unless more was requested; with a
  /// warning. To be called often.
  void check();

  /// Adds what is new while something is being recorded; ticks from any one thread.
  void add(const std::vector<TickRecord>& ticks);
  void add(const SceneSnapshot& snapshot);
  void add(const RobotRow& report);
  void add(const SiteRow& seen);
  void note(const std::string& kind, double time_s, const std::string& text);

  /// Time of its first tick, in s; none: it has none yet.
  [[nodiscard]] std::optional<double> begun();

  /// Its file's name; empty when nothing is being recorded.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// Fault of the last recording; empty without one.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

 private:
  void begin(const Session& session, const std::string& file, bool overwrite);
  void requireNoWholeRun() const;
  [[nodiscard]] std::unique_ptr<RecordingWriter> takeWriter();

  const Options options_;
  std::string name_, problem_;
  bool endless_ = false;
  const HapticLoop* loop_ = nullptr;
  std::uint64_t lost_before_ = 0;  ///< HapticLoop::lostRecords() when it began
  double next_frame_s_ = 0;

  std::mutex mutex_;  ///< for what follows, which add(ticks) touches
  std::unique_ptr<RecordingWriter> writer_;
  std::uint64_t ticks_ = 0;
  std::optional<double> begun_s_;
};

}  // namespace haptolith

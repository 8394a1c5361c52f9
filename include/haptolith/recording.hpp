// libhaptolith_recording for C++17: recordings of a hapto::Loop, written, read and run again. Header only, over recording.h, where
// every function is explained.
//
//     hapto::Loop loop(scene, hand, hapto::Loop::Ticked::kByCaller, hapto::Loop::Ticks::kKept);
//     hapto::Recorder recorder(loop, "run.h5");
#ifndef HAPTOLITH_RECORDING_HPP
#define HAPTOLITH_RECORDING_HPP

#include <haptolith/haptolith.hpp>
#include <haptolith/recording.h>

#include <cstdint>
#include <string>
#include <vector>

namespace hapto {

/// Writes what a loop does. Call take() every second or more often, and finish() to hear whether all is in the file.
class Recorder {
 public:
  Recorder(Loop &loop, const std::string &path, double frames_per_s = 10, bool overwrite = false) {
    hapto_recorder *made = nullptr;
    require(hapto_recorder_create(loop.get(), path.c_str(), frames_per_s, overwrite ? HAPTO_RECORDER_OVERWRITE : 0, &made));
    handle_.reset(made);
  }

  void take() { require(hapto_recorder_take(handle_.get())); }
  void note(const std::string &kind, const std::string &text) {
    require(hapto_recorder_note(handle_.get(), kind.c_str(), text.c_str()));
  }
  void finish() { require(hapto_recorder_finish(handle_.get())); }
  hapto_recorder_info info() const {
    auto info = sized<hapto_recorder_info>();
    require(hapto_recorder_get_info(handle_.get(), &info));
    return info;
  }

 private:
  detail::Unique<hapto_recorder, hapto_recorder_destroy> handle_;
};

/// A recording that is there.
class Recording {
 public:
  explicit Recording(const std::string &path) {
    hapto_recording *made = nullptr;
    require(hapto_recording_open(path.c_str(), &made));
    handle_.reset(made);
  }

  hapto_recording_info info() const {
    auto info = sized<hapto_recording_info>();
    require(hapto_recording_get_info(handle_.get(), &info));
    return info;
  }
  /// JSON.
  std::string header() const { return detail::textFrom(hapto_recording_get_header, handle_.get()); }
  std::string events() const { return detail::textFrom(hapto_recording_get_events, handle_.get()); }
  std::vector<hapto_tick> ticks(std::uint64_t first, std::uint64_t count) const {
    std::vector<hapto_tick> ticks(count);
    require(hapto_recording_read_ticks(handle_.get(), first, ticks.data(), count, &count));
    ticks.resize(count);
    return ticks;
  }
  /// Describes a frame; its particles, x y z one after the other, replace the contents of `positions`.
  hapto_recorded_frame frame(std::uint64_t index, std::vector<float> &positions) const {
    auto frame = sized<hapto_recorded_frame>();
    require(hapto_recording_read_frame(handle_.get(), index, &frame, nullptr, 0));
    positions.resize(3 * frame.particles);
    require(hapto_recording_read_frame(handle_.get(), index, &frame, positions.data(), positions.size()));
    return frame;
  }
  /// Texts in it are valid until the next.
  hapto_replay_report verify(std::uint32_t threads = 0, const Progress &progress = {}) {
    detail::ProgressCall told(progress);
    auto report = sized<hapto_replay_report>();
    told.require(hapto_recording_verify(handle_.get(), threads, told.function(), &told, &report));
    return report;
  }

 private:
  detail::Unique<hapto_recording, hapto_recording_destroy> handle_;
};

}  // namespace hapto

#endif

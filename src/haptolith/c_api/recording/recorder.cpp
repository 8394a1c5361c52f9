// Recordings that are written.

#include <haptolith/recording.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/c_api/handles.h"
#include "haptolith/c_api/ticks.h"
#include "haptolith/c_api/values.h"
#include "haptolith/c_api/with_handle.h"
#include "haptolith/core/error.h"
#include "haptolith/recording/recording_writer.h"

namespace haptolith::library {

namespace {

struct LoopHeader {
  RecordingHeader header;
  bool real_time = true;
};

LoopHeader headerOf(const hapto_loop* loop) {
  std::uint64_t needed = 0;
  const std::int32_t status = hapto_loop_get_header(loop, nullptr, 0, &needed);
  if (status != HAPTO_TOO_SMALL) {
    throw Told{status};
  }
  std::string text(needed, '\0');
  requireOk(hapto_loop_get_header(loop, text.data(), text.size(), &needed));
  text.pop_back();  // the zero
  const auto json = nlohmann::json::parse(text);
  LoopHeader made;
  RecordingHeader& header = made.header;
  json.at("scenario").get_to(header.scene_file);
  json.at("title").get_to(header.title);
  json.at("instruction_set").get_to(header.instruction_set);
  json.at("arithmetic").get_to(header.arithmetic);
  json.at("device").get_to(header.device);
  json.at("device_limits").get_to(header.device_limits);
  header.tools = json.value("tools", std::string());  // not from libraries of version 0.2
  json.at("seed").get_to(header.seed);
  json.at("threads").get_to(header.threads);
  json.at("hashed_parts").get_to(header.hashed_parts);
  json.at("start_tick").get_to(header.start_tick);
  json.at("tick_s").get_to(header.tick_s);
  json.at("paced").get_to(made.real_time);
  header.program_version = hapto_version_string();
  stampNow(header);
  return made;
}

ParticleFrame frameOf(const hapto_snapshot& now) {
  ParticleFrame frame{.time_s = now.time_s, .tick = now.ticks, .position_m = {}};
  frame.position_m.resize(now.position.count);
  for (std::uint64_t i = 0; i < now.position.count; ++i) {
    std::memcpy(&frame.position_m[i], static_cast<const char*>(now.position.data) + i * now.position.stride_bytes,
                sizeof frame.position_m[i]);
  }
  return frame;
}

}  // namespace

template <>
inline constexpr std::size_t kFirstSize<hapto_recorder_info> = offsetof(hapto_recorder_info, frames_left_out) +
                                                               sizeof(hapto_recorder_info::frames_left_out);

/// Hands a loop's ticks and pictures to a file.
class Recorder {
 public:
  Recorder(const hapto_loop* loop, const char* path, double frames_per_s, bool overwrite)
      : Recorder(loop, path, frames_per_s, overwrite, headerOf(loop)) {}

  void take() {
    requireWriter();
    takeTicks();
    hapto_snapshot now{};
    now.size = sizeof now;
    requireOk(hapto_loop_snapshot(const_cast<hapto_loop*>(loop_), &now));
    if (frame_every_s_ > 0 && now.ticks > pictured_ && now.time_s >= next_frame_s_) {
      pictured_ = now.ticks;
      writer_.add(frameOf(now));
      next_frame_s_ = std::max(next_frame_s_ + frame_every_s_, now.time_s);
    }
    if (now.trips > trips_) {
      trips_ = now.trips;
      add("trip", now.time_s, *now.trip != '\0' ? now.trip : "safety trip");
    }
    if (now.running == 0 && *now.end != '\0' && !ended_) {
      ended_ = true;
      takeTicks();  // the last ones, written before the loop said that it had ended
      add("end", now.time_s, now.end);
    }
    requireNoProblem();
  }

  void note(const char* kind, const char* text) {
    requireWriter();
    add(kind, last_s_, text);
    requireNoProblem();
  }

  void finish() {
    if (finished_) {
      return;
    }
    bool gone = false;
    try {
      take();
    } catch (const Told& told) {
      gone = told.status == HAPTO_DESTROYED;
      if (!gone) {  // another thread has the loop: what waits can still be taken
        throw;
      }
    } catch (const Failure&) {  // reported below
    }
    finished_ = true;
    writer_.finish(lost_ - lost_before_);
    requireNoProblem();
    if (gone && !ended_) {
      throw Failure("the loop was destroyed before its recorder was finished: the last ticks may be missing");
    }
    if (const std::uint64_t missing = writer_.written().missing; missing > 0) {
      throw Failure(std::to_string(missing) + " ticks are missing in the recording: they were not taken in time");
    }
  }

  void info(hapto_recorder_info& out) const {
    const RecordingWriter::Written written = writer_.written();
    give({.size = 0,
          .reserved = 0,
          .ticks = written.ticks,
          .frames = written.frames,
          .events = written.events,
          .bytes = written.bytes,
          .missing = written.missing,
          .frames_left_out = writer_.framesLeftOut()},
         out);
  }

 private:
  Recorder(const hapto_loop* loop, const char* path, double frames_per_s, bool overwrite, const LoopHeader& begun)
      : loop_(loop),
        lost_before_(lostSoFar(loop)),
        lost_(lost_before_),
        writer_(path, begun.header, {.overwrite = overwrite, .wait_when_full = !begun.real_time}),
        frame_every_s_(frames_per_s > 0 ? 1 / frames_per_s : 0) {}

  static std::uint64_t lostSoFar(const hapto_loop* loop) {
    hapto_tick none;
    std::uint64_t count = 0;
    std::uint64_t lost = 0;
    requireOk(hapto_loop_take_ticks(const_cast<hapto_loop*>(loop), &none, 0, &count, &lost));
    return lost;
  }

  void takeTicks() {
    constexpr std::uint64_t kAtOnce = 1024;
    taken_.resize(kAtOnce);
    std::uint64_t count = kAtOnce;
    while (count == kAtOnce) {
      requireOk(hapto_loop_take_ticks(const_cast<hapto_loop*>(loop_), taken_.data(), kAtOnce, &count, &lost_));
      records_.clear();
      std::transform(taken_.begin(), taken_.begin() + static_cast<std::ptrdiff_t>(count), std::back_inserter(records_),
                     recordOf);
      if (!records_.empty()) {
        writer_.add(records_);
        ticks_ += records_.size();
        last_s_ = records_.back().time_s;
      }
    }
  }

  void add(const char* kind, double time_s, const char* text) {
    writer_.add(RecordingEvent{.time_s = time_s, .tick = ticks_, .kind = kind, .text = text});
  }

  void requireWriter() const {
    if (finished_) {
      throw RefusedAction("recorder", "the recorder is already finished");
    }
  }
  void requireNoProblem() const {
    if (const std::string problem = writer_.problem(); !problem.empty()) {
      throw Failure(problem);
    }
  }

  const hapto_loop* loop_;
  std::uint64_t lost_before_, lost_;
  RecordingWriter writer_;
  double frame_every_s_, next_frame_s_ = 0, last_s_ = 0;
  std::uint64_t ticks_ = 0, pictured_ = 0;
  std::uint32_t trips_ = 0;
  bool ended_ = false, finished_ = false;
  std::vector<hapto_tick> taken_;
  std::vector<TickRecord> records_;
};

}  // namespace haptolith::library

struct hapto_recorder : haptolith::library::HandleOf<haptolith::library::Recorder> {
  static constexpr std::uint32_t kKind = 0x48615263;
};

using namespace haptolith;
using namespace haptolith::library;

namespace {

template <class Body>
std::int32_t with(const hapto_recorder* recorder, Body&& body) {
  return withHandle(recorder, "recorder", std::forward<Body>(body));
}

}  // namespace

std::int32_t hapto_recorder_create(hapto_loop* loop, const char* path, double frames_per_s, std::uint32_t flags,
                                   hapto_recorder** out) {
  if (loop == nullptr || path == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, loop == nullptr ? "loop" : path == nullptr ? "path" : "out");
  }
  return guarded([&] {
    if ((flags & ~std::uint32_t{HAPTO_RECORDER_OVERWRITE}) != 0) {
      throw InvalidParameter("flags", std::to_string(flags), "a sum of HAPTO_RECORDER_...");
    }
    constexpr Range kFrames{0, 60};
    (void)requireInRange("frames_per_s", frames_per_s, kFrames);
    *out = Places<hapto_recorder>::take(
        std::make_unique<Recorder>(loop, path, frames_per_s, (flags & HAPTO_RECORDER_OVERWRITE) != 0));
    return std::int32_t{HAPTO_OK};
  });
}

std::int32_t hapto_recorder_take(hapto_recorder* recorder) {
  return with(recorder, [](Recorder& object) { object.take(); });
}

std::int32_t hapto_recorder_note(hapto_recorder* recorder, const char* kind, const char* text) {
  if (kind == nullptr || text == nullptr) {
    return wrongArgument(HAPTO_NULL, kind == nullptr ? "kind" : "text");
  }
  return with(recorder, [&](Recorder& object) { object.note(kind, text); });
}

std::int32_t hapto_recorder_finish(hapto_recorder* recorder) {
  return with(recorder, [](Recorder& object) { object.finish(); });
}

std::int32_t hapto_recorder_get_info(const hapto_recorder* recorder, hapto_recorder_info* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return wrongArgument(status, "out");
  }
  return with(recorder, [out](const Recorder& object) { object.info(*out); });
}

std::int32_t hapto_recorder_destroy(hapto_recorder* recorder) {
  Claim claim(recorder);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "recorder");
  }
  const std::int32_t status = guarded([&] {
    claim->finish();
    return std::int32_t{HAPTO_OK};
  });
  claim.destroy();
  return status;
}

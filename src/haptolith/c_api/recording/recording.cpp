// Recordings that are read, and run again.

#include <haptolith/recording.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/c_api/handles.h"
#include "haptolith/c_api/ticks.h"
#include "haptolith/c_api/values.h"
#include "haptolith/c_api/with_handle.h"
#include "haptolith/core/error.h"
#include "haptolith/recording/recording_reader.h"
#include "haptolith/recording/replay.h"

namespace haptolith::library {

namespace {

using Json = nlohmann::ordered_json;

/// Serialises a text; invalid UTF-8 is replaced.
std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

HAPTO_FIRST_SIZE(hapto_recording_info, tick_s);
HAPTO_FIRST_SIZE(hapto_recorded_frame, particles);
HAPTO_FIRST_SIZE(hapto_replay_report, missing);

class Recording {
 public:
  explicit Recording(const char* path) : reader_(path) {}

  void info(hapto_recording_info& out) const {
    give({.size = 0,
          .finished = reader_.finished() ? 1 : 0,
          .ticks = reader_.ticks(),
          .frames = reader_.frames(),
          .events = reader_.events(),
          .missing_ticks = reader_.missingTicks(),
          .start_tick = reader_.header().start_tick,
          .tick_s = reader_.header().tick_s},
         out);
  }

  [[nodiscard]] std::string header() const {
    const RecordingHeader& header = reader_.header();
    return dumped({{"scenario", header.scene_file},
                   {"title", header.title},
                   {"program_version", header.program_version},
                   {"instruction_set", header.instruction_set},
                   {"arithmetic", header.arithmetic},
                   {"device", header.device},
                   {"device_limits", header.device_limits},
                   {"host", header.host},
                   {"started_utc", header.started_utc},
                   {"seed", header.seed},
                   {"threads", header.threads},
                   {"hashed_parts", header.hashed_parts}});
  }

  [[nodiscard]] std::string events() const {
    Json list = Json::array();
    for (const RecordingEvent& event : reader_.readEvents(0, reader_.events())) {
      list.push_back({{"time_s", event.time_s}, {"tick", event.tick}, {"kind", event.kind}, {"text", event.text}});
    }
    return dumped(list);
  }

  [[nodiscard]] std::uint64_t ticks(std::uint64_t first, hapto_tick* out, std::uint64_t capacity) const {
    constexpr std::uint64_t kAtOnce = 4096;
    std::uint64_t done = 0;
    while (done < capacity) {
      const std::vector<TickRecord> read = reader_.readTicks(first + done, std::min(kAtOnce, capacity - done));
      std::ranges::transform(read, out + done, tickOf);
      done += read.size();
      if (read.empty()) {
        break;
      }
    }
    return done;
  }

  [[nodiscard]] std::int32_t frame(std::uint64_t index, hapto_recorded_frame& out, float* positions,
                                   std::uint64_t capacity) const {
    const std::vector<FrameRow> rows = reader_.readFrameRows(index, 1);
    if (rows.empty()) {
      throw InvalidParameter("index", std::to_string(index),
                             "less than the number of frames, " + std::to_string(reader_.frames()));
    }
    const FrameRow& row = rows.front();
    give({.size = 0, .reserved = 0, .time_s = row.time_s, .tick = row.tick, .particles = row.count}, out);
    if (positions == nullptr && capacity == 0) {
      return HAPTO_OK;
    }
    if (positions == nullptr) {
      return wrongArgument(HAPTO_NULL, "positions");
    }
    if (capacity / 3 < row.count) {
      return wrongArgument(HAPTO_TOO_SMALL, "capacity");
    }
    const ParticleFrame frame = reader_.readFrame(row);
    std::memcpy(positions, frame.position_m.data(), frame.position_m.size() * sizeof frame.position_m.front());
    return HAPTO_OK;
  }

  [[nodiscard]] std::int32_t verify(std::uint32_t threads, hapto_progress told, void* user, hapto_replay_report& out) {
    readEnvironment();
    Progress progress(told, user);
    return progress.status([&] {
      std::optional<int> share;
      if (threads > 0) {
        share = static_cast<int>(std::min<std::uint32_t>(threads, 1 << 16));
      }
      Replay replay(reader_, share, [&](double, double) { return progress.tell("soil settles", -1); });
      constexpr std::uint64_t kTellEvery = 100;
      std::uint64_t ticks = 0;
      const auto all = static_cast<double>(std::max<std::uint64_t>(reader_.ticks(), 1));
      bool stopped = false;
      const ReplayResult result = replay.run([&](const TickRecord&, const TickRecord&) {
        stopped = ++ticks % kTellEvery == 0 && !progress.tell("ticks are compared", static_cast<double>(ticks) / all);
        return !stopped;
      });
      if (stopped) {
        throw Failure("stopped");
      }
      different_ = result.difference ? result.difference->what : "";
      ended_early_ = result.ended_early;
      give({.size = 0,
            .same = result.difference ? 0 : 1,
            .ticks = result.ticks,
            .hashes = result.hashes,
            .different_tick = result.difference ? result.difference->tick : 0,
            .different = different_.c_str(),
            .ended_early = ended_early_.c_str(),
            .missing = result.gap ? result.gap->ticks : 0},
           out);
      return std::int32_t{HAPTO_OK};
    });
  }

 private:
  RecordingReader reader_;
  std::string different_, ended_early_;  ///< results of the last verification
};

}  // namespace haptolith::library

struct hapto_recording : haptolith::library::HandleOf<haptolith::library::Recording> {
  static constexpr std::uint32_t kKind = 0x48615264;
};

using namespace haptolith;
using namespace haptolith::library;

namespace {

template <class Body>
std::int32_t with(const hapto_recording* recording, Body&& body) {
  return withHandle(recording, "recording", std::forward<Body>(body));
}

}  // namespace

std::int32_t hapto_recording_open(const char* path, hapto_recording** out) {
  if (path == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, path == nullptr ? "path" : "out");
  }
  return guarded([&] {
    *out = Places<hapto_recording>::take(std::make_unique<Recording>(path));
    return std::int32_t{HAPTO_OK};
  });
}

std::int32_t hapto_recording_get_info(const hapto_recording* recording, hapto_recording_info* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return wrongArgument(status, "out");
  }
  return with(recording, [out](const Recording& object) {
    object.info(*out);
    return HAPTO_OK;
  });
}

std::int32_t hapto_recording_get_header(const hapto_recording* recording, char* json, std::uint64_t capacity,
                                        std::uint64_t* needed) {
  return with(recording, [&](const Recording& object) {
    const std::string text = object.header();
    return handOut({text.c_str(), text.size() + 1}, json, capacity, needed);
  });
}

std::int32_t hapto_recording_get_events(const hapto_recording* recording, char* json, std::uint64_t capacity,
                                        std::uint64_t* needed) {
  return with(recording, [&](const Recording& object) {
    const std::string text = object.events();
    return handOut({text.c_str(), text.size() + 1}, json, capacity, needed);
  });
}

std::int32_t hapto_recording_read_ticks(const hapto_recording* recording, std::uint64_t first, hapto_tick* out,
                                        std::uint64_t capacity, std::uint64_t* count) {
  if (out == nullptr || count == nullptr) {
    return wrongArgument(HAPTO_NULL, out == nullptr ? "out" : "count");
  }
  return with(recording, [&](const Recording& object) {
    *count = object.ticks(first, out, capacity);
    return HAPTO_OK;
  });
}

std::int32_t hapto_recording_read_frame(const hapto_recording* recording, std::uint64_t index,
                                        hapto_recorded_frame* out, float* positions, std::uint64_t capacity) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return wrongArgument(status, "out");
  }
  return with(recording, [&](const Recording& object) { return object.frame(index, *out, positions, capacity); });
}

std::int32_t hapto_recording_verify(hapto_recording* recording, std::uint32_t threads, hapto_progress progress,
                                    void* user, hapto_replay_report* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return wrongArgument(status, "out");
  }
  return with(recording, [&](Recording& object) { return object.verify(threads, progress, user, *out); });
}

std::int32_t hapto_recording_destroy(hapto_recording* recording) {
  Claim claim(recording);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "recording");
  }
  claim.destroy();
  return HAPTO_OK;
}

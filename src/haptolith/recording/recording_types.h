#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>

#include "haptolith/recording/hdf5_handle.h"
#include "haptolith/recording/recording_format.h"

// Types of a recording's data in the HDF5 file, for its writer and its reader. Each type exists twice: as in the
// file (packed, little-endian), and as in memory.

namespace haptolith::hdf5 {

inline constexpr const char* kSchema = "haptolith recording";
inline constexpr std::uint64_t kSchemaVersion = 1;

inline constexpr const char* kTicks = "/ticks";
inline constexpr const char* kPosition = "/particles/position";
inline constexpr const char* kFrames = "/particles/frames";
inline constexpr const char* kEvents = "/events";
inline constexpr const char* kTools = "/tools";
inline constexpr const char* kRobot = "/robot";
inline constexpr const char* kReports = "/robot/reports";
inline constexpr const char* kSite = "/robot/site";

/// An attribute of the file's root, which the first recordings lack: RecordingReader::missingTicks().
inline constexpr const char* kMissingTicks = "missing_ticks";

enum class Place { kFile, kMemory };

/// A row of /events.
struct EventRow {
  double time_s = 0;
  std::uint64_t tick = 0;
  std::array<char, RecordingEvent::kMostKind> kind{};
  std::array<char, RecordingEvent::kMostText> text{};
};

[[nodiscard]] Handle tickType(Place place);
[[nodiscard]] Handle jointType(Place place);
[[nodiscard]] Handle frameType(Place place);
[[nodiscard]] Handle eventType(Place place);
[[nodiscard]] Handle robotType(Place place);
[[nodiscard]] Handle siteType(Place place);
[[nodiscard]] Handle coordinateType(Place place);
/// UTF-8 of at most `bytes`, filled up with zeros.
[[nodiscard]] Handle textType(std::size_t bytes);
[[nodiscard]] Handle countType(Place place);   ///< 64 bits without sign
[[nodiscard]] Handle numberType(Place place);  ///< double precision

/// An attribute of the file's root.
struct HeaderEntry {
  template <class T>
  using Member = T RecordingHeader::*;

  const char* name;
  std::variant<Member<std::string>, Member<std::uint64_t>, Member<double>> member;
  bool is_new = false;  ///< files of version 0.2 and earlier lack it
};

inline constexpr HeaderEntry kHeaderEntries[]{
    {"scenario", &RecordingHeader::scene_file},
    {"title", &RecordingHeader::title},
    {"program_version", &RecordingHeader::program_version},
    {"instruction_set", &RecordingHeader::instruction_set},
    {"arithmetic", &RecordingHeader::arithmetic, true},
    {"device", &RecordingHeader::device},
    {"device_limits", &RecordingHeader::device_limits},
    {"host", &RecordingHeader::host},
    {"started_utc", &RecordingHeader::started_utc},
    {"seed", &RecordingHeader::seed},
    {"threads", &RecordingHeader::threads},
    {"hashed_parts", &RecordingHeader::hashed_parts},
    {"start_tick", &RecordingHeader::start_tick},
    {"tick_s", &RecordingHeader::tick_s},
    {"tools", &RecordingHeader::tools, true},
};

}  // namespace haptolith::hdf5

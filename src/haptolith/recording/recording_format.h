#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptolith/device/declared_limits.h"
#include "haptolith/haptics/shown_scene.h"
#include "haptolith/haptics/tick_record.h"
#include "haptolith/soil/soil_parameters.h"

// What a recording holds: an HDF5 file with /ticks, /particles/position, /particles/frames, /events and a header.

namespace haptolith {

/// Of any text in the header, in bytes.
inline constexpr std::size_t kLongestHeaderText = std::size_t{1} << 20;

/// What a recording tells about its run: what is needed to run it again, and what a person wants to know years later.
struct RecordingHeader {
  std::string scenario;         ///< the scene as TOML, with the mesh of its tool
  std::string title;            ///< of the scene
  std::string program_version;  ///< of haptolith
  std::string instruction_set;  ///< simdTarget(): another one has other last bits
  std::string device;           ///< HapticDevice::name()
  std::string device_limits;    ///< limitsText()
  std::string host;             ///< the machine's name
  std::string started_utc;      ///< time of day at the first tick, ISO 8601
  std::uint64_t seed = 0;
  std::uint64_t threads = 1;
  std::uint64_t hashed_parts = 1;  ///< ticks that state_hash needs to go once round the bed
  std::uint64_t start_tick = 0;    ///< number of the first tick in the file
  double tick_s = 0.001;           ///< > 0
};

/// Number of a tick in its run, from 1, by its time; 0 when no tick of a run has that time. Numbers of consecutive
/// ticks follow one another, however often the run was paused.
[[nodiscard]] std::uint64_t tickNumber(double time_s, double tick_s) noexcept;

/// Writes this machine's name and the time of day into a header.
void stampNow(RecordingHeader& header);

/// Where all particles were at the end of a tick, in the scene's frame.
struct ParticleFrame {
  double time_s = 0;
  std::uint64_t tick = 0;
  std::vector<std::array<float, 3>> position_m;
};

/// Where a frame lies in /particles/position: a row of /particles/frames.
struct FrameRow {
  double time_s = 0;
  std::uint64_t tick = 0, first = 0, count = 0;
};

/// What a picture of the scene says about its particles.
[[nodiscard]] ParticleFrame particleFrame(const SceneSnapshot& snapshot);

/// Something that happened: a change of the scene, a safety trip, a device lost.
struct RecordingEvent {
  static constexpr std::size_t kMostKind = 32, kMostText = 480;  ///< bytes of UTF-8; what is longer is cut

  double time_s = 0;
  std::uint64_t tick = 0;
  std::string kind;  ///< one word
  std::string text;
};

/// The event of a change of the soil that a replay makes again, and what it says.
inline constexpr const char* kAdjustmentKind = "soil";
[[nodiscard]] std::string adjustmentText(const SoilAdjustment& adjustment);
/// @throws Failure when the event says something else.
[[nodiscard]] SoilAdjustment adjustmentOf(const RecordingEvent& event);

/// A column of /ticks: its name, with the unit, and which member of TickRecord it holds.
struct TickColumn {
  using Value = std::variant<double, std::uint64_t, std::uint32_t, std::uint8_t>;

  std::string name;
  Value type;          ///< of the member; its value means nothing
  std::size_t offset;  ///< of the member in TickRecord, in bytes

  /// What a record has in this column.
  [[nodiscard]] Value of(const TickRecord& record) const noexcept;
};

/// The columns' names, and a record's values that read back as the same: lines of a CSV file.
[[nodiscard]] std::string csvHeader();
void appendCsv(std::string& text, const TickRecord& record);

/// All columns, in the order of the file. The file's type, its reader and the CSV export are made of these.
[[nodiscard]] const std::vector<TickColumn>& tickColumns();

}  // namespace haptolith

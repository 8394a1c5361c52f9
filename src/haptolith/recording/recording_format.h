#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptolith/bed/bed.h"
#include "haptolith/device/declared_limits.h"
#include "haptolith/haptics/loop/shown_scene.h"
#include "haptolith/haptics/tick_record.h"
#include "haptolith/soil/soil_parameters.h"

// Content of a recording: an HDF5 file with /ticks, /particles/position, /particles/frames, /events and a header; where
// a robot followed the tool, /robot/reports and /robot/site. Tools after the first have /tools/NAME/ticks, with the
// columns of /ticks; tools with a joint have /tools/NAME/joint.

namespace haptolith {

/// Size limit of any text in the header, in bytes.
inline constexpr std::size_t kLongestHeaderText = std::size_t{1} << 20;

/// Description of a recorded run: everything needed to run it again, and its circumstances for later readers.
struct RecordingHeader {
  std::string scene_file;       ///< the scene as TOML, with the mesh of its tool
  std::string title;            ///< title of the scene
  std::string program_version;  ///< version of haptolith
  std::string instruction_set;  ///< simdTarget()
  std::string arithmetic;       ///< haptolith::arithmetic(): another one has other last bits; empty up to version 0.2
  std::string device;           ///< HapticDevice::name()
  std::string device_limits;    ///< limitsText()
  std::string host;             ///< the machine's name
  std::string started_utc;      ///< time of day at the first tick, ISO 8601
  std::uint64_t seed = 0;
  std::uint64_t threads = 1;
  std::uint64_t hashed_parts = 1;  ///< ticks that state_hash needs to go once round the bed
  std::uint64_t start_tick = 0;    ///< number of the first tick in the file
  double tick_s = 0.001;           ///< > 0
  std::string tools{};             ///< toolsText(); empty with one tool without a joint
};

/// One of the tools of a recorded scene.
struct RecordedTool {
  std::string name;
  std::string device;         ///< HapticDevice::name()
  std::string device_limits;  ///< limitsText()
  bool has_joint = false;
};

/// For RecordingHeader::tools, and back: of a recording with one tool without a joint, that one.
[[nodiscard]] std::string toolsText(const std::vector<RecordedTool>& tools);
/// @throws Failure when the header says something else.
[[nodiscard]] std::vector<RecordedTool> toolsOf(const RecordingHeader& header);

/// Why a replay on this machine comes to other bits than the recording; empty: it does not.
[[nodiscard]] std::string whyOtherBits(const RecordingHeader& header);

/// Number of a tick in its run, from 1, by its time; 0 when no tick of a run has that time. Numbers of consecutive
/// ticks follow one another, however often the run was paused.
[[nodiscard]] std::uint64_t tickNumber(double time_s, double tick_s) noexcept;

/// Writes this machine's name and the time of day into a header.
void stampNow(RecordingHeader& header);

/// Positions of all particles at the end of a tick, in the scene frame.
struct ParticleFrame {
  double time_s = 0;
  std::uint64_t tick = 0;
  std::vector<std::array<float, 3>> position_m;
};

/// A joint at the end of a tick: a row of /tools/NAME/joint.
struct JointRow {
  double time_s = 0;
  JointState joint;
};

/// Place of a frame in /particles/position: a row of /particles/frames.
struct FrameRow {
  double time_s = 0;
  std::uint64_t tick = 0, first = 0, count = 0;
};

/// The particles of a snapshot.
[[nodiscard]] ParticleFrame particleFrame(const SceneSnapshot& snapshot);

/// Something that happened: a change of the scene, a safety trip, a device lost.
struct RecordingEvent {
  static constexpr std::size_t kMostKind = 32, kMostText = 480;  ///< bytes of UTF-8; what is longer is cut

  double time_s = 0;
  std::uint64_t tick = 0;
  std::string kind;  ///< one word
  std::string text;
};

/// Report of a robot that follows the tool, for a range of commands: a row of /robot/reports. In the scene's frame, as
/// if the surface of the robot's soil were this one's.
struct RobotRow {
  double heard_s = 0;          ///< when it was heard, in the time of the run
  std::uint64_t command = 0;   ///< number of the tick that it had come to
  std::uint64_t commands = 0;  ///< ticks up to that one that force and torque are the mean over; 0: it followed none
  Pose scene_T_tool;
  Wrench met;                          ///< soil wrench at the robot, about its tool's origin, scene frame
  std::uint8_t state = 0, reason = 0;  ///< its last reported state, and the reason of a stop
};

/// Its view of a part of the site: a row of /robot/site, in the same frame.
struct SiteRow {
  static constexpr std::size_t kCells = 256;

  double heard_s = 0;
  std::uint64_t command = 0;             ///< number of its tick at the time of the view
  std::array<double, 2> corner_m{};      ///< corner of the first cell of the complete map
  double cell_m = 0;                     ///< width of each
  std::array<std::uint32_t, 2> map{};    ///< columns along x, rows along y of the whole map
  std::array<std::uint32_t, 2> first{};  ///< column and row that the part begins at
  std::array<std::uint32_t, 2> count{};  ///< its columns and rows
  std::array<float, kCells> height_m{};  ///< row by row; NaN: not seen, or beyond the part
};

/// The event of a change of the soil that a replay makes again, and what it says.
inline constexpr const char* kAdjustmentKind = "soil";
[[nodiscard]] std::string adjustmentText(const SoilAdjustment& adjustment);
/// @throws Failure when the event says something else.
[[nodiscard]] SoilAdjustment adjustmentOf(const RecordingEvent& event);

/// Kind of event for a moved particle.
inline constexpr const char* kGrainMoveKind = "grain";
[[nodiscard]] std::string grainMoveText(const GrainMove& move);
/// @throws Failure when the event says something else.
[[nodiscard]] GrainMove grainMoveOf(const RecordingEvent& event);

/// A column of /ticks or /robot/reports: its name, with the unit, and which member of a TickRecord or RobotRow it
/// holds.
struct RecordColumn {
  using Value = std::variant<double, std::uint64_t, std::uint32_t, std::uint8_t>;

  std::string name;
  Value type;          ///< type of the member; the value is unused
  std::size_t offset;  ///< offset of the member, in bytes

  /// The value of a record in this column.
  template <class Record>
  [[nodiscard]] Value of(const Record& record) const noexcept {
    return at(reinterpret_cast<const std::byte*>(&record) + offset);
  }

 private:
  [[nodiscard]] Value at(const std::byte* member) const noexcept;
};

/// All columns, in the order of the file. The file's types, its reader and the CSV export are made of these.
[[nodiscard]] const std::vector<RecordColumn>& tickColumns();
[[nodiscard]] const std::vector<RecordColumn>& robotColumns();
/// Those of /ticks, and of the tool's joint.
[[nodiscard]] const std::vector<RecordColumn>& tickColumnsWithJoint();

/// The columns' names, and a record's values that read back as the same: lines of a CSV file.
[[nodiscard]] std::string csvHeader(const std::vector<RecordColumn>& columns);
void appendCsv(std::string& text, const TickRecord& record, bool with_joint = false);
void appendCsv(std::string& text, const RobotRow& row);

}  // namespace haptolith

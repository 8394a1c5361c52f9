#include "haptolith/recording/recording_format.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>
#include <ctime>
#include <iterator>
#include <utility>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/this_program.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith {

std::uint64_t tickNumber(double time_s, double tick_s) noexcept {
  constexpr double kMost = 1e15;  // whole numbers are exact up to there
  const double number = std::round(time_s / tick_s);
  return number > 0 && number < kMost ? static_cast<std::uint64_t>(number) : 0;
}

std::string whyOtherBits(const RecordingHeader& header) {
  if (header.arithmetic.empty()) {
    return fmt::format("it was recorded by haptolith {}, whose arithmetic was another; that version replays it",
                       header.program_version);
  }
  return header.arithmetic == arithmetic()
             ? ""
             : fmt::format("it was recorded with {} arithmetic, and this run uses {} arithmetic ({}): set {}",
                           header.arithmetic, arithmetic(), instructionSetName(simdTarget()),
                           targetsWith(header.arithmetic));
}

void stampNow(RecordingHeader& header) {
  header.started_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  header.host = hostName();
}

ParticleFrame particleFrame(const SceneSnapshot& snapshot) {
  ParticleFrame frame{.time_s = snapshot.time_s, .tick = snapshot.ticks, .position_m = {}};
  frame.position_m.reserve(snapshot.position.size());
  for (const Float4& position : snapshot.position) {
    frame.position_m.push_back({position.x, position.y, position.z});
  }
  return frame;
}

std::string adjustmentText(const SoilAdjustment& adjustment) {
  return nlohmann::ordered_json{{"contact_friction", adjustment.contact_friction},
                                {"contact_cohesion_n", adjustment.contact_cohesion_n},
                                {"tool_friction", adjustment.tool_friction}}
      .dump();
}

SoilAdjustment adjustmentOf(const RecordingEvent& event) {
  try {
    const auto json = nlohmann::json::parse(event.text);
    return {json.at("contact_friction"), json.at("contact_cohesion_n"), json.at("tool_friction")};
  } catch (const nlohmann::json::exception&) {
    throw Failure(fmt::format("the recording's event at {:.3f} s has a malformed soil: {}", event.time_s, event.text));
  }
}

std::string toolsText(const std::vector<RecordedTool>& tools) {
  nlohmann::ordered_json json = nlohmann::json::array();
  for (const RecordedTool& tool : tools) {
    json.push_back({{"name", tool.name},
                    {"device", tool.device},
                    {"device_limits", tool.device_limits},
                    {"has_joint", tool.has_joint}});
  }
  return json.dump();
}

std::vector<RecordedTool> toolsOf(const RecordingHeader& header) {
  if (header.tools.empty()) {
    return {{std::string(SceneFile::kFirstToolName), header.device, header.device_limits}};
  }
  std::vector<RecordedTool> tools;
  try {
    for (const auto& json : nlohmann::json::parse(header.tools)) {
      tools.push_back({json.at("name"), json.at("device"), json.at("device_limits"), json.at("has_joint")});
      requireToolName(tools.back().name);  // a group has it
    }
  } catch (const std::exception&) {
    tools.clear();
  }
  if (tools.empty() || tools.size() > ToolSet::kMost) {
    throw Failure("tools in its header is no list of tools");
  }
  return tools;
}

std::string grainMoveText(const GrainMove& move) {
  const auto triple = [](const Vec3& v) { return std::array{v.x(), v.y(), v.z()}; };
  return nlohmann::ordered_json{{"grain", move.grain}, {"from_m", triple(move.from_m)}, {"to_m", triple(move.to_m)}}
      .dump();
}

GrainMove grainMoveOf(const RecordingEvent& event) {
  try {
    const auto json = nlohmann::json::parse(event.text);
    const auto vector = [&](const char* key) {
      const auto v = json.at(key).get<std::array<double, 3>>();
      return Vec3(v[0], v[1], v[2]);
    };
    const auto& grain = json.at("grain");
    if (grain.is_number_unsigned()) {
      return {grain, vector("from_m"), vector("to_m")};
    }
  } catch (const nlohmann::json::exception&) {
    // Nor is it a grain's.
  }
  throw Failure(
      fmt::format("the recording's event at {:.3f} s has a malformed particle: {}", event.time_s, event.text));
}

namespace {

/// Names the members of a record one after the other.
template <class Record>
class ColumnList {
 public:
  template <class T>
  void add(std::string name, const T& member) {
    columns_.push_back({std::move(name), T{}, offset(&member)});
  }

  // An enumeration is read and written as the byte that it is.
  void add(std::string name, const DeviceState& state) {
    columns_.push_back({std::move(name), std::uint8_t{}, offset(&state)});
  }

  void addVector(const std::string& name, const Vec3& vector, const std::string& unit) {
    add(name + "x" + unit, vector.x());
    add(name + "y" + unit, vector.y());
    add(name + "z" + unit, vector.z());
  }

  void addPose(const std::string& name, const Pose& pose) {
    addVector(name, pose.position_m, "_m");
    add(name + "qw", pose.orientation.coeffs().w());
    add(name + "qx", pose.orientation.coeffs().x());
    add(name + "qy", pose.orientation.coeffs().y());
    add(name + "qz", pose.orientation.coeffs().z());
  }

  void addWrench(const std::string& name, const Wrench& wrench) {
    addVector(name + "f", wrench.force_n, "_n");
    addVector(name + "t", wrench.torque_nm, "_nm");
  }

  void addOutput(const std::string& name, const DeviceOutput& output) {
    addWrench(name, output.wrench);
    add(name + "gripper_n", output.gripper_force_n);
  }

  [[nodiscard]] const Record& record() const noexcept { return record_; }
  [[nodiscard]] std::vector<RecordColumn> columns() && { return std::move(columns_); }

 private:
  [[nodiscard]] std::size_t offset(const void* member) const noexcept {
    return static_cast<std::size_t>(static_cast<const std::byte*>(member) -
                                    reinterpret_cast<const std::byte*>(&record_));
  }

  Record record_;
  std::vector<RecordColumn> columns_;
};

std::vector<RecordColumn> makeTickColumns(bool with_joint = false) {
  ColumnList<TickRecord> list;
  const TickRecord& tick = list.record();
  list.add("t_s", tick.time_s);
  list.addPose("device_", tick.device.pose);
  list.addVector("device_v", tick.device.twist.linear_m_s, "_m_s");
  list.addVector("device_w", tick.device.twist.angular_rad_s, "_rad_s");
  list.add("gripper_open", tick.device.gripper_open);
  list.add("buttons", tick.device.buttons);
  list.add("device_state", tick.device.state);
  list.addPose("tool_", tick.scene_T_tool);
  list.addWrench("soil_", tick.soil);
  list.addOutput("rendered_", tick.rendered);
  list.addOutput("felt_", tick.sent);
  list.add("injected_j", tick.injected_j);
  list.add("quick_injected_j", tick.quick_injected_j);
  list.add("tick_us", tick.tick_us);
  list.add("late_us", tick.late_us);
  list.add("state_hash", tick.state_hash);
  list.add("flags", tick.flags);
  list.add("trip", tick.trip);
  if (with_joint) {
    list.add("joint_angle_rad", tick.joint.angle_rad);
    list.add("joint_speed_rad_s", tick.joint.speed_rad_s);
    list.add("joint_soil_torque_nm", tick.joint.soil_torque_nm);
    list.add("joint_motor_torque_nm", tick.joint.motor_torque_nm);
  }
  return std::move(list).columns();
}

std::vector<RecordColumn> makeRobotColumns() {
  ColumnList<RobotRow> list;
  const RobotRow& row = list.record();
  list.add("heard_s", row.heard_s);
  list.add("command", row.command);
  list.add("commands", row.commands);
  list.addPose("tool_", row.scene_T_tool);
  list.addWrench("met_", row.met);
  list.add("state", row.state);
  list.add("reason", row.reason);
  return std::move(list).columns();
}

template <class Record>
void appendLine(std::string& text, const std::vector<RecordColumn>& columns, const Record& record) {
  for (const RecordColumn& column : columns) {
    std::visit([&](auto value) { fmt::format_to(std::back_inserter(text), "{},", value); }, column.of(record));
  }
  text.back() = '\n';
}

}  // namespace

RecordColumn::Value RecordColumn::at(const std::byte* member) const noexcept {
  return std::visit(
      [&](auto value) -> Value {
        std::memcpy(&value, member, sizeof(value));
        return value;
      },
      type);
}

std::string csvHeader(const std::vector<RecordColumn>& columns) {
  std::string text;
  for (const RecordColumn& column : columns) {
    text += (text.empty() ? "" : ",") + column.name;
  }
  return text + '\n';
}

void appendCsv(std::string& text, const TickRecord& record, bool with_joint) {
  appendLine(text, with_joint ? tickColumnsWithJoint() : tickColumns(), record);
}

void appendCsv(std::string& text, const RobotRow& row) {
  appendLine(text, robotColumns(), row);
}

const std::vector<RecordColumn>& tickColumns() {
  static const std::vector<RecordColumn> kColumns = makeTickColumns();
  return kColumns;
}

const std::vector<RecordColumn>& tickColumnsWithJoint() {
  static const std::vector<RecordColumn> kColumns = makeTickColumns(true);
  return kColumns;
}

const std::vector<RecordColumn>& robotColumns() {
  static const std::vector<RecordColumn> kColumns = makeRobotColumns();
  return kColumns;
}

}  // namespace haptolith

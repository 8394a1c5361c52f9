#include "haptolith/recording/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/device/replay_device.h"

namespace haptolith {

namespace {

constexpr std::uint64_t kRowsAtOnce = 1024;  ///< ticks that are read at a time
constexpr double kLookedFurther_s = 1;       ///< after a difference, for a frame

/// Compares bits, so that NaN equals NaN.
bool same(double a, double b) noexcept {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || a == b;
}

bool same(const Vec3& a, const Vec3& b) noexcept {
  return same(a.x(), b.x()) && same(a.y(), b.y()) && same(a.z(), b.z());
}

bool same(const Wrench& a, const Wrench& b) noexcept {
  return same(a.force_n, b.force_n) && same(a.torque_nm, b.torque_nm);
}

bool same(const DeviceOutput& a, const DeviceOutput& b) noexcept {
  return same(a.wrench, b.wrench) && same(a.gripper_force_n, b.gripper_force_n);
}

bool same(const Pose& a, const Pose& b) noexcept {
  const Quat& p = a.orientation;
  const Quat& q = b.orientation;
  return same(a.position_m, b.position_m) && same(p.w(), q.w()) && same(Vec3(p.vec()), Vec3(q.vec()));
}

/// Number of ticks missing after the last one: the end is a separate event, and the writer has counted.
std::uint64_t missingAtTheEnd(const RecordingReader& recording, std::uint64_t last) {
  std::uint64_t missing = recording.missingTicks();
  for (const RecordingEvent& event : recording.readEvents(0, recording.events())) {
    const std::uint64_t number = tickNumber(event.time_s, recording.header().tick_s);
    if (event.kind == "end" && number > last) {
      missing = std::max(missing, number - last);
    }
  }
  return missing;
}

bool same(const JointState& a, const JointState& b) noexcept {
  return same(a.angle_rad, b.angle_rad) && same(a.speed_rad_s, b.speed_rad_s) &&
         same(a.soil_torque_nm, b.soil_torque_nm) && same(a.motor_torque_nm, b.motor_torque_nm);
}

/// All columns but those of the device, which are fed in, and those that depend on the clock.
const char* columnThatDiffers(const TickRecord& was, const TickRecord& is, bool has_joint) noexcept {
  if (was.state_hash != 0 && was.state_hash != is.state_hash) {
    return "state_hash";
  }
  if (!same(was.scene_T_tool, is.scene_T_tool)) {
    return "tool pose";
  }
  if (!same(was.soil, is.soil)) {
    return "soil wrench";
  }
  if (has_joint && !same(was.joint, is.joint)) {
    return "joint";
  }
  if (!same(was.rendered, is.rendered)) {
    return "rendered force";
  }
  if (!same(was.sent, is.sent)) {
    return "device wrench";
  }
  if (!same(was.injected_j, is.injected_j) || !same(was.quick_injected_j, is.quick_injected_j)) {
    return "injected energy";
  }
  if (was.trip != is.trip) {
    return "trip";
  }
  if (((was.flags ^ is.flags) & kTickFailed) != 0) {
    return "end";
  }
  return ((was.flags ^ is.flags) & ~std::uint32_t{kTickLate}) == 0 ? nullptr : "flags";
}

}  // namespace

Replay::Replay(const RecordingReader& recording, std::optional<int> threads, const SettleProgress& progress)
    : recording_(recording) {
  const RecordingHeader& header = recording.header();
  if (header.start_tick != 0) {
    throw Failure(
        fmt::format("cannot replay this recording: it began at tick {} of its run, and the state of the bed at that "
                    "time is unknown; record a complete run with 'haptolith run --record'",
                    header.start_tick));
  }
  scene_file_ = loadSceneFileText(header.scene_file, "the recorded scene");
  scene_file_.bed.threads = threads.value_or(scene_file_.bed.threads);
  scene_file_.loop.real_time = false;
  const std::vector<RecordedTool>& tools = recording.tools();
  if (tools.size() != toolCount(scene_file_)) {
    throw Failure(fmt::format("cannot replay this recording: it has {} of {}", pluralise(tools.size(), "tool"),
                              toolCount(scene_file_)));
  }
  scene_ = std::make_unique<Scene>(scene_file_.bed, toolSet(scene_file_), progress);
  std::vector<ToolHandling> hands;
  for (std::size_t i = 0; i < tools.size(); ++i) {
    const RecordedTool& tool = tools[i];
    const DeclaredLimits declared = limitsOf(tool.device_limits);
    devices_.emplace_back(tool.device, declared.limits, declared.simulated);
    exchangeFirst(scene_file_, i);
    const double surface_m = scene_file_.hand.surface_m.value_or(scene_->bed().surfaceHeight());
    // A host's own device is named by no scene, which names the virtual hand then. Other leaders of the virtual hand
    // are named after it, and share its frame.
    const bool own =
        scene_file_.device.kind == DeviceKind::kVirtualHand && !tool.device.starts_with(VirtualHand::kName);
    hands.push_back(
        {&devices_.back(), own ? handlingOfOwnDevice(scene_file_, surface_m) : handlingOf(scene_file_, surface_m)});
    exchangeFirst(scene_file_, i);
  }
  loop_ = std::make_unique<HapticLoop>(*scene_, hands, scene_file_.loop, true);
  loop_->hashRecords();
  for (const RecordingEvent& event : recording.readEvents(0, recording.events())) {
    if (event.kind == kAdjustmentKind) {
      adjustments_.push_back(adjustmentOf(event));
    } else if (event.kind == kGrainMoveKind) {
      grain_moves_.push_back(grainMoveOf(event));
    }
  }
}

/// Before a tick: gives the loop what it was given then.
/// @return why that cannot be done; empty when it was.
std::string Replay::prepare(std::span<const TickRecord> of_tools) {
  const TickRecord& was = of_tools.front();
  if ((was.flags & kTickSceneChanged) != 0) {
    return fmt::format("at {:.3f} s a client changed the scene", was.time_s);
  }
  for (std::size_t tool = 0; tool < of_tools.size(); ++tool) {
    devices_[tool].feed(of_tools[tool].device);
  }
  if ((was.flags & kTickResumed) != 0) {
    loop_->ask(request::Pause{});
    (void)loop_->tick();
    loop_->ask(request::Resume{});
  }
  if ((was.flags & kTickSoilAdjusted) != 0) {
    if (adjustments_.empty()) {
      return fmt::format("at {:.3f} s the soil changed; the change is not recorded", was.time_s);
    }
    const SoilAdjustment& adjustment = adjustments_.front();
    validate(adjustment.of(scene_file_.bed.soil));
    requireInRange("tool_friction", adjustment.tool_friction, ToolRanges::friction);
    loop_->ask(request::Adjust{SoilLaws(adjustment.of(scene_file_.bed.soil), grainClasses(scene_file_.bed)),
                               adjustment.tool_friction});
    adjustments_.pop_front();
  }
  if ((was.flags & kTickParticleMoved) != 0) {
    if (grain_moves_.empty()) {
      return fmt::format("at {:.3f} s a particle was moved; its index is not recorded", was.time_s);
    }
    loop_->ask(request::MoveGrain{grain_moves_.front()});
    grain_moves_.pop_front();
  }
  if ((was.flags & kTickSoftStop) != 0) {
    loop_->softStop();
  }
  for (std::size_t tool = 0; tool < of_tools.size(); ++tool) {
    loop_->overrideHealth({late_, (of_tools[tool].flags & kTickHeartbeatLost) != 0}, tool);
  }
  late_ = (was.flags & kTickLate) != 0;
  return {};
}

/// Empty without one.
std::string Replay::differenceOf(std::span<const TickRecord> was, std::span<const TickRecord> is) const {
  for (std::size_t i = 0; i < was.size(); ++i) {
    const RecordedTool& tool = recording_.tools()[i];
    if (const char* what = columnThatDiffers(was[i], is[i], tool.has_joint)) {
      return i == 0 ? what : fmt::format("{}: {}", tool.name, what);
    }
  }
  return {};
}

ReplayResult Replay::run(const std::function<bool(const TickRecord& was, const TickRecord& is)>& go_on,
                         double until_s) {
  ReplayResult result;
  FrameCheck frames(recording_);
  std::vector<TickRecord> replayed, of_tools;  // all in one tick
  std::uint64_t last = 0;
  double last_s = 0;
  const auto compare = [&](const std::optional<ComparedFrame>& frame) {
    if (frame && result.difference) {
      result.difference->frame = frame;
    } else if (frame && frame->different > 0) {
      result.difference = {frame->tick > 0 ? frame->tick - 1 : 0, frame->time_s, "particles", frame};
    }
    result.frames = frames.compared();
  };
  // After a difference nothing else counts but the particles of the next frame.
  const auto done = [&](double time_s) {
    return result.difference && (result.difference->frame || time_s > result.difference->time_s + kLookedFurther_s);
  };
  const auto end_early = [&](std::string why) {
    result.ended_early = result.difference ? "" : std::move(why);
    return result;
  };
  frames.afterTick(0, *scene_);
  for (std::uint64_t first = 0; first < recording_.ticks(); first += kRowsAtOnce) {
    std::vector<std::vector<TickRecord>> rows;
    for (std::size_t tool = 0; tool < devices_.size(); ++tool) {
      rows.push_back(recording_.readTicks(first, kRowsAtOnce, tool));
    }
    for (std::size_t row = 0; row < rows.front().size(); ++row) {
      const TickRecord& was = rows.front()[row];
      of_tools.clear();
      for (const std::vector<TickRecord>& of_tool : rows) {
        if (row < of_tool.size() && of_tool[row].time_s == was.time_s) {
          of_tools.push_back(of_tool[row]);
        }
      }
      const std::uint64_t number = tickNumber(was.time_s, recording_.header().tick_s);
      if (was.time_s > until_s + recording_.header().tick_s / 2 && !result.difference) {
        compare(frames.atEnd(*scene_));
        return result;
      }
      if (number != last + 1) {
        result.gap = {number > last ? number - last - 1 : 0, last_s};
        return result;
      }
      if (of_tools.size() != devices_.size()) {
        return end_early(fmt::format("at {:.3f} s the ticks of a tool are missing", was.time_s));
      }
      compare(frames.beforeTick(number, (was.flags & kTickResumed) != 0, *scene_));
      if (done(was.time_s)) {
        return result;
      }
      if (const std::string why = prepare(of_tools); !why.empty()) {
        return end_early(why);
      }
      const LoopEnd end = loop_->tick();
      last = number;
      last_s = was.time_s;
      replayed.clear();
      loop_->takeRecords(replayed);
      if (replayed.size() != devices_.size()) {
        return end_early(fmt::format("at {:.3f} s the replay ended: {}", was.time_s, text(end)));
      }
      frames.afterTick(number, *scene_);
      if (result.difference) {
        continue;
      }
      ++result.ticks;
      result.hashes += was.state_hash != 0 ? 1 : 0;
      if (std::string what = differenceOf(of_tools, replayed); !what.empty()) {
        result.difference = {result.ticks - 1, was.time_s, std::move(what)};
        if (((was.flags | replayed.front().flags) & kTickFailed) != 0) {
          return result;
        }
        continue;
      }
      if ((was.flags & kTickFailed) != 0) {
        result.end = fmt::format("at {:.3f} s: {}", was.time_s, text(end));
      }
      if (!go_on(was, replayed.front())) {
        return end_early("interrupted");
      }
    }
  }
  compare(frames.atEnd(*scene_));
  if (const std::uint64_t missing = missingAtTheEnd(recording_, last); missing > 0) {
    result.gap = {missing, last_s};
  }
  return result;
}

}  // namespace haptolith

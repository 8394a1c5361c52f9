#include "teleop/robot_lead.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/identify/training/training_file.h"
#include "haptolith/recording/recording_format.h"

namespace haptolith {

namespace {

constexpr double kInSoil_n = 0.2;  ///< force on the hand above which the tool is not in the air

/// Returns the height of the surface, from a snapshot, because a running loop owns its bed.
double surfaceOf(const Session& session) {
  const BedParameters& bed = session.shown().bed;
  return session.loopTicks() == 0 ? meanSurfaceHeight(session.scene().bed())
                                  : meanSurfaceHeight({bed.soil.radius_m, session.snapshot().position, {}}, bed);
}

}  // namespace

RobotLead::RobotLead(const Session& session, const std::string& to, const EndOptions& options, const Likening& likening)
    : end_(to, options, surfaceOf(session), session.shown().loop.tick_s),
      likening_(likening),
      tick_s_(session.shown().loop.tick_s) {
  if (likening_.strength) {
    begin(session.shown());
  }
}

void RobotLead::begin(const SceneFile& model) {
  soil_ = model.bed.soil;
  tool_friction_ = model.tool.friction;
  learning_.reset();
  if (canLearn(model)) {
    learning_.emplace(model, StrengthMap(probeTraining().runs), Work::kBeside);
  }
}

/// Records a packet. A recording may begin before or after the teleoperation, so commands are numbered by its ticks.
template <class Told>
void RobotLead::record(const Told& told, SessionRecording& recording) const {
  const std::optional<double> begun_s = recording.begun();
  if (!begun_s || !first_s_) {
    return;
  }
  auto row = rowOf(told);
  const auto number = static_cast<std::int64_t>(row.command) + std::llround((*first_s_ - *begun_s) / tick_s_);
  if (number > 0) {
    row.command = static_cast<std::uint64_t>(number);
    recording.add(row);
  }
}

void RobotLead::follow(Session& session, std::span<const TickRecord> ticks, SessionRecording& recording,
                       const RobotListener& also) {
  end_.follow(ticks);
  if (!ticks.empty()) {
    first_s_ = first_s_.value_or(ticks.front().time_s);
    in_air_ = ticks.back().rendered.wrench.force_n.norm() < kInSoil_n;
    time_s_ = ticks.back().time_s;
  }
  end_.receive({.report =
                    [&](const RobotReport& report, const std::optional<Vec3>& displayed_n) {
                      if (learning_ && displayed_n) {
                        learning_->met(report, *displayed_n);
                      }
                      record(report, recording);
                      if (also.report) {
                        also.report(report, displayed_n);
                      }
                    },
                .seen =
                    [&](const SitePacket& seen) {
                      record(seen, recording);
                      if (also.seen) {
                        also.seen(seen);
                      }
                    }});
  if (likening_.strength) {
    learn(session, recording);
  }
  if (likening_.surface) {
    mend(session, recording);
  }
}

RobotRow RobotLead::rowOf(const RobotReport& report) const {
  RobotRow row{.heard_s = time_s_,
               .command = report.index + 1,
               .commands = report.ticks,
               .scene_T_tool = report.pose,
               .met = report.met,
               .state = static_cast<std::uint8_t>(end_.news().state.state),
               .reason = static_cast<std::uint8_t>(end_.news().state.reason)};
  row.scene_T_tool.position_m.z() += end_.surface();
  return row;
}

SiteRow RobotLead::rowOf(const SitePacket& seen) const {
  const auto pair = [](std::size_t first, std::size_t second) {
    return std::array{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second)};
  };
  SiteRow row{.heard_s = time_s_,
              .command = seen.index + 1,
              .corner_m = {seen.grid.x_m, seen.grid.y_m},
              .cell_m = seen.grid.cell_m,
              .map = pair(seen.grid.columns, seen.grid.rows),
              .first = pair(seen.column, seen.row),
              .count = pair(seen.columns, seen.rows)};
  row.height_m.fill(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < seen.steps.size(); ++i) {
    if (seen.steps[i] != SitePacket::kNotSeen) {
      row.height_m[i] = static_cast<float>(end_.surface() + seen.steps[i] * SitePacket::kStep_m);
    }
  }
  return row;
}

void RobotLead::mend(Session& session, SessionRecording& recording) {
  constexpr std::uint64_t kLookTicks = 250;
  const BedParameters& bed = session.shown().bed;
  const SceneSnapshot& now = session.snapshot();
  if (now.position.empty() || !canMend(bed)) {
    return;
  }
  ToolParameters tool = session.shown().tool;
  tool.friction = mended_for_.friction;                                     // friction is learned
  if (!mender_ || now.position.size() != grains_ || tool != mended_for_) {  // the bed or the tool may have changed
    mender_.emplace(bed, tool, end_.surface(), Work::kBeside);
    mended_for_ = tool;
    grains_ = now.position.size();
    looked_ = now.ticks;
  }
  if (now.ticks >= looked_ + kLookTicks) {
    looked_ = now.ticks;
    const auto ago = static_cast<std::int64_t>(std::llround((time_s_ - now.time_s) / tick_s_));
    const auto index = std::max<std::int64_t>(0, static_cast<std::int64_t>(end_.ticks()) - ago);
    mender_->look(static_cast<std::uint64_t>(index),
                  seenSoil(session.scene().bed(), bed.soil.radius_m, now.position, now.stones),
                  now.scene_T_tool.position_m, end_.site());
  }
  constexpr int kAtOnce = 4;  // requests at once; the loop handles one per tick, also for other users
  for (int i = 0; i < kAtOnce; ++i) {
    const std::optional<GrainMove> move = mender_->next(in_air_);
    if (!move) {
      return;
    }
    if (!session.moveGrain(*move)) {
      mender_->refused(*move);
      return;
    }
    ++mended_;
    recording.note(kGrainMoveKind, time_s_, grainMoveText(*move));
  }
}

void RobotLead::learn(Session& session, SessionRecording& recording) {
  const SceneFile& shown = session.shown();
  if (shown.bed.soil != soil_ || shown.tool.friction != tool_friction_) {  // the user has changed the soil
    begin(shown);
  }
  const std::optional<SoilAdjustment> step = learning_ ? learning_->at(end_.ticks(), in_air_) : std::nullopt;
  if (step && !session.adjust(*step)) {
    learning_->refused();
  } else if (step) {
    recording.note(kAdjustmentKind, time_s_, adjustmentText(*step));
    soil_ = session.shown().bed.soil;
    tool_friction_ = session.shown().tool.friction;
  }
}

}  // namespace haptolith

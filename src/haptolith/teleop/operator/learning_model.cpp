#include "haptolith/teleop/operator/learning_model.h"

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/core/interpolate.h"

namespace haptolith {

namespace {

constexpr std::uint64_t kStepTicks = 20, kLookTicks = 500;
constexpr std::uint64_t kInAirTicks = 300;  ///< a tool that touches now and then is not in the air
constexpr double kLeastWay_s = 0.5;
constexpr double kFasterInAir = 20;
constexpr double kHardly_n = 1e-6;     ///< negligible cohesion of a contact
constexpr double kLeastForce_n = 0.3;  ///< smallest force of an informative stretch
constexpr double kLeastDraft = 0.7;    ///< fraction of a cut's force that opposes the movement

double mix(double from, double to, double share) {
  return from + share * (to - from);
}

/// Whether a force is that of soil which is cut: it pushes the tool back. Where an edge goes in, soil pushes it up, and
/// grows with strength less than half as much as a cut does: the law of cuts would take that for weaker soil.
bool isOfCut(const Vec3& force_n, const ToolCut& cut) {
  return -force_n.dot(cut.ahead) >= kLeastDraft * force_n.norm();
}

ModelLearner::Prior priorOf(const SoilState& state) {
  return {.middle = state};
}

}  // namespace

SceneFile readyToLearn(SceneFile model) {
  if (!canLearn(model)) {
    throw InvalidParameter("model: soil.friction_model", "icra2021",
                           "contact: the strength of 'icra2021' friction cannot be estimated from digging");
  }
  model.bed.soil.contact_cohesion_n = std::max(kHardly_n, model.bed.soil.contact_cohesion_n);
  return model;
}

LearningModel::LearningModel(const SceneFile& model, const StrengthMap& strengths, Work work)
    : strengths_(strengths),
      tick_s_(model.loop.tick_s),
      tool_(toolSurface(model.tool, model.tool.shape == ToolShape::kJaws ? 0.01 : 0)),
      soil_(model.bed.soil),
      now_{soil_.contact_friction, soil_.contact_cohesion_n, model.tool.friction},
      from_(now_),
      to_(now_),
      before_(now_),
      learner_(priorOf(stateOf(now_)), model.bed.soil.rho0_kg_m3, model.bed.gravity_m_s2.norm()),
      states_{{0, stateOf(now_)}},
      work_(work) {
  learned_ = learner_.at(place_m_);
}

SoilState LearningModel::stateOf(const SoilAdjustment& contacts) const {
  const ShearStrength strength = strengths_.of(contacts.of(soil_));
  return {strength.angle_deg, strength.cohesion_pa, contacts.tool_friction};
}

const SoilState& LearningModel::stateAt(std::uint64_t index) const {
  const auto after = std::ranges::upper_bound(states_, index, {}, &StateFrom::index);
  return after == states_.begin() ? states_.front().state : std::prev(after)->state;
}

void LearningModel::met(const RobotReport& report, const Vec3& displayed_n) {
  if (report.ticks == 0) {
    return;
  }
  newest_ = std::max(newest_, report.index);
  Window& window = windows_[report.index / kStretchTicks];
  if (window.ticks == 0 || report.index < window.first.index) {
    window.first = report;
  }
  if (window.ticks == 0 || report.index > window.last.index) {
    window.last = report;
  }
  window.ticks += report.ticks;
  window.displayed += report.ticks * displayed_n;
  window.met += report.ticks * report.met.force_n;
  // Reports later than another stretch are not waited for.
  while (!windows_.empty() && (windows_.begin()->first + 2) * kStretchTicks <= newest_) {
    close(windows_.begin()->second);
    windows_.erase(windows_.begin());
  }
}

void LearningModel::close(const Window& window) {
  const RobotReport& first = window.first;
  const RobotReport& last = window.last;
  if (window.ticks < kStretchTicks / 2.0 || last.index <= first.index) {
    return;
  }
  const double duration_s = static_cast<double>(last.index - first.index) * tick_s_;
  const Pose middle = interpolate(first.pose, last.pose, 0.5);
  const std::optional<ToolCut> cut = cutOf(tool_, middle, (last.pose.position_m - first.pose.position_m) / duration_s);
  const Vec3 displayed_n = window.displayed / window.ticks, met_n = window.met / window.ticks;
  if (!cut || displayed_n.norm() < kLeastForce_n || met_n.norm() < kLeastForce_n) {
    return;
  }
  if (!isOfCut(displayed_n, *cut) || !isOfCut(met_n, *cut)) {
    return;
  }
  learner_.add({middle.position_m, *cut, stateAt((first.index + last.index) / 2), displayed_n, met_n});
  place_m_ = last.pose.position_m;
  cut_ = *cut;
  has_new_ = true;
}

void LearningModel::setOutFor(const ModelSoil& learned) {
  learned_ = learned;
  from_ = now_;
  const SoilParameters wanted = strengths_.with(soil_, {learned_.state.friction_angle_deg, learned_.state.cohesion_pa});
  to_ = {wanted.contact_friction, std::max(kHardly_n, wanted.contact_cohesion_n), learned_.state.tool_friction};
  const double change =
      std::abs(std::log(learner_.forceAlong(cut_, stateOf(to_)) / learner_.forceAlong(cut_, stateOf(from_))));
  way_s_ = std::max(kLeastWay_s, change / kChange_s);
  gone_s_ = 0;
  ++updates_;
}

std::optional<SoilAdjustment> LearningModel::at(std::uint64_t index, bool in_air) {
  touched_ = in_air ? touched_ : index;
  const bool is_lifted = index > touched_ + kInAirTicks;
  lifted_ = is_lifted ? index : lifted_;
  if (index >= looked_ + kLookTicks && has_new_ && !coming_.valid()) {
    looked_ = index;
    has_new_ = false;
    coming_ = setOut(work_, [learner = learner_, place_m = place_m_] { return learner.at(place_m); });
  }
  if (isThere(coming_)) {
    setOutFor(coming_.get());
  }
  const bool may_change = is_lifted || index > lifted_ + kLongStrokeTicks;
  if (!may_change || index < stepped_ + kStepTicks || gone_s_ == way_s_) {
    return std::nullopt;
  }
  stepped_ = index;
  before_ = now_;
  gone_before_s_ = gone_s_;
  gone_s_ = std::min(way_s_, gone_s_ + kStepTicks * tick_s_ * (is_lifted ? kFasterInAir : 1));
  const double share = gone_s_ / way_s_;
  now_.contact_friction = mix(from_.contact_friction, to_.contact_friction, share);
  now_.contact_cohesion_n = mix(from_.contact_cohesion_n, to_.contact_cohesion_n, share);
  now_.tool_friction = mix(from_.tool_friction, to_.tool_friction, share);
  states_.push_back({index, stateOf(now_)});
  constexpr std::size_t kMostStates = 2000;  // more than half a minute of steps
  if (states_.size() > kMostStates) {
    states_.pop_front();
  }
  return now_;
}

void LearningModel::refused() {
  now_ = before_;
  gone_s_ = gone_before_s_;
  states_.pop_back();
}

}  // namespace haptolith

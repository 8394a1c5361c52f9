#include <array>
#include <cstring>

#include "haptolith/haptics/wrench_filter.h"
#include "haptolith/teleop/bench/operator_hand.h"
#include "haptolith/teleop/bench/simulation_parts.h"
#include "haptolith/teleop/operator/site_map.h"
#include "haptolith/teleop/robot/bilateral_end.h"
#include "haptolith/teleop/robot/site_camera.h"

namespace haptolith::simulation {

namespace {

/// Signal of a bilateral channel in each direction; in simulated time only, so its byte format is internal.
struct Signal {
  std::uint64_t index = 0;
  std::array<double, 7> values{};  ///< position and orientation, or force and torque
  double in_j = 0;

  [[nodiscard]] Packet bytes() const {
    Packet bytes(sizeof *this);
    std::memcpy(bytes.data(), this, sizeof *this);
    return bytes;
  }
  static Signal from(const Packet& bytes) {
    Signal signal;
    std::memcpy(&signal, bytes.data(), sizeof signal);
    return signal;
  }
};

Signal signalOf(std::uint64_t index, const Pose& pose, double in_j) {
  const Quat& q = pose.orientation;
  return {index, {pose.position_m.x(), pose.position_m.y(), pose.position_m.z(), q.w(), q.x(), q.y(), q.z()}, in_j};
}

Pose poseOf(const Signal& signal) {
  const auto& v = signal.values;
  return {{v[0], v[1], v[2]}, Quat(v[3], v[4], v[5], v[6])};
}

Signal signalOf(std::uint64_t index, const Wrench& wrench, double in_j) {
  const Vec3& f = wrench.force_n;
  const Vec3& t = wrench.torque_nm;
  return {index, {f.x(), f.y(), f.z(), t.x(), t.y(), t.z(), 0}, in_j};
}

Wrench wrenchOf(const Signal& signal) {
  const auto& v = signal.values;
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

/// The robot at the end of a bilateral channel: its arm goes where the channel says, as far as that is paid for, and
/// makes up for what it stayed behind whenever there is energy for it.
class BilateralRobot {
 public:
  BilateralRobot(const RobotParameters& parameters, Site& site, const Pose& home, std::uint64_t period,
                 double cutoff_hz, double tick_s)
      : parameters_(parameters),
        site_(site),
        tick_s_(tick_s),
        period_(static_cast<double>(period)),
        sensor_(parameters.sensor, site.scene.bed().parameters().gravity_m_s2, tick_s),
        filter_(cutoff_hz, tick_s),
        end_(tick_s, parameters.arm.lever_m),
        commanded_(home),
        target_(home),
        wanted_{home, {}},
        tool_{home, {}} {
    validate(parameters, tick_s);
    HandState at_home{tool_, 1};
    at_home.pose.position_m.z() += site_.surface_m;
    site_.scene.placeTool(at_home);
    while (!sensor_.tared()) {
      met_ = sensor_.read({}, tool_);
    }
  }

  void take(const Signal& signal) {
    if (signal.index <= index_to_) {
      return;
    }
    index_from_ = index();
    index_to_ = signal.index;
    since_ = 0;
    target_ = poseOf(signal);
    end_.hear(signal.in_j);
  }

  void tick() {
    // The channel's own course: straight to the newest place, in the time until the next is expected.
    const double left = std::max(1.0, period_ - since_);
    since_ += 1;
    Twist twist{(target_.position_m - commanded_.position_m) / (left * tick_s_),
                rotationBetween(commanded_.orientation, target_.orientation) / (left * tick_s_)};
    commanded_.position_m += tick_s_ * twist.linear_m_s;
    commanded_.orientation = turnedBy(tick_s_ * twist.angular_rad_s, commanded_.orientation);
    twist.linear_m_s = (commanded_.position_m - wanted_.pose.position_m) / tick_s_;
    twist.linear_m_s = atMost(parameters_.max_speed_m_s, twist.linear_m_s);
    twist.angular_rad_s = rotationBetween(wanted_.pose.orientation, commanded_.orientation) / tick_s_;
    wanted_.twist = end_.brake(twist, smooth_);
    wanted_.pose.position_m += tick_s_ * wanted_.twist.linear_m_s;
    wanted_.pose.orientation = turnedBy(tick_s_ * wanted_.twist.angular_rad_s, wanted_.pose.orientation);
    (void)moveArm(parameters_.arm, wanted_, site_.scene.soilWrench(), parameters_.max_force_n, tick_s_, tool_);
    HandState hand{tool_, 1};
    hand.pose.position_m.z() += site_.surface_m;
    if (site_.scene.tick(hand) != StepStatus::kOk) {
      throw Failure("the robot's bed is not finite");
    }
    met_ = sensor_.read(site_.scene.soilWrench(), tool_);
    smooth_ = filter_.step(met_);
  }

  [[nodiscard]] double index() const noexcept {
    const double share = std::min(1.0, since_ / period_);
    return index_from_ + share * (static_cast<double>(index_to_) - index_from_);
  }
  [[nodiscard]] bool follows() const noexcept { return index_to_ > 0; }
  [[nodiscard]] const Movement& tool() const noexcept { return tool_; }
  [[nodiscard]] const Wrench& met() const noexcept { return met_; }
  /// Part sent over the channel: without the sensor's noise, which would cost energy in the air.
  [[nodiscard]] const Wrench& smooth() const noexcept { return smooth_; }
  [[nodiscard]] const BilateralEnd& end() const noexcept { return end_; }

 private:
  RobotParameters parameters_;
  Site& site_;
  double tick_s_, period_;
  ForceSensor sensor_;
  WrenchFilter filter_;
  BilateralEnd end_;
  double since_ = 0, index_from_ = 0;  ///< ticks since the newest place came; index then
  std::uint64_t index_to_ = 0;
  Pose commanded_, target_;
  Movement wanted_, tool_;
  Wrench met_, smooth_;
};

}  // namespace

TeleopResult simulateBilateral(const TeleopSetup& setup, const TeleopProgress& progress) {
  TeleopResult result;
  const Course course(setup, setup.bilateral_period_s, progress);
  const double tick_s = course.time(1);
  OperatorHand hand(setup, 0);
  BilateralEnd end(tick_s, setup.robot.arm.lever_m);
  Site site(setup.site);
  BilateralRobot robot(setup.robot, site, VirtualHand(handAbove(setup.model, 0), tick_s).read().pose, course.period(),
                       setup.model.loop.filter_cutoff_hz, tick_s);
  Link up(setup.up);
  Link down(setup.down);
  OperatorLog log;
  Wrench newest;
  std::uint64_t newest_signal = 0;
  SiteCamera camera(site.scene.bed(), site.surface_m, setup.sending.site_period_s, tick_s);
  SiteMap known_site;
  double reported = 0;
  Mean behind;
  Vec3 met_sum = Vec3::Zero();
  Share followed;

  for (std::uint64_t tick = 0; tick < course.ticks(); ++tick) {
    const double now_s = course.time(tick);
    result.duration_s = now_s;
    course.look(tick);
    if (hand.hasTask()) {
      hand.look({now_s, tick, {}, newest.force_n.norm(), newest.force_n.norm(), newest_signal, &known_site});
      if (hand.done()) {
        break;
      }
    }
    const DeviceInput input = hand.read();
    hand.came(input.pose);
    if (input.state != DeviceState::kLive) {
      throw Failure("the operator's motion has ended");
    }
    while (const std::optional<Link::Arrival> arrived = down.receive(now_s)) {
      if (const std::optional<SitePacket> seen = parseSite(arrived->packet)) {
        known_site.take(*seen);
        continue;
      }
      const Signal signal = Signal::from(arrived->packet);
      if (signal.index >= newest_signal) {
        newest_signal = signal.index;
        newest = wrenchOf(signal);
        end.hear(signal.in_j);
      }
    }
    const Wrench within = limited(newest, hand.limits());
    const Wrench shown = end.damp(within, input.twist);
    const Wrench unlimited{newest.force_n + shown.force_n - within.force_n,
                           newest.torque_nm + shown.torque_nm - within.torque_nm};
    hand.write({shown, 0});
    log.add(tick, {{input.pose, input.twist}, input.gripper_open}, shown, unlimited);
    if (tick % course.period() == 0) {
      up.send(now_s, signalOf(tick + 1, input.pose, end.in()).bytes());
    }

    while (const std::optional<Link::Arrival> arrived = up.receive(now_s)) {
      robot.take(Signal::from(arrived->packet));
    }
    robot.tick();
    if (std::optional<SitePacket> seen = camera.tick(static_cast<std::uint64_t>(robot.index()))) {
      seen->robot_connection = 1;
      down.send(now_s, bytesOf(*seen));
    }
    followed.tick(robot.follows());
    met_sum += robot.met().force_n;
    if (robot.follows()) {
      const double index = std::max(0.0, robot.index() - 1);
      enter((robot.tool().pose.position_m - log.toolAt(index)).norm(), site.scene.soilWrench(), result);
      if (tick % course.period() == 0) {
        const auto from = static_cast<std::uint64_t>(reported);
        const auto to = static_cast<std::uint64_t>(index);
        if (const auto displayed_n = log.displayed().mean(from, to)) {
          result.agreement.add(course.time(to), course.time(to - from), *displayed_n,
                               met_sum / static_cast<double>(course.period()));
        }
        reported = index;
      }
    }
    if (tick % course.period() == 0) {
      met_sum = Vec3::Zero();
      down.send(now_s, signalOf(static_cast<std::uint64_t>(robot.index()), robot.smooth(), robot.end().in()).bytes());
    }
    behind.tick(newest_signal > 0, now_s - course.time(newest_signal));
  }
  result.task = hand.result();
  result.given_j = log.mostGiven();
  result.behind_s = behind.mean();
  result.followed_share = followed.value();
  result.taken_back_j = end.dissipated() + robot.end().dissipated();
  result.up = up.counts();
  result.down = down.counts();
  return result;
}

}  // namespace haptolith::simulation

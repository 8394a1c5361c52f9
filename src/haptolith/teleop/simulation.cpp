#include "haptolith/teleop/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "haptolith/bed/surface_height.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/haptic_loop.h"
#include "haptolith/haptics/wrench_filter.h"
#include "haptolith/teleop/passive_end.h"
#include "haptolith/teleop/teleop_packet.h"

namespace haptolith {

namespace {

constexpr std::uint32_t kSession = 1;
constexpr double kInSoil_n = 0.2;  // more than this on the tool, and it is not in the air
constexpr std::uint64_t kLookEvery = 250;

/// A bed with its tool, and where its soil's surface is.
struct Site {
  explicit Site(const Scenario& scenario)
      : scene(scenario.bed, scenario.tool), surface_m(meanSurfaceHeight(scene.bed())) {}

  Scene scene;
  double surface_m;
};

/// The hand of a scene, above a surface.
HandParameters handAbove(const Scenario& scenario, double surface_m) {
  HandParameters hand = scenario.hand;
  hand.surface_m = surface_m;
  return hand;
}

/// What the hand has been given by the forces that it was shown, each until the next.
class EnergyGiven {
 public:
  void tick(const Pose& hand, const Wrench& shown) noexcept {
    if (known_) {
      given_j_ += shown_.force_n.dot(hand.position_m - last_.position_m) +
                  shown_.torque_nm.dot(rotationBetween(last_.orientation, hand.orientation));
      most_j_ = std::max(most_j_, given_j_);
    }
    last_ = hand;
    shown_ = shown;
    known_ = true;
  }
  [[nodiscard]] double most() const noexcept { return most_j_; }

 private:
  bool known_ = false;
  Pose last_;
  Wrench shown_;
  double given_j_ = 0, most_j_ = 0;
};

/// Where the operator had the tool in the last half minute, and what was felt.
class OperatorLog {
 public:
  /// @param unlimited  what the hand would feel of a device without limits.
  void add(std::uint64_t index, const HandState& tool, const Wrench& felt, const Wrench& unlimited) {
    tools_[index % FeltTrack::kTicks] = tool.pose.position_m;
    felt_.add(index, unlimited.force_n);
    energy_.tick(tool.pose, felt);
  }
  [[nodiscard]] Vec3 toolAt(double index) const {
    const auto before = static_cast<std::uint64_t>(std::floor(index));
    const double share = index - std::floor(index);
    const Vec3& from = tools_[before % FeltTrack::kTicks];
    return share == 0 ? from : Vec3(from + share * (tools_[(before + 1) % FeltTrack::kTicks] - from));
  }
  [[nodiscard]] const FeltTrack& felt() const noexcept { return felt_; }
  [[nodiscard]] double mostGiven() const noexcept { return energy_.most(); }

 private:
  std::vector<Vec3> tools_ = std::vector<Vec3>(FeltTrack::kTicks, Vec3::Zero());
  FeltTrack felt_;
  EnergyGiven energy_;
};

void enter(double distance_m, const Wrench& soil, TeleopResult& result) noexcept {
  double& largest_m = soil.force_n.norm() > kInSoil_n ? result.soil_m : result.free_m;
  largest_m = std::max(largest_m, distance_m);
}

/// Share of the time since something first happened.
class Share {
 public:
  void tick(bool happens) noexcept {
    begun_ = begun_ || happens;
    ticks_ += begun_ ? 1 : 0;
    happened_ += happens ? 1 : 0;
  }
  [[nodiscard]] double value() const noexcept { return ticks_ == 0 ? 0 : happened_ / ticks_; }

 private:
  bool begun_ = false;
  double ticks_ = 0, happened_ = 0;
};

class Mean {
 public:
  void tick(bool counts, double value) noexcept {
    sum_ += counts ? value : 0;
    count_ += counts ? 1 : 0;
  }
  [[nodiscard]] double mean() const noexcept { return count_ == 0 ? 0 : sum_ / count_; }

 private:
  double sum_ = 0, count_ = 0;
};

/// Ticks of a run, and who watches them.
class Course {
 public:
  Course(const TeleopSetup& setup, double period_s, const TeleopProgress& progress)
      : progress_(progress),
        tick_s_(setup.model.loop.tick_s),
        ticks_(static_cast<std::uint64_t>(std::llround(setup.duration_s / tick_s_))),
        period_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(period_s / tick_s_)))) {}

  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] std::uint64_t period() const noexcept { return period_; }
  [[nodiscard]] double time(std::uint64_t tick) const noexcept { return static_cast<double>(tick) * tick_s_; }
  /// @throws Failure when nobody wants the run any more.
  void look(std::uint64_t tick) const {
    if (progress_ && tick % kLookEvery == 0 && !progress_(static_cast<double>(tick) / static_cast<double>(ticks_))) {
      throw Failure("interrupted");
    }
  }

 private:
  const TeleopProgress& progress_;
  double tick_s_;
  std::uint64_t ticks_, period_;
};

/// A hand that feels a bed of its own.
class ModelOperator {
 public:
  explicit ModelOperator(const Scenario& scenario)
      : site_(scenario),
        hand_(handAbove(scenario, site_.surface_m), scenario.loop.tick_s),
        loop_(site_.scene, hand_, unpaced(scenario.loop), true, handlingOf(scenario, site_.surface_m)) {}

  /// @throws Failure when there is no hand any more.
  void tick() {
    if (const LoopEnd end = loop_.tick(); end != LoopEnd::kRunning) {
      throw Failure(fmt::format("the operator's run ended: {}", text(end)));
    }
    records_.clear();
    loop_.takeRecords(records_);
    const TickRecord& tick = records_.back();
    tool_ = {{tick.scene_T_tool, tick.device.twist}, tick.device.gripper_open};
    tool_.pose.position_m.z() -= site_.surface_m;
    felt_ = tick.felt.wrench;
    unlimited_ = tick.rendered.wrench;
  }
  [[nodiscard]] const HandState& tool() const noexcept { return tool_; }
  [[nodiscard]] const Wrench& felt() const noexcept { return felt_; }
  [[nodiscard]] const Wrench& unlimited() const noexcept { return unlimited_; }

 private:
  static LoopParameters unpaced(LoopParameters loop) {
    loop.paced = false;
    return loop;
  }

  Site site_;
  VirtualHand hand_;
  HapticLoop loop_;
  std::vector<TickRecord> records_;
  HandState tool_;
  Wrench felt_, unlimited_;
};

TeleopResult simulateModel(const TeleopSetup& setup, const TeleopProgress& progress) {
  TeleopResult result;
  const Course course(setup, setup.sending.period_s, progress);
  ModelOperator hand(setup.model);
  Site site(setup.site);
  HandParameters home = handAbove(setup.model, 0);
  Robot robot(setup.robot, site.scene, site.surface_m, VirtualHand(home, course.time(1)).read().pose);
  Link up(setup.up);
  Link down(setup.down);
  OperatorLog log;
  KeyHistory<CommandKey> commands(commandLags(setup.sending.period_s, setup.sending.command_keys));
  KeyHistory<RobotReport> reports(reportLags(setup.sending.report_keys));
  CommandPacket command{.session = kSession};
  StatePacket state{.robot_session = kSession};
  std::uint64_t newest_report = 0;
  std::set<std::uint64_t> known;  // reports by their index: others may overtake them, and all come more than once
  double robot_ticks = 0;
  Mean behind;
  std::uint64_t robot_tick = 0;
  Share followed;

  for (std::uint64_t tick = 0; tick < course.ticks(); ++tick) {
    const double now_s = course.time(tick);
    course.look(tick);
    hand.tick();
    log.add(tick, hand.tool(), hand.felt(), hand.unlimited());
    if (tick % course.period() == 0) {
      command.keys = commands.add({tick, hand.tool()});
      ++command.number;
      up.send(now_s, bytesOf(command));
    }

    while (const std::optional<Link::Arrival> arrived = up.receive(now_s)) {
      if (const std::optional<CommandPacket> packet = parseCommand(arrived->packet)) {
        robot.take(packet->session, packet->held, packet->keys);
        state.operator_session = packet->session;
        state.newest = robot.newest();
      }
    }
    for (robot_ticks += 1 + setup.robot_clock_share; robot_ticks >= 1; robot_ticks -= 1) {
      robot.tick();
      followed.tick(robot.state() == RobotState::kFollowing);
      if (robot.state() == RobotState::kFollowing) {
        enter((robot.tool().pose.position_m - log.toolAt(robot.index())).norm(), site.scene.felt().wrench, result);
      }
      if (robot_tick++ % course.period() == 0) {
        // Reports of one command would stand one upon the other: a robot that waits has nothing new to tell.
        const RobotReport report = robot.report();
        if (state.reports.empty() || report.index > state.reports.back().index) {
          state.reports = reports.add(report);
        }
        state.state = robot.state();
        state.reason = robot.reason();
        ++state.number;
        down.send(now_s, bytesOf(state));
      }
    }

    while (const std::optional<Link::Arrival> arrived = down.receive(now_s)) {
      const std::optional<StatePacket> packet = parseState(arrived->packet);
      for (const RobotReport& report : packet ? packet->reports : std::vector<RobotReport>()) {
        if (!known.insert(report.index).second) {
          continue;
        }
        newest_report = std::max(newest_report, report.index);
        if (const auto felt_n = log.felt().mean(report.index - report.ticks, report.index)) {
          result.agreement.add(course.time(report.index), course.time(report.ticks), *felt_n, report.met.force_n);
        }
      }
    }
    behind.tick(newest_report > 0, now_s - course.time(newest_report));
  }
  result.given_j = log.mostGiven();
  result.behind_s = behind.mean();
  result.followed_share = followed.value();
  result.ran_out = robot.ranOut();
  result.stops = robot.stops();
  result.last_stop = robot.reason();
  result.up = up.counts();
  result.down = down.counts();
  return result;
}

/// What a bilateral channel carries each way; in simulated time alone, so that its bytes are its own.
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
    (void)moveArm(parameters_.arm, wanted_, site_.scene.felt().wrench, parameters_.max_force_n, tick_s_, tool_);
    HandState hand{tool_, 1};
    hand.pose.position_m.z() += site_.surface_m;
    if (site_.scene.tick(hand) != StepStatus::kOk) {
      throw Failure("the robot's bed no longer makes sense");
    }
    met_ = sensor_.read(site_.scene.felt().wrench, tool_);
    smooth_ = filter_.step(met_);
  }

  [[nodiscard]] double index() const noexcept {
    const double share = std::min(1.0, since_ / period_);
    return index_from_ + share * (static_cast<double>(index_to_) - index_from_);
  }
  [[nodiscard]] bool follows() const noexcept { return index_to_ > 0; }
  [[nodiscard]] const Movement& tool() const noexcept { return tool_; }
  [[nodiscard]] const Wrench& met() const noexcept { return met_; }
  /// What the channel carries of it: without the sensor's noise, which would cost energy in the air.
  [[nodiscard]] const Wrench& smooth() const noexcept { return smooth_; }
  [[nodiscard]] const PassiveEnd& end() const noexcept { return end_; }

 private:
  RobotParameters parameters_;
  Site& site_;
  double tick_s_, period_;
  ForceSensor sensor_;
  WrenchFilter filter_;
  PassiveEnd end_;
  double since_ = 0, index_from_ = 0;  ///< ticks since the newest place came; index then
  std::uint64_t index_to_ = 0;
  Pose commanded_, target_;
  Movement wanted_, tool_;
  Wrench met_, smooth_;
};

TeleopResult simulateBilateral(const TeleopSetup& setup, const TeleopProgress& progress) {
  TeleopResult result;
  const Course course(setup, setup.bilateral_period_s, progress);
  const double tick_s = course.time(1);
  VirtualHand hand(handAbove(setup.model, 0), tick_s);
  PassiveEnd end(tick_s, setup.robot.arm.lever_m);
  Site site(setup.site);
  BilateralRobot robot(setup.robot, site, VirtualHand(handAbove(setup.model, 0), tick_s).read().pose, course.period(),
                       setup.model.loop.filter_cutoff_hz, tick_s);
  Link up(setup.up);
  Link down(setup.down);
  OperatorLog log;
  Wrench newest;
  std::uint64_t newest_signal = 0;
  double reported = 0;
  Mean behind;
  Vec3 met_sum = Vec3::Zero();
  Share followed;

  for (std::uint64_t tick = 0; tick < course.ticks(); ++tick) {
    const double now_s = course.time(tick);
    course.look(tick);
    const DeviceInput input = hand.read();
    if (input.state != DeviceState::kLive) {
      throw Failure("the operator's hand has come to its end");
    }
    while (const std::optional<Link::Arrival> arrived = down.receive(now_s)) {
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
    followed.tick(robot.follows());
    met_sum += robot.met().force_n;
    if (robot.follows()) {
      const double index = std::max(0.0, robot.index() - 1);
      enter((robot.tool().pose.position_m - log.toolAt(index)).norm(), site.scene.felt().wrench, result);
      if (tick % course.period() == 0) {
        const auto from = static_cast<std::uint64_t>(reported);
        const auto to = static_cast<std::uint64_t>(index);
        if (const auto felt_n = log.felt().mean(from, to)) {
          result.agreement.add(course.time(to), course.time(to - from), *felt_n,
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
  result.given_j = log.mostGiven();
  result.behind_s = behind.mean();
  result.followed_share = followed.value();
  result.taken_back_j = end.dissipated() + robot.end().dissipated();
  result.up = up.counts();
  result.down = down.counts();
  return result;
}

}  // namespace

TeleopResult simulateTeleop(const TeleopSetup& setup, const TeleopProgress& progress) {
  requireInRange("duration_s", setup.duration_s, TeleopRanges::duration_s);
  requireInRange("period_s", setup.sending.period_s, TeleopRanges::period_s);
  requireInRange("bilateral_period_s", setup.bilateral_period_s, TeleopRanges::period_s);
  requireInRange("robot_clock_share", setup.robot_clock_share, TeleopRanges::clock_share);
  if (setup.model.loop.tick_s != setup.site.loop.tick_s) {
    throw InvalidParameter("site.loop.tick_s", fmt::format("{:g}", setup.site.loop.tick_s),
                           fmt::format("the model's {:g}", setup.model.loop.tick_s));
  }
  return setup.feedback == Feedback::kModel ? simulateModel(setup, progress) : simulateBilateral(setup, progress);
}

}  // namespace haptolith

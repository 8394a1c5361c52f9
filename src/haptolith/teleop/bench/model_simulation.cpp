#include <fmt/format.h>

#include <array>
#include <deque>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/teleop/bench/operator_hand.h"
#include "haptolith/teleop/bench/simulation_parts.h"
#include "haptolith/teleop/link/teleop_packet.h"
#include "haptolith/teleop/operator/site_map.h"
#include "haptolith/teleop/operator/surface_mender.h"
#include "haptolith/teleop/operator/surface_watch.h"
#include "haptolith/teleop/robot/site_camera.h"

namespace haptolith::simulation {

namespace {

constexpr std::uint32_t kConnection = 1;
constexpr double kSurfaceLate_s = 1;  ///< beyond the round trip, until a change of the site is known

/// What updates of a model's soil do to the force that no hand has caused: for a tenth of a second after an update
/// began a copy of the scene, which is not updated, has its tool moved likewise.
class UpdateWatch {
 public:
  explicit UpdateWatch(double tick_s) : tick_s_(tick_s) {}

  /// Before the first step of an update.
  void begin(const Scene& scene) {
    if (!other_) {
      other_.emplace(scene.bed().parameters(), scene.tool(), scene.save());
      ticks_ = 0;
      apart_n_ = unchanged_n_ = Vec3::Zero();
    }
  }
  /// After each tick of the scene.
  void tick(const Scene& scene, const HandState& hand) {
    constexpr int kWatched = 100, kCompared = 20;
    if (!other_) {
      return;
    }
    (void)other_->tick(hand);
    pushed_j_ += pushed(scene.soilWrench(), hand.twist) - pushed(other_->soilWrench(), hand.twist);
    most_pushed_j_ = std::max(most_pushed_j_, pushed_j_);
    if (++ticks_ > kWatched - kCompared) {
      apart_n_ += (scene.soilWrench().force_n - other_->soilWrench().force_n) / kCompared;
      unchanged_n_ += other_->soilWrench().force_n / kCompared;
    }
    if (ticks_ == kWatched) {
      changes_.push_back(apart_n_.norm() / std::max(0.1, 0.07 * unchanged_n_.norm()));
      other_.reset();
    }
  }
  /// A share of all changes is no larger, over what is hardly felt: 0.1 N, or 7 % of the force. 0: none was seen.
  [[nodiscard]] double change(double share) const {
    std::vector<double> sorted = changes_;
    std::ranges::sort(sorted);
    return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
  /// Energy that soil pushed into the hand, more than it would have without updates: at most, up to any time.
  [[nodiscard]] double pushed() const noexcept { return most_pushed_j_; }

 private:
  [[nodiscard]] double pushed(const Wrench& displayed, const Twist& twist) const noexcept {
    return tick_s_ *
           std::max(0.0, displayed.force_n.dot(twist.linear_m_s) + displayed.torque_nm.dot(twist.angular_rad_s));
  }

  std::optional<Scene> other_;
  int ticks_ = 0;
  Vec3 apart_n_, unchanged_n_;
  std::vector<double> changes_;
  double tick_s_;
  double pushed_j_ = 0, most_pushed_j_ = 0;
};

/// A hand that feels a bed of its own.
class ModelOperator {
 public:
  explicit ModelOperator(const TeleopSetup& setup)
      : site_(setup.model),
        hand_(setup, site_.surface_m),
        loop_(site_.scene, hand_, unpaced(setup.model.loop), true, handlingOf(setup.model, site_.surface_m)),
        watch_(setup.model.loop.tick_s) {
    if (setup.feedback == Feedback::kNone) {
      loop_.ask(request::SetContact{false});
    }
  }

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
    hand_.came(tool_.pose);
    displayed_ = tick.sent.wrench;
    unlimited_ = tick.rendered.wrench;
    watch_.tick(site_.scene, {{tick.scene_T_tool, tick.device.twist}, tick.device.gripper_open});
  }
  /// Another soil and tool friction from the next tick on.
  void become(const SoilAdjustment& adjustment) {
    if (!inAir()) {
      watch_.begin(site_.scene);
    }
    const BedParameters& bed = site_.scene.bed().parameters();
    loop_.ask(request::Adjust{SoilLaws(adjustment.of(bed.soil), grainClasses(bed)), adjustment.tool_friction});
  }
  /// A grain lies elsewhere from the next tick on, if it may.
  void move(const GrainMove& move) { loop_.ask(request::MoveGrain{move}); }
  /// Whether it does since the last tick: a bed refuses what is not as it was seen.
  [[nodiscard]] bool hasMoved(const GrainMove& move) const {
    const Float4& at = site_.scene.bed().state().position[move.grain];
    const Vec3 place_m(at.x, at.y, at.z);
    return (place_m - move.to_m).norm() < (place_m - move.from_m).norm();
  }
  [[nodiscard]] const Site& site() const noexcept { return site_; }
  [[nodiscard]] OperatorHand& hand() noexcept { return hand_; }
  /// Of its soil over the surface that it began with.
  [[nodiscard]] std::vector<double> heights(const HeightGrid& grid) const { return site_.heights(grid); }
  [[nodiscard]] bool inAir() const noexcept { return unlimited_.force_n.norm() < kInSoil_n; }
  [[nodiscard]] const UpdateWatch& watch() const noexcept { return watch_; }
  [[nodiscard]] const HandState& tool() const noexcept { return tool_; }
  [[nodiscard]] const Wrench& displayed() const noexcept { return displayed_; }
  [[nodiscard]] const Wrench& unlimited() const noexcept { return unlimited_; }

 private:
  static LoopParameters unpaced(LoopParameters loop) {
    loop.paced = false;
    return loop;
  }

  Site site_;
  OperatorHand hand_;
  HapticLoop loop_;
  std::vector<TickRecord> records_;
  HandState tool_;
  Wrench displayed_, unlimited_;
  UpdateWatch watch_;
};

}  // namespace

TeleopResult simulateModel(const TeleopSetup& setup, const TeleopProgress& progress) {
  TeleopResult result;
  const Course course(setup, setup.sending.period_s, progress);
  const bool feels = setup.feedback == Feedback::kModel;
  ModelOperator hand(setup);
  std::optional<LearningModel> learning;
  if (setup.learns) {
    learning.emplace(setup.model, *setup.learns);
  }
  std::optional<SurfaceMender> mender;
  if (setup.mends) {
    const Bed& bed = hand.site().scene.bed();
    mender.emplace(bed.parameters(), setup.model.tool, hand.site().surface_m);
  }
  Site site(setup.site);
  HandParameters home = handAbove(setup.model, 0);
  Robot robot(setup.robot, site.scene, site.surface_m, VirtualHand(home, course.time(1)).read().pose);
  SiteCamera camera(site.scene.bed(), site.surface_m, setup.sending.site_period_s, course.time(1));
  SiteMap known_site;
  SurfaceWatch surface(setup.up.delay_s + setup.down.delay_s + kSurfaceLate_s);
  std::deque<std::vector<double>> model_heights;  // at every 250th command that the robot has not come to yet
  Link up(setup.up);
  Link down(setup.down);
  OperatorLog log;
  KeyframeHistory<Keyframe> commands(commandLags(setup.sending.period_s, setup.sending.command_keyframes));
  KeyframeHistory<RobotReport> reports(reportLags(setup.sending.report_keys));
  CommandPacket command{.connection = kConnection};
  StatePacket state{.robot_connection = kConnection};
  std::uint64_t newest_report = 0;
  MetLast met;
  std::set<std::uint64_t> known;  // reports by their index: others may overtake them, and all come more than once
  double robot_ticks = 0;
  std::uint64_t next_compared = 0, looks = 0;
  Mean behind;
  std::uint64_t robot_tick = 0;
  Share followed;

  for (std::uint64_t tick = 0; tick < course.ticks(); ++tick) {
    const double now_s = course.time(tick);
    result.duration_s = now_s;
    course.look(tick);
    if (const std::optional<SoilAdjustment> step = learning ? learning->at(tick, hand.inAir()) : std::nullopt) {
      hand.become(*step);
    }
    if (mender && tick % kLookEvery == 0) {
      const Scene& model = hand.site().scene;
      mender->look(tick, seenSoil(model.bed()), model.toolPose().position_m, known_site);
    }
    const std::optional<GrainMove> move = mender ? mender->next(hand.inAir()) : std::nullopt;
    if (move) {
      hand.move(*move);
    }
    if (tick % kLookEvery == 0) {
      model_heights.push_back(hand.heights(camera.grid()));
    }
    if (hand.hand().hasTask()) {
      TaskSight sight{now_s,       tick,      {},         feels ? hand.unlimited().force_n.norm() : met.force_n,
                      met.force_n, met.index, &known_site};
      if (feels) {
        sight.own = [&](const HeightGrid& grid) { return hand.heights(grid); };
      }
      hand.hand().look(std::move(sight));
      if (hand.hand().done()) {
        break;
      }
    }
    hand.tick();
    result.mended += move && hand.hasMoved(*move) ? 1 : 0;
    log.add(tick, hand.tool(), hand.displayed(), hand.unlimited());
    if (tick % course.period() == 0) {
      command.keyframes = commands.add({tick, hand.tool()});
      command.held = hand.hand().holds();
      ++command.number;
      up.send(now_s, bytesOf(command));
    }

    while (const std::optional<Link::Arrival> arrived = up.receive(now_s)) {
      if (const std::optional<CommandPacket> packet = parseCommand(arrived->packet)) {
        robot.take(packet->connection, packet->held, packet->keyframes);
        state.operator_connection = packet->connection;
        state.newest = robot.newest();
      }
    }
    for (robot_ticks += 1 + setup.robot_clock_share; robot_ticks >= 1; robot_ticks -= 1) {
      robot.tick();
      followed.tick(robot.state() == RobotState::kFollowing);
      if (robot.state() == RobotState::kFollowing) {
        enter((robot.tool().pose.position_m - log.toolAt(robot.index())).norm(), site.scene.soilWrench(), result);
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
      if (!model_heights.empty() && robot.index() >= static_cast<double>(next_compared)) {
        surface.compare(site.heights(camera.grid()), model_heights.front());
        model_heights.pop_front();
        next_compared += kLookEvery;
      }
      if (std::optional<SitePacket> seen = camera.tick(static_cast<std::uint64_t>(robot.index()))) {
        seen->robot_connection = kConnection;
        down.send(now_s, bytesOf(*seen));
      }
    }

    while (const std::optional<Link::Arrival> arrived = down.receive(now_s)) {
      if (const std::optional<SitePacket> seen = parseSite(arrived->packet)) {
        known_site.take(*seen);
        continue;
      }
      const std::optional<StatePacket> packet = parseState(arrived->packet);
      for (const RobotReport& report : packet ? packet->reports : std::vector<RobotReport>()) {
        if (!known.insert(report.index).second) {
          continue;
        }
        newest_report = std::max(newest_report, report.index);
        met = report.index >= met.index ? MetLast{report.met.force_n.norm(), report.index} : met;
        if (const auto displayed_n = log.displayed().mean(report.index - report.ticks, report.index)) {
          result.agreement.add(course.time(report.index), course.time(report.ticks), *displayed_n, report.met.force_n);
          if (learning) {
            learning->met(report, *displayed_n);
          }
        }
      }
    }
    if (camera.looks() != looks) {
      looks = camera.looks();
      surface.look(now_s, camera.heights(), known_site);
    }
    behind.tick(newest_report > 0, now_s - course.time(newest_report));
  }
  result.given_j = log.mostGiven();
  result.behind_s = behind.mean();
  result.followed_share = followed.value();
  result.ran_out = robot.ranOut();
  result.stops = robot.stops();
  result.last_stop = robot.reason();
  result.task = hand.hand().result();
  result.known_surface_m = surface.known();
  result.apart_surface_m = surface.apart();
  result.up = up.counts();
  result.down = down.counts();
  if (learning) {
    result.learned = learning->learned();
    result.updates = learning->updates();
    constexpr double kMost = 0.95;
    result.update_jump = hand.watch().change(1);
    result.most_update_jumps = hand.watch().change(kMost);
    result.update_j = hand.watch().pushed();
  }
  return result;
}

}  // namespace haptolith::simulation

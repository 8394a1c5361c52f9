#include <fmt/format.h>

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

/// Changes of force caused by updates of the model's soil, not by the hand: for a tenth of a second after an update
/// began, an unchanged copy of the scene has its tool moved along the same path.
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
  /// Quantile `share` of all changes, over the detection threshold: 0.1 N, or 7 % of the force. 0: no change.
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

/// A hand in a local bed.
class ModelOperator {
 public:
  explicit ModelOperator(const TeleopSetup& setup)
      : site_(setup.model),
        hand_(setup, site_.surface_m),
        loop_(site_.scene, hand_, asFastAsPossible(setup.model.loop), true, handlingOf(setup.model, site_.surface_m)),
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
  /// Heights of its soil over the initial surface.
  [[nodiscard]] std::vector<double> heights(const HeightGrid& grid) const { return site_.heights(grid); }
  [[nodiscard]] bool inAir() const noexcept { return unlimited_.force_n.norm() < kInSoil_n; }
  [[nodiscard]] const UpdateWatch& watch() const noexcept { return watch_; }
  [[nodiscard]] const HandState& tool() const noexcept { return tool_; }
  [[nodiscard]] const Wrench& displayed() const noexcept { return displayed_; }
  [[nodiscard]] const Wrench& unlimited() const noexcept { return unlimited_; }

 private:
  static LoopParameters asFastAsPossible(LoopParameters loop) {
    loop.real_time = false;
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

/// An operator with a model of the soil, a robot in its own, and the link between them.
class ModelSimulation {
 public:
  ModelSimulation(const TeleopSetup& setup, const TeleopProgress& progress)
      : setup_(setup),
        course_(setup, setup.sending.period_s, progress),
        hand_(setup),
        site_(setup.site),
        robot_(setup.robot, site_.scene, site_.surface_m,
               VirtualHand(handAbove(setup.model, 0), course_.time(1)).read().pose),
        camera_(site_.scene.bed(), site_.surface_m, setup.sending.site_period_s, course_.time(1)),
        surface_(setup.up.delay_s + setup.down.delay_s + kSurfaceLate_s),
        up_(setup.up),
        down_(setup.down),
        commands_(commandLags(setup.sending.period_s, setup.sending.command_keyframes)),
        reports_(reportLags(setup.sending.report_keys)) {
    if (setup.learns) {
      learning_.emplace(setup.model, *setup.learns);
    }
    if (setup.mends) {
      const Bed& bed = hand_.site().scene.bed();
      mender_.emplace(bed.parameters(), setup.model.tool, hand_.site().surface_m);
    }
  }

  TeleopResult run() {
    for (std::uint64_t tick = 0; tick < course_.ticks(); ++tick) {
      const double now_s = course_.time(tick);
      result_.duration_s = now_s;
      course_.look(tick);
      const std::optional<GrainMove> move = updateModel(tick);
      if (hand_.hand().hasTask() && !lookAtTask(tick, now_s)) {
        break;
      }
      moveHand(tick, now_s, move);
      receiveCommands(now_s);
      for (robot_ticks_ += 1 + setup_.robot_clock_share; robot_ticks_ >= 1; robot_ticks_ -= 1) {
        tickRobot(now_s);
      }
      receiveReports(now_s);
      behind_.tick(newest_report_ > 0, now_s - course_.time(newest_report_));
    }
    return result();
  }

 private:
  /// Adjusts soil and surface of the operator's model. Returns the grain that was asked to move.
  std::optional<GrainMove> updateModel(std::uint64_t tick) {
    if (const std::optional<SoilAdjustment> step = learning_ ? learning_->at(tick, hand_.inAir()) : std::nullopt) {
      hand_.become(*step);
    }
    if (mender_ && tick % kLookEvery == 0) {
      const Scene& model = hand_.site().scene;
      mender_->look(tick, seenSoil(model.bed()), model.toolPose().position_m, known_site_);
    }
    std::optional<GrainMove> move = mender_ ? mender_->next(hand_.inAir()) : std::nullopt;
    if (move) {
      hand_.move(*move);
    }
    if (tick % kLookEvery == 0) {
      model_heights_.push_back(hand_.heights(camera_.grid()));
    }
    return move;
  }

  /// Shows the operator what is known of the site. False when the task is done.
  bool lookAtTask(std::uint64_t tick, double now_s) {
    const bool feels = setup_.feedback == Feedback::kModel;
    TaskSight sight{now_s,        tick,       {},          feels ? hand_.unlimited().force_n.norm() : met_.force_n,
                    met_.force_n, met_.index, &known_site_};
    if (feels) {
      sight.own = [&](const HeightGrid& grid) { return hand_.heights(grid); };
    }
    hand_.hand().look(std::move(sight));
    return !hand_.hand().done();
  }

  void moveHand(std::uint64_t tick, double now_s, const std::optional<GrainMove>& move) {
    hand_.tick();
    result_.mended += move && hand_.hasMoved(*move) ? 1 : 0;
    log_.add(tick, hand_.tool(), hand_.displayed(), hand_.unlimited());
    if (tick % course_.period() == 0) {
      command_.keyframes = commands_.add({tick, hand_.tool()});
      command_.held = hand_.hand().holds();
      ++command_.number;
      up_.send(now_s, bytesOf(command_));
    }
  }

  void receiveCommands(double now_s) {
    while (const std::optional<Link::Arrival> arrived = up_.receive(now_s)) {
      if (const std::optional<CommandPacket> packet = parseCommand(arrived->packet)) {
        robot_.take(packet->connection, packet->held, packet->keyframes);
        state_.operator_connection = packet->connection;
        state_.newest = robot_.newest();
      }
    }
  }

  void tickRobot(double now_s) {
    robot_.tick();
    followed_.tick(robot_.state() == RobotState::kFollowing);
    if (robot_.state() == RobotState::kFollowing) {
      enter((robot_.tool().pose.position_m - log_.toolAt(robot_.index())).norm(), site_.scene.soilWrench(), result_);
    }
    if (robot_tick_++ % course_.period() == 0) {
      // A waiting robot has no new report: reports of one command would coincide.
      const RobotReport report = robot_.report();
      if (state_.reports.empty() || report.index > state_.reports.back().index) {
        state_.reports = reports_.add(report);
      }
      state_.state = robot_.state();
      state_.reason = robot_.reason();
      ++state_.number;
      down_.send(now_s, bytesOf(state_));
    }
    if (!model_heights_.empty() && robot_.index() >= static_cast<double>(next_compared_)) {
      surface_.compare(site_.heights(camera_.grid()), model_heights_.front());
      model_heights_.pop_front();
      next_compared_ += kLookEvery;
    }
    if (std::optional<SitePacket> seen = camera_.tick(static_cast<std::uint64_t>(robot_.index()))) {
      seen->robot_connection = kConnection;
      down_.send(now_s, bytesOf(*seen));
    }
  }

  void receiveReports(double now_s) {
    while (const std::optional<Link::Arrival> arrived = down_.receive(now_s)) {
      if (const std::optional<SitePacket> seen = parseSite(arrived->packet)) {
        known_site_.take(*seen);
        continue;
      }
      const std::optional<StatePacket> packet = parseState(arrived->packet);
      for (const RobotReport& report : packet ? packet->reports : std::vector<RobotReport>()) {
        if (known_.insert(report.index).second) {
          take(report);
        }
      }
    }
    if (camera_.looks() != looks_) {
      looks_ = camera_.looks();
      surface_.look(now_s, camera_.heights(), known_site_);
    }
  }

  void take(const RobotReport& report) {
    newest_report_ = std::max(newest_report_, report.index);
    met_ = report.index >= met_.index ? MetLast{report.met.force_n.norm(), report.index} : met_;
    if (const auto displayed_n = log_.displayed().mean(report.index - report.ticks, report.index)) {
      result_.agreement.add(course_.time(report.index), course_.time(report.ticks), *displayed_n, report.met.force_n);
      if (learning_) {
        learning_->met(report, *displayed_n);
      }
    }
  }

  TeleopResult result() {
    result_.given_j = log_.mostGiven();
    result_.behind_s = behind_.mean();
    result_.followed_share = followed_.value();
    result_.ran_out = robot_.ranOut();
    result_.stops = robot_.stops();
    result_.last_stop = robot_.reason();
    result_.task = hand_.hand().result();
    result_.known_surface_m = surface_.known();
    result_.apart_surface_m = surface_.apart();
    result_.up = up_.counts();
    result_.down = down_.counts();
    if (learning_) {
      result_.learned = learning_->learned();
      result_.updates = learning_->updates();
      constexpr double kMost = 0.95;
      result_.update_jump = hand_.watch().change(1);
      result_.most_update_jumps = hand_.watch().change(kMost);
      result_.update_j = hand_.watch().pushed();
    }
    return std::move(result_);
  }

  const TeleopSetup& setup_;
  TeleopResult result_;
  Course course_;
  ModelOperator hand_;
  std::optional<LearningModel> learning_;
  std::optional<SurfaceMender> mender_;
  Site site_;
  Robot robot_;
  SiteCamera camera_;
  SiteMap known_site_;
  SurfaceWatch surface_;
  std::deque<std::vector<double>> model_heights_;  ///< at every 250th command that the robot has not executed yet
  Link up_, down_;
  OperatorLog log_;
  KeyframeHistory<Keyframe> commands_;
  KeyframeHistory<RobotReport> reports_;
  CommandPacket command_{.connection = kConnection};
  StatePacket state_{.robot_connection = kConnection};
  std::uint64_t newest_report_ = 0;
  MetLast met_;
  std::set<std::uint64_t> known_;  ///< indices of reports: others may overtake them, and all come more than once
  double robot_ticks_ = 0;
  std::uint64_t next_compared_ = 0, looks_ = 0, robot_tick_ = 0;
  Mean behind_;
  Share followed_;
};

}  // namespace

TeleopResult simulateModel(const TeleopSetup& setup, const TeleopProgress& progress) {
  return ModelSimulation(setup, progress).run();
}

}  // namespace haptolith::simulation

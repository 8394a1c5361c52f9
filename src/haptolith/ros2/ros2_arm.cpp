#include "haptolith/ros2/ros2_arm.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string_view>

#include "haptolith/core/platform/clock.h"
#include "haptolith/ros2/dds_endpoint.h"

namespace haptolith {

namespace {

std::int64_t nanoseconds(double seconds) {
  return std::llround(1e9 * seconds);
}

std::uint64_t ticksIn(double time_s, double tick_s) {
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(time_s / tick_s)));
}

}  // namespace

class Ros2Arm::Implementation {
 public:
  Implementation(Ros2Node& node, const Ros2ArmParameters& parameters, double tick_s)
      : parameters_(parameters),
        fresh_ns_(nanoseconds(requireInRange("fresh_s", parameters.fresh_s, Ros2ArmParameters::kFresh_s))),
        tare_ns_(nanoseconds(parameters.tare_s)),
        target_ticks_(ticksIn(
            requireInRange("target_period_s", parameters.target_period_s, Ros2ArmParameters::kTargetPeriod_s), tick_s)),
        target_(node, parameters.target_topic, Ros2Qos::kCommand),
        pose_(node, parameters.pose_topic),
        wrench_(node, parameters.wrench_topic) {
    node.announce();
    frame_.reserve(kLongestFrame);
  }

  ArmReading move(const HandState& wanted, bool commanded) noexcept {
    pose_.take([this](const PoseMessage& message, std::uint64_t) { take(message); });
    wrench_.take([this](const WrenchMessage& message, std::uint64_t) { take(message); });
    if (commanded && ready() && ticks_++ % target_ticks_ == 0) {
      const Pose& site = parameters_.base_T_site;
      const Pose base_T_tool{site.fromBody(wanted.pose.position_m),
                             (site.orientation * wanted.pose.orientation).normalized()};
      const std::int64_t now_ns =
          std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
              .count();
      (void)target_.write({headerOf(now_ns, frame_), messageOf(base_T_tool)});
    }
    return reading_;
  }

  void tare() noexcept {
    zero_.reset();
    sum_ = {};
    wrenches_ = 0;
  }

  [[nodiscard]] bool ready() const noexcept {
    const std::int64_t now_ns = monotonicNs();
    return zero_ && posed_ns_ != 0 && now_ns - posed_ns_ <= fresh_ns_ && now_ns - measured_ns_ <= fresh_ns_;
  }

 private:
  static constexpr std::size_t kLongestFrame = 200;

  void take(const PoseMessage& message) {
    const std::optional<Pose> base_T_tool = poseOf(message.pose);
    const std::string_view frame(message.header.frame_id);
    if (!base_T_tool || frame.size() > kLongestFrame) {
      return;  // as if it had not come: what comes too seldom makes the arm not ready
    }
    frame_.assign(frame);
    const Pose& site = parameters_.base_T_site;
    reading_.tool.pose = {site.toBody(base_T_tool->position_m),
                          (site.orientation.conjugate() * base_T_tool->orientation).normalized()};
    posed_ns_ = monotonicNs();
  }

  void take(const WrenchMessage& message) {
    std::optional<Wrench> told = wrenchOf(message.wrench);
    if (!told || posed_ns_ == 0) {
      return;
    }
    const std::int64_t now_ns = monotonicNs();
    measured_ns_ = now_ns;
    if (!zero_) {
      tare(*told, now_ns);
      return;
    }
    // The zero is subtracted along the sensor's axes: there it is constant, however the tool turns.
    const double sign = parameters_.wrench_of_tool ? -1 : 1;
    const bool of_base = message.header.frame_id == frame_;
    const Quat turn = of_base ? Quat(parameters_.base_T_site.orientation.conjugate()) : reading_.tool.pose.orientation;
    reading_.met = {turn * (sign * (told->force_n - zero_->force_n)),
                    turn * (sign * (told->torque_nm - zero_->torque_nm))};
  }

  void tare(const Wrench& told, std::int64_t now_ns) {
    tared_since_ns_ = wrenches_ == 0 ? now_ns : tared_since_ns_;
    sum_.add(told);
    ++wrenches_;
    if (now_ns - tared_since_ns_ >= tare_ns_) {
      zero_ = Wrench{sum_.force_n / wrenches_, sum_.torque_nm / wrenches_};
    }
  }

  Ros2ArmParameters parameters_;
  std::int64_t fresh_ns_, tare_ns_;
  std::uint64_t target_ticks_, ticks_ = 0;
  Ros2Writer<PoseMessage> target_;
  Ros2Reader<PoseMessage> pose_;
  Ros2Reader<WrenchMessage> wrench_;

  ArmReading reading_;
  std::string frame_;  ///< frame of the robot's poses
  std::int64_t posed_ns_ = 0, measured_ns_ = 0;
  std::optional<Wrench> zero_;
  Wrench sum_;  ///< sum of the wrenches for the zero
  int wrenches_ = 0;
  std::int64_t tared_since_ns_ = 0;
};

Ros2Arm::Ros2Arm(Ros2Node& node, const Ros2ArmParameters& parameters, double tick_s)
    : implementation_(std::make_unique<Implementation>(node, parameters, tick_s)) {}
Ros2Arm::~Ros2Arm() = default;

ArmReading Ros2Arm::move(const HandState& wanted, bool commanded) noexcept {
  return implementation_->move(wanted, commanded);
}
void Ros2Arm::tare() noexcept {
  implementation_->tare();
}
bool Ros2Arm::ready() const noexcept {
  return implementation_->ready();
}

}  // namespace haptolith

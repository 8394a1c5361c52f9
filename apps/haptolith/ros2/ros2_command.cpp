#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/ros2/scene_publisher.h"
#include "haptolith/ros2/target_device.h"

#include "commands.h"
#include "ros2/ros2_options.h"
#include "run/run_companion.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kRos2Examples = R"(Examples:
  haptolith ros2                              lunar soil; /haptolith/target_pose moves the tool
  haptolith ros2 teleop-model --motion scoop  the virtual hand digs, ROS 2 subscribes
  haptolith ros2 --device force-dimension     a user digs with a haptic device
  ros2 topic echo /haptolith/wrench --qos-reliability best_effort      in a shell with ROS 2
  haptolith teleop ros2                       connect a ROS 2 robot to `haptolith teleop operator`

Topics, frames and QoS: docs/how-to/ros2.md. A ROS 2 installation is not required.)";

constexpr double kBeside_m = 0.15, kAboveSoil_m = 0.35;  // max. distance of targets from the box

struct SceneOverRos2 {
  Ros2Options ros2;
  double timeout_s = TargetParameters().fresh_s;
  double surface_hz = 5;
};

class Ros2Companion final : public RunCompanion {
 public:
  Ros2Companion(const SceneOverRos2& options, const SceneFile& scene_file, bool takes_target)
      : options_(options), takes_target_(takes_target), hand_(scene_file.hand), tick_s_(scene_file.loop.tick_s) {
    const BedParameters& bed = scene_file.bed;
    target_.fresh_s = options.timeout_s;
    target_.low_m = {-bed.width_m / 2 - kBeside_m, -bed.length_m / 2 - kBeside_m, 0};
    target_.high_m = {bed.width_m / 2 + kBeside_m, bed.length_m / 2 + kBeside_m, bed.depth_m + kAboveSoil_m};
    if (takes_target && !scene_file.loop.real_time) {
      throw InvalidParameter("real_time", "false", "true (without --no-realtime) while targets of ROS 2 move the tool");
    }
    node_.emplace(options.ros2.node);
    ScenePublisherParameters parameters;
    parameters.takes_target = takes_target;
    publisher_.emplace(*node_, parameters, tick_s_);
    printNotice(
        fmt::format("ROS 2 node {}{}\n", node_->text(),
                    takes_target ? fmt::format("; the tool waits for {}", node_->name().topic("~/target_pose")) : ""));
  }

  [[nodiscard]] std::unique_ptr<HapticDevice> device() override {
    return takes_target_ ? std::make_unique<TargetDevice>(publisher_->inbox(), target_, hand_, tick_s_) : nullptr;
  }

  [[nodiscard]] RecordTaker::Listener listener() override {
    return [this](std::span<const TickRecord> ticks) { publisher_->add(ticks); };
  }

  void follow(Session& session, const SessionDriver::News& news, SessionRecording&) override {
    if (news.snapshot && !surface_m_) {
      const BedParameters& bed = session.shown().bed;
      surface_m_ = meanSurfaceHeight({bed.soil.radius_m, session.snapshot().position, {}}, bed);
      printNotice(fmt::format("the soil's surface is at z = {:.4f} m\n", *surface_m_));
    }
    if (!news.snapshot || options_.surface_hz == 0 || monotonicNs() < next_surface_ns_) {
      return;
    }
    constexpr double kSecond_ns = 1e9;
    const BedParameters& bed = session.shown().bed;
    const SceneSnapshot& now = session.snapshot();
    if (publisher_->show(seenSoil(session.scene().bed(), bed.soil.radius_m, now.position, now.stones),
                         surfaceGrid(bed))) {
      next_surface_ns_ = monotonicNs() + static_cast<std::int64_t>(kSecond_ns / options_.surface_hz);
    }
  }

  [[nodiscard]] std::string summary() const override {
    const SceneMessageCounts counts = publisher_->counts();
    return fmt::format("  ROS 2      {} ticks published, {} skipped; {} frames of the soil{}\n", counts.ticks,
                       counts.not_told, counts.surfaces,
                       takes_target_ ? fmt::format("; {} targets accepted, {} from other nodes, {} invalid",
                                                   counts.targets, counts.strangers, counts.nonsense)
                                     : "");
  }

  void addTo(Json& json) const override {
    const SceneMessageCounts counts = publisher_->counts();
    json["ros2"] = {{"node", node_->text()},
                    {"surface_m", surface_m_ ? Json(*surface_m_) : Json(nullptr)},
                    {"ticks_told", counts.ticks},
                    {"ticks_not_told", counts.not_told},
                    {"surfaces", counts.surfaces},
                    {"targets_taken", counts.targets},
                    {"targets_of_others", counts.strangers},
                    {"targets_without_sense", counts.nonsense}};
  }

 private:
  SceneOverRos2 options_;
  bool takes_target_;
  HandParameters hand_;
  double tick_s_;
  TargetParameters target_;
  std::optional<Ros2Node> node_;
  std::optional<ScenePublisher> publisher_;
  std::int64_t next_surface_ns_ = 0;
  std::optional<double> surface_m_;  ///< initial mean height of the soil, the zero of a robot's site
};

}  // namespace

void addRos2Command(CLI::App& app) {
  auto options = std::make_shared<SceneOverRos2>();
  CLI::App* command = app.add_subcommand("ros2", kRos2Description);
  command->footer(kRos2Examples);
  options->ros2.addTo(*command);
  command
      ->add_option("--target-timeout-s", options->timeout_s,
                   fmt::format("Time without a target after which the tool is released [{:g}]", options->timeout_s))
      ->check(numberIn(TargetParameters::kFresh_s))
      ->option_text("SECONDS");
  command->add_option("--surface-hz", options->surface_hz, "Frames of the soil surface per second; 0: none [5]")
      ->check(numberIn({0, 30}))
      ->option_text("HZ");
  addRunOptions(*command, [options](SceneFile& scene_file, const SceneOptions& asked) {
    const bool somebody =
        asked.device.kind || asked.motion || asked.poses_file || scene_file.device.kind != DeviceKind::kVirtualHand;
    return std::make_unique<Ros2Companion>(*options, scene_file, !somebody);
  });
}

}  // namespace haptolith

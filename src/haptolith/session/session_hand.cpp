// Who holds the tool of a session: a person at a device, or the virtual hand.

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/device/drivers/open_device.h"
#include "haptolith/session/session.h"

namespace haptolith {

namespace {

/// Range of the tool beyond the box and above the surface: well within the loop's limits for a hand.
constexpr double kBesideBox_m = 0.15;
constexpr double kAboveSurface_m = 0.35;

}  // namespace

void Session::openHand(std::unique_ptr<HapticDevice> device) {
  if (device) {
    device_ = std::move(device);
  } else if (wanted_.device.kind == DeviceKind::kVirtualHand) {
    auto hand = std::make_unique<VirtualHand>(wanted_.hand, wanted_.bed.tick_s);
    hand_ = hand.get();
    device_ = std::move(hand);
  } else {
    device_ = openDevice(wanted_.device, wanted_.bed.tick_s);
  }
  if (!device_->simulated()) {
    last_resort_.emplace(*device_);
  }
}

void Session::requireVirtualHand(const char* asked) const {
  if (hand_ == nullptr) {
    throw RefusedAction(asked,
                        fmt::format("cannot move the tool: a haptic device moves it ({}); only the virtual hand can "
                                    "be replaced",
                                    device_->name()));
  }
}

bool Session::personFeels() const noexcept {
  const DeviceLimits limits = device_->limits();
  return !device_->simulated() && limits.shows_force && limits.max_force_n > 0 && snapshot().trip == SafetyTrip::kNone;
}

void Session::commandHand() {
  if (hand_ != nullptr) {
    hand_->command(command_);
  }
}

void Session::hold(const Pose& scene_T_tool) {
  requireVirtualHand("hold");
  const Vec3 low = workspaceLow();
  const Vec3 high = workspaceHigh();
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange(fmt::format("pose[{}]", axis), scene_T_tool.position_m[axis], {low[axis], high[axis]});
  }
  requireInRange("the norm of the pose's quaternion", scene_T_tool.orientation.norm(), kUnitNorm);
  command_.held = Pose{scene_T_tool.position_m, scene_T_tool.orientation.normalized()};
  commandHand();
}

void Session::release() {
  if (command_.held) {
    command_.held = snapshot().scene_T_tool;
    commandHand();
  }
}

void Session::play(HandMotion motion) {
  requireVirtualHand("play");
  command_.held.reset();
  command_.motion = motion;
  tellMotion(wanted_);
  tellMotion(current_.scene_file);
  ++command_.beginnings;
  commandHand();
}

/// The title may name the motion.
void Session::tellMotion(SceneFile& scene_file) const {
  const std::string before = sceneInWords(scene_file);
  scene_file.hand.motion = command_.motion;
  retitle(scene_file, before);
}

Vec3 Session::workspaceLow() const noexcept {
  const BedParameters& bed = current_.scene_file.bed;
  return {-bed.width_m / 2 - kBesideBox_m, -bed.length_m / 2 - kBesideBox_m, 0};
}

Vec3 Session::workspaceHigh() const noexcept {
  const BedParameters& bed = current_.scene_file.bed;
  return {bed.width_m / 2 + kBesideBox_m, bed.length_m / 2 + kBesideBox_m, surface() + kAboveSurface_m};
}

}  // namespace haptolith

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

/// The device of the first tool of `wanted_`.
Session::Hand Session::openHand(std::unique_ptr<HapticDevice> device) const {
  Hand hand;
  hand.command.motion = wanted_.hand.motion;
  hand.command.surface_m = *wanted_.hand.surface_m;
  if (device) {
    hand.device = std::move(device);
  } else if (wanted_.device.kind == DeviceKind::kVirtualHand) {
    auto virtual_hand = std::make_unique<VirtualHand>(wanted_.hand, wanted_.bed.tick_s);
    hand.virtual_hand = virtual_hand.get();
    hand.device = std::move(virtual_hand);
  } else {
    hand.device = openDevice(wanted_.device, wanted_.bed.tick_s);
  }
  return hand;
}

void Session::openHands(std::unique_ptr<HapticDevice> device) {
  std::vector<HapticDevice*> at_people;
  for (std::size_t tool = 0; tool < toolCount(wanted_); ++tool) {
    exchangeFirst(wanted_, tool);
    if (!wanted_.hand.surface_m) {
      wanted_.hand.surface_m = current_.fresh->surface_m;
    }
    hands_.push_back(openHand(std::exchange(device, nullptr)));
    exchangeFirst(wanted_, tool);
    if (!hands_.back().device->simulated()) {
      at_people.push_back(hands_.back().device.get());
    }
  }
  if (!at_people.empty()) {
    at_people_.emplace(std::move(at_people));
    last_resort_.emplace(*at_people_);
  }
}

std::vector<ToolHandling> Session::handlings() {
  std::vector<ToolHandling> handlings;
  for (std::size_t tool = 0; tool < hands_.size(); ++tool) {
    exchangeFirst(wanted_, tool);
    handlings.push_back({hands_[tool].device.get(), handlingOf(wanted_, *wanted_.hand.surface_m)});
    exchangeFirst(wanted_, tool);
  }
  return handlings;
}

Session::Hand& Session::requireVirtualHand(const char* asked, std::size_t tool) {
  if (tool >= hands_.size()) {
    throw InvalidParameter("tool", fmt::format("{}", tool), fmt::format("0 to {}", hands_.size() - 1));
  }
  Hand& hand = hands_[tool];
  if (hand.virtual_hand == nullptr) {
    throw RefusedAction(asked,
                        fmt::format("cannot move the tool: a haptic device moves it ({}); only the virtual hand can "
                                    "be replaced",
                                    hand.device->name()));
  }
  return hand;
}

bool Session::personFeels() const {
  for (std::size_t tool = 0; tool < hands_.size(); ++tool) {
    const HapticDevice& device = *hands_[tool].device;
    const DeviceLimits limits = device.limits();
    if (!device.simulated() && limits.shows_force && limits.max_force_n > 0 &&
        snapshot().tools.at(tool).trip == SafetyTrip::kNone) {
      return true;
    }
  }
  return false;
}

void Session::commandHand(Hand& hand) {
  if (hand.virtual_hand != nullptr) {
    hand.virtual_hand->command(hand.command);
  }
}

void Session::hold(const Pose& scene_T_tool, std::size_t tool) {
  Hand& hand = requireVirtualHand("hold", tool);
  const Vec3 low = workspaceLow();
  const Vec3 high = workspaceHigh();
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange(fmt::format("pose[{}]", axis), scene_T_tool.position_m[axis], {low[axis], high[axis]});
  }
  requireInRange("the norm of the pose's quaternion", scene_T_tool.orientation.norm(), kUnitNorm);
  hand.command.held = Pose{scene_T_tool.position_m, scene_T_tool.orientation.normalized()};
  commandHand(hand);
}

void Session::release(std::size_t tool) {
  Hand& hand = hands_.at(tool);
  if (hand.command.held) {
    hand.command.held = snapshot().tools.at(tool).scene_T_tool;
    commandHand(hand);
  }
}

void Session::play(HandMotion motion, std::size_t tool) {
  Hand& hand = requireVirtualHand("play", tool);
  hand.command.held.reset();
  hand.command.motion = motion;
  tellMotion(wanted_);
  tellMotion(current_.scene_file);
  ++hand.command.beginnings;
  commandHand(hand);
}

/// The title may name the motion.
void Session::tellMotion(SceneFile& scene_file) const {
  const std::string before = sceneInWords(scene_file);
  for (std::size_t tool = 0; tool < hands_.size(); ++tool) {
    exchangeFirst(scene_file, tool);
    scene_file.hand.motion = hands_[tool].command.motion;
    exchangeFirst(scene_file, tool);
  }
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

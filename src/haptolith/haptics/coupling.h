#pragma once

#include "haptolith/core/error.h"
#include "haptolith/core/movement.h"
#include "haptolith/device/hand/arm.h"
#include "haptolith/device/haptic_device.h"
#include "haptolith/haptics/wrench_filter.h"

namespace haptolith {

/// Connection between hand and tool.
enum class CouplingKind {
  kAuto,     ///< as suitsDirectly() says
  kDirect,   ///< the tool is where the hand is, and the hand feels the soil: as in icra2021
  kVirtual,  ///< a spring and a damper pull the tool after the hand, and the hand feels these
};

/// Whether a device is coupled directly unless a scene says otherwise: it renders force with
/// at most 1 ms of latency, and its resolution is fine enough (docs/explanation/safety.md).
[[nodiscard]] bool suitsDirectly(const DeviceLimits& device) noexcept;

struct CouplingParameters {
  CouplingKind kind = CouplingKind::kAuto;
  /// Soft enough for a handle of 0.1 kg that shows a force 10 ms late, in any hand: a damper B shakes a handle of mass
  /// m when B > pi m / (2 T), 16 N s/m, and a spring K when K T > B. Light, so that a hand does not feel the tool's
  /// mass in the air. A device that is known to be faster can have more of all three.
  ArmParameters spring{.mass_kg = 0.05, .damping_n_s_m = 5, .stiffness_n_m = 200, .lever_m = 0.05};
  double max_force_n = 12;  ///< the spring pulls no harder than this, and turns no harder than this times the lever

  [[nodiscard]] bool operator==(const CouplingParameters&) const = default;
};

/// Whether a spring and a damper lie between hand and tool. @param suits_directly  see CouplingKind::kAuto.
[[nodiscard]] inline bool couplesVirtually(CouplingKind kind, bool suits_directly) noexcept {
  return kind == CouplingKind::kVirtual || (kind == CouplingKind::kAuto && !suits_directly);
}

/// Valid range of each number alone.
struct CouplingRanges {
  static constexpr Range stiffness_n_m{0, 1e5, Ends::kOpenBelow};
  static constexpr Range damping_n_s_m{0, 1000};
  static constexpr Range mass_kg{0.001, 100};
  static constexpr Range lever_m{0.001, 1};
  static constexpr Range max_force_n{0, 1000, Ends::kOpenBelow};
};

/// @throws InvalidParameter with the key, the value and the valid range: also for a spring and damper that a tick
/// cannot follow, 4 m <= K dt^2 + 2 B dt (see moveArm()).
void validate(const CouplingParameters& coupling, double tick_s);

/// The tool between hand and soil. A direct coupling is what the paper does: nothing between them but the low-pass. It
/// feels every grain and is as stable as the soil's stiffness, the filter's delay and the hand allow. A virtual
/// coupling (Colgate, Stanley and Brown 1995, "Issues in the haptic display of tool use", IROS, 140-145) gives the tool
/// a separate mass: however stiff the soil, the hand feels at most the spring K and damper B, stable at a device
/// with damping b as long as b > K dt / 2 + B (Colgate and Schenkel 1997, J. Robotic Systems 14:37; sufficient, and far
/// from necessary with a person's hand at the device). Its force needs no low-pass. Functions may be called in the
/// tick.
class Coupling {
 public:
  /// @param suits_directly  see CouplingKind::kAuto.
  /// @throws InvalidParameter as validate().
  Coupling(const CouplingParameters& parameters, bool suits_directly, double filter_cutoff_hz, double tick_s);

  /// Moves the tool by one tick; returns its state.
  [[nodiscard]] const HandState& moveTool(const HandState& hand) noexcept;
  /// Returns the wrench on the hand after the soil has responded; the fingers get the grip force directly.
  [[nodiscard]] ToolForce feel(const ToolForce& soil, const Eigen::Matrix3d& contact_stiffness_n_m) noexcept;

  /// The tool is where the hand is, at rest.
  void place(const HandState& hand) noexcept;

  [[nodiscard]] bool isVirtual() const noexcept { return virtual_; }
  /// Stiffness of the spring between hand and tool, in N/m; infinite for a direct coupling.
  [[nodiscard]] double stiffness() const noexcept;

 private:
  CouplingParameters coupling_;
  bool virtual_;
  double tick_s_;
  WrenchFilter filter_;
  GripFilter grip_filter_;
  QuickMovement quick_movement_;
  HandState tool_;
  Wrench soil_, pull_;
};

}  // namespace haptolith

#pragma once

#include <numbers>
#include <optional>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/vec.h"
#include "haptolith/device/hand/arm.h"

namespace haptolith {

/// Periodic motion of the virtual hand.
enum class HandMotion { kStill, kPress, kStir, kScoop, kCarry, kShake, kCut, kFurrows, kPoses };

/// Response of the hand to force.
enum class HandCompliance {
  kArm,    ///< mass, damper and spring between the motion and the tool
  kRigid,  ///< the tool follows the motion exactly, whatever the soil does
};

/// The virtual hand: a human arm that pulls the tool along a motion and yields to what it feels.
/// The arm's values are one measured participant's in Scientific Reports 6:18004 (2016), fig. 3 (van Beek et al.).
struct HandParameters {
  HandMotion motion = HandMotion::kScoop;
  std::string poses_file;  ///< kPoses: CSV with t_s,x_m,y_m,z_m,qw,qx,qy,qz
  HandCompliance compliance = HandCompliance::kArm;
  double mass_kg = 0.554;
  double damping_n_s_m = 6.45;
  double stiffness_n_m = 135;
  double lever_m = 0.1;             ///< the arm's rotation: inertia, damping and stiffness are the above times lever^2
  double period_s = 4;              ///< one motion
  double active_s = 1e9;            ///< then the hand leaves the soil and waits above it
  Vec3 home_m{0, 0, 0.085};         ///< start, end and waiting place: x and y in the scene, z above the surface
  Vec3 turn_rad = Vec3::Zero();     ///< turns the tool in the hand: about x, then y, then z; not with kPoses
  double depth_m = 0.02;            ///< lowest point of the tool's origin below the surface during a motion
  std::optional<double> surface_m;  ///< height of the soil's surface; left out: measured when the bed is made
  double reach_m = 0.035;           ///< largest distance to the side
  double max_force_n = 12;          ///< limit of the device, a sigma.7 as in CHAI3D
  double max_torque_nm = 0.2;

  [[nodiscard]] bool operator==(const HandParameters&) const = default;
};

/// Valid ranges; for home that of each axis.
struct HandRanges {
  static constexpr Range mass_kg{0.01, 100};
  static constexpr Range damping_n_s_m{0, 1000};
  static constexpr Range stiffness_n_m{0, 1e5};
  static constexpr Range lever_m{0.005, 1};
  static constexpr Range period_s{0.1, 3600};
  static constexpr Range active_s{0, Range{}.highest};
  static constexpr Range home_m{-10, 10};
  static constexpr Range turn_rad{-2 * std::numbers::pi, 2 * std::numbers::pi};
  static constexpr Range depth_m{0, 10};
  static constexpr Range surface_m{0, 10};
  static constexpr Range reach_m{0, 10};
  static constexpr Range max_force_n{0, 1e6};
  static constexpr Range max_torque_nm{0, 1e6};
};

/// @throws InvalidParameter with the key, the value and the valid range.
void validate(const HandParameters& hand);

/// Its arm, where its compliance is one.
[[nodiscard]] ArmParameters armOf(const HandParameters& hand) noexcept;

}  // namespace haptolith

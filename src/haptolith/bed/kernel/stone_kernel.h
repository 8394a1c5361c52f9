// What a stone and the soil around it do to each other, sixteen grains at a time.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "haptolith/bed/bed_state.h"
#include "haptolith/bed/kernel/kernel_law.h"
#include "haptolith/core/vec.h"

namespace haptolith {

/// Sixteen grains of one class near a stone, or fewer: the first then fills the remaining places.
struct StonePack {
  alignas(64) std::array<std::int32_t, kGroup> particle{};
  alignas(64) std::array<std::array<float, kGroup>,
                         3> stretch_m{};             ///< stretch of the friction springs: x, y and z, stone frame
  std::uint32_t count = 0;                           ///< number of particles
  std::uint32_t first_sphere = 0, sphere_count = 0;  ///< those near to any of them, in a list of numbers
  std::int32_t grain_class = 0;
  double apart_until_m = 0;  ///< total movement before which they cannot touch
};

/// Pose and motion of a stone, in the precision of particles.
struct StoneMotion {
  /// @param middle  in m, scene frame. @param rotation  scene_R_stone. @param velocity  in m/s, scene frame.
  /// @param spin  in rad/s, stone's frame.
  StoneMotion(const Vec3& middle, const Eigen::Matrix3d& rotation, const Vec3& velocity, const Vec3& spin);

  std::array<float, 3> middle_m, middle_rest_m;  ///< scene frame; and what rounding has left of it
  std::array<std::array<float, 3>, 3> scene_R_stone;
  std::array<float, 3> velocity_m_s;  ///< scene frame
  std::array<float, 3> spin_rad_s;    ///< stone's frame
};

/// A stone as a pack of grains meets it.
struct StoneBesidePack {
  const ContactFrictionLaw& law;  ///< between it and grains of the pack's class
  const StoneMotion& motion;
  const Float4* spheres;                   ///< all of them: middle in the stone's frame, radius
  std::span<const std::uint16_t> numbers;  ///< indices of those near the pack
  float grain_m;                           ///< R of class 0, less what the stone is short of its size
  float dt_s;
};

/// Force of a stone on each particle of a pack, scene frame.
struct PackTouch {
  alignas(64) std::array<std::array<float, kGroup>, 3> force_n;  ///< x, y and z
  alignas(64) std::array<std::array<float, kGroup>, 3> lever_m;  ///< from the stone's middle to where they touch
  alignas(64) std::array<float, kGroup> beyond_m;  ///< distance from the range of the force; < 0: there is one
};

/// Forces on a pack of grains by OverlapOfSpheres and StoneContactLaw; friction's memory moves on. May be called in the
/// tick.
void pressPack(const StoneBesidePack& stone, const Float4* position, const Float4* velocity, StonePack& pack,
               PackTouch& touch) noexcept;

}  // namespace haptolith

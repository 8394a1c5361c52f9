#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/identify/training/digging.h"
#include "haptolith/soil/contact_strength.h"

namespace haptolith {

/// Strength from a simulated shear test.
struct MeasuredStrength {
  ShearStrength residual, peak;
};

/// Forces of one soil on the tool, with its strength.
struct TrainingRun {
  std::uint64_t number = 0;  ///< number for soilSample(); modulo a million, the seed of the specimen
  SoilSample sample;
  std::optional<MeasuredStrength> strength;  ///< empty: not sheared
  WindowForces forces;
};

/// Movement of a tool with the forces of many soils.
struct Training {
  ToolMovement movement;
  std::string tool;  ///< description of the tool
  double gravity_m_s2 = 1.625;
  std::vector<TrainingRun> runs;
  std::optional<double> temper;  ///< T of SoilIdentifier, if known
};

/// Simulates a shear test under 300, 1000 and 3000 Pa. @throws as shearTest().
[[nodiscard]] MeasuredStrength measuredStrength(const SoilParameters& soil, double gravity_m_s2, std::uint64_t seed,
                                                const LabProgress& progress = {});

/// Stride of the sheared soils among the less diverse ones: shearing takes longer than digging, and strength depends
/// smoothly on contacts. All of the more diverse soils are sheared.
inline constexpr std::uint64_t kShearedEvery = 3;

/// Simulates digging in soil `number`, and shears it if it is one of the sheared soils. Takes a minute.
/// @throws as shearTest() and digAlong().
[[nodiscard]] TrainingRun trainingRun(const ToolMovement& movement, const ToolParameters& tool,
                                      const DiggingField& field, std::uint64_t number,
                                      const LabProgress& progress = {});

}  // namespace haptolith

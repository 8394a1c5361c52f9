#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/identify/training/digging.h"
#include "haptolith/soil/contact_strength.h"

namespace haptolith {

/// Strength as a shear test measures it.
struct MeasuredStrength {
  ShearStrength residual, peak;
};

/// What one soil did to the tool, and how strong it is.
struct TrainingRun {
  std::uint64_t number = 0;  ///< of soilSample(); less a million where it has that, the specimen's seed
  SoilSample sample;
  std::optional<MeasuredStrength> strength;  ///< none: it was not sheared
  WindowForces forces;
};

/// A movement, and what many soils did to the tool that made it.
struct Training {
  ToolMovement movement;
  std::string tool;  ///< in words
  double gravity_m_s2 = 1.625;
  std::vector<TrainingRun> runs;
  std::optional<double> temper;  ///< T of SoilIdentifier, once it has been found
};

/// What a shear test under 300, 1000 and 3000 Pa measures. @throws as shearTest().
[[nodiscard]] MeasuredStrength measuredStrength(const SoilParameters& soil, double gravity_m_s2, std::uint64_t seed,
                                                const LabProgress& progress = {});

/// Of so many soils that differ less in kind one is sheared, which takes longer than to dig in it: strength goes
/// smoothly with contacts. Of the others each one is.
inline constexpr std::uint64_t kShearedEvery = 3;

/// Digs in soil `number`, and shears it when its turn comes. Takes a minute.
/// @throws as shearTest() and digAlong().
[[nodiscard]] TrainingRun trainingRun(const ToolMovement& movement, const ToolParameters& tool,
                                      const DiggingField& field, std::uint64_t number,
                                      const LabProgress& progress = {});

}  // namespace haptolith

#include "haptolith/identify/training/training.h"

#include <numbers>

#include "haptolith/lab/tests/shear.h"

namespace haptolith {

namespace {

ShearStrength strengthOf(const MohrCoulomb& line) {
  return {line.friction_angle_rad * 180 / std::numbers::pi, line.cohesion_pa};
}

}  // namespace

MeasuredStrength measuredStrength(const SoilParameters& soil, double gravity_m_s2, std::uint64_t seed,
                                  const LabProgress& progress) {
  const LabConditions conditions{soil, gravity_m_s2, seed, 1, progress};
  const ShearResult shear =
      shearTest(conditions, {.normal_stresses_pa = {300, 1000, 3000}, .strain = 4, .residual_from = 2});
  return {strengthOf(shear.residual), strengthOf(shear.peak)};
}

TrainingRun trainingRun(const ToolMovement& movement, const ToolParameters& tool, const DiggingField& field,
                        std::uint64_t number, const LabProgress& progress) {
  TrainingRun run;
  run.number = number;
  run.sample = soilSample(number);
  DiggingField own = field;
  own.seed = number % kWideNumbers;
  run.forces = digAlong(movement, tool, run.sample, own, progress);
  if (number >= kWideNumbers || number % kShearedEvery == 0) {
    run.strength = measuredStrength(run.sample.soil, field.gravity_m_s2, own.seed, progress);
  }
  return run;
}

}  // namespace haptolith

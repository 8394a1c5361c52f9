#include "haptolith/identify/training/soil_sample.h"

#include <cmath>
#include <random>

#include "haptolith/core/math/random.h"
#include "haptolith/soil/contact_strength.h"

namespace haptolith {

namespace {

/// Sequence of random numbers in ranges.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  double share() { return (uniformSigned(random_) + 1) / 2; }
  double in(const Range& range) { return range.lowest + share() * (range.highest - range.lowest); }
  double evenlyInLogarithm(const Range& range) {
    return range.lowest * std::pow(range.highest / range.lowest, share());
  }

 private:
  std::mt19937_64 random_;
};

constexpr double kWithoutCohesion = 1.0 / 7;

SoilSample sampleFrom(Draw& draw, const SampleRanges& ranges) {
  SoilSample sample;
  SoilParameters& soil = sample.soil;
  soil = lunarContacts();
  soil.stiffness_n_m = draw.evenlyInLogarithm(ranges.stiffness_n_m);
  soil.contact_friction = draw.in(ranges.contact_friction);
  const double cohesion_n = draw.evenlyInLogarithm(ranges.contact_cohesion_n);
  soil.contact_cohesion_n = draw.share() < kWithoutCohesion ? 0 : cohesion_n;
  const double density_kg_m3 = draw.in(ranges.density_kg_m3);
  soil.rho_max_kg_m3 *= density_kg_m3 / soil.rho0_kg_m3;
  soil.rho0_kg_m3 = density_kg_m3;
  soil.size_spread = draw.in(ranges.size_spread);
  soil.tangential_ratio = draw.in(ranges.tangential_ratio);
  soil.cohesion_range_ratio = draw.in(ranges.cohesion_range_ratio);
  soil = rescaled(soil, draw.in(ranges.radius_m));
  sample.tool_friction = draw.in(ranges.tool_friction);
  sample.tool_adhesion_n = draw.in(ranges.adhesion_share) * soil.contact_cohesion_n;
  sample.surface_error_m = draw.in(ranges.surface_error_m);
  soil.damping_ratio = draw.in(ranges.damping_ratio);
  soil.gamma_nm *= draw.evenlyInLogarithm(ranges.gamma_times);
  return sample;
}

}  // namespace

SoilSample soilSample(std::uint64_t number) {
  constexpr std::uint64_t kWithStone = 10;
  constexpr Range kStoneSize_m{0.02, 0.035};
  const bool wide = number >= kWideNumbers;
  Draw draw(number);
  SoilSample sample = sampleFrom(draw, wide ? kWideRanges : kNearRanges);
  sample.stone_size_m = wide && number % kWithStone == 0 ? draw.in(kStoneSize_m) : 0;
  return sample;
}

}  // namespace haptolith

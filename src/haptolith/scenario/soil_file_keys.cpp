#include "haptolith/scenario/soil_file_keys.h"

#include <algorithm>
#include <iterator>

#include "haptolith/scenario/scene_words.h"

namespace haptolith {

namespace {

SoilReached& reachedBy(SoilFile& file) {
  return file.reached ? *file.reached : file.reached.emplace();
}

std::vector<SoilFileKey> allSoilFileKeys() {
  using F = SoilFile;
  using NumberValue = SoilFileKey::NumberValue;
  using CountValue = SoilFileKey::CountValue;
  using IntervalValue = SoilFileKey::IntervalValue;
  using WordValue = SoilFileKey::WordValue;
  using TextValue = SoilFileKey::TextValue;
  return {
      {"", "name", "name",
       TextValue{[](F& f, std::string_view v) { f.name = v; }, [](const F& f) { return std::string_view(f.name); }},
       "What the soil is called."},
      {"", "source", "source",
       TextValue{[](F& f, std::string_view v) { f.source = v; }, [](const F& f) { return std::string_view(f.source); },
                 TextSize::kPage},
       "Where the measured values come from; may be left out."},

      {"target", "bulk_density_kg_m3", "bulk_density_kg_m3",
       NumberValue{SoilTargetRanges::bulk_density_kg_m3, [](F& f, double v) { f.target.bulk_density_kg_m3 = v; },
                   [](const F& f) { return f.target.bulk_density_kg_m3; }},
       "Bulk density."},
      {"target", "friction_angle_deg", "friction_angle_deg",
       NumberValue{SoilTargetRanges::friction_angle_deg, [](F& f, double v) { f.target.friction_angle_deg = v; },
                   [](const F& f) { return f.target.friction_angle_deg; }},
       "Angle of internal friction."},
      {"target", "friction_angle_range_deg", "friction_angle_range_deg",
       IntervalValue{SoilTargetRanges::friction_angle_deg,
                     [](F& f, const Range& v) { f.target.friction_angle_range_deg = v; },
                     [](const F& f) { return f.target.friction_angle_range_deg; }},
       "Its uncertainty as the source gives it; may be left out."},
      {"target", "cohesion_pa", "cohesion_pa",
       NumberValue{SoilTargetRanges::cohesion_pa, [](F& f, double v) { f.target.cohesion_pa = v; },
                   [](const F& f) { return f.target.cohesion_pa; }},
       "Cohesion."},
      {"target", "cohesion_range_pa", "cohesion_range_pa",
       IntervalValue{SoilTargetRanges::cohesion_pa, [](F& f, const Range& v) { f.target.cohesion_range_pa = v; },
                     [](const F& f) { return f.target.cohesion_range_pa; }},
       "Its uncertainty as the source gives it; may be left out."},
      {"target", "strength", "",
       WordValue{namesOf(kSoilStrengthWords),
                 [](F& f, std::string_view v) { f.target.strength = valueOf(kSoilStrengthWords, v); },
                 [](const F& f) { return wordFor(kSoilStrengthWords, f.target.strength); }},
       "Which strength the target is: after long shearing, or the greatest; left out: `residual`."},

      {"reached", "friction_angle_deg", "friction_angle_deg",
       NumberValue{SoilTargetRanges::friction_angle_deg, [](F& f, double v) { reachedBy(f).friction_angle_deg = v; },
                   [](const F& f) { return f.reached->friction_angle_deg; }},
       "Angle of internal friction, mean over the seeds."},
      {"reached", "friction_angle_sd_deg", "friction_angle_sd_deg",
       NumberValue{SoilTargetRanges::friction_angle_deg, [](F& f, double v) { reachedBy(f).friction_angle_sd_deg = v; },
                   [](const F& f) { return f.reached->friction_angle_sd_deg; }},
       "Its standard deviation."},
      // A straight line through scattered strengths may meet the axis a little below zero.
      {"reached", "cohesion_pa", "cohesion_pa",
       NumberValue{{-SoilTargetRanges::cohesion_pa.highest, SoilTargetRanges::cohesion_pa.highest},
                   [](F& f, double v) { reachedBy(f).cohesion_pa = v; },
                   [](const F& f) { return f.reached->cohesion_pa; }},
       "Cohesion, mean over the seeds."},
      {"reached", "cohesion_sd_pa", "cohesion_sd_pa",
       NumberValue{SoilTargetRanges::cohesion_pa, [](F& f, double v) { reachedBy(f).cohesion_sd_pa = v; },
                   [](const F& f) { return f.reached->cohesion_sd_pa; }},
       "Its standard deviation."},
      {"reached", "bulk_density_kg_m3", "bulk_density_kg_m3",
       NumberValue{SoilTargetRanges::bulk_density_kg_m3, [](F& f, double v) { reachedBy(f).bulk_density_kg_m3 = v; },
                   [](const F& f) { return f.reached->bulk_density_kg_m3; }},
       "Bulk density, mean over the seeds."},
      {"reached", "seeds", "seeds",
       CountValue{{1, 1e6},
                  [](F& f, std::int64_t v) { reachedBy(f).seeds = static_cast<int>(v); },
                  [](const F& f) { return static_cast<std::int64_t>(f.reached->seeds); }},
       "Number of beds, each from another seed."},
  };
}

/// What can be written is the soil's own; a preset, a name or a file is a scene's way to choose one.
bool belongsToSoil(const ScenarioKey& key) {
  const auto* number = std::get_if<ScenarioKey::NumberValue>(&key.value);
  const auto* word = std::get_if<ScenarioKey::WordValue>(&key.value);
  return key.table == "soil" &&
         ((number != nullptr && number->get != nullptr) || (word != nullptr && word->get != nullptr));
}

}  // namespace

std::span<const SoilFileKey> soilFileKeys() {
  static const std::vector<SoilFileKey> kKeys = allSoilFileKeys();
  return kKeys;
}

std::span<const ScenarioKey> soilKeys() {
  static const std::vector<ScenarioKey> kKeys = [] {
    std::vector<ScenarioKey> keys;
    std::ranges::copy_if(scenarioKeys(), std::back_inserter(keys), belongsToSoil);
    return keys;
  }();
  return kKeys;
}

}  // namespace haptolith

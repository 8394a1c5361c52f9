#include "haptolith/scene_file/soil_file_keys.h"

#include <algorithm>
#include <iterator>

#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/toml/member_keys.h"

namespace haptolith {

namespace {

std::vector<SoilFileKey> allSoilFileKeys() {
  using Target = SoilTarget;
  using Reached = SoilReached;
  using Ranges = SoilTargetRanges;
  const auto file = memberKeys<SoilFile>("");
  const auto target = memberKeys<SoilFile>("target", &SoilFile::target);
  const auto reached = memberKeys<SoilFile>("reached", &SoilFile::reached);
  std::vector<SoilFileKey> keys{
      file.text("name", &SoilFile::name, "Name of the soil."),
      file.text("source", &SoilFile::source, "Source of the measured values; can be left out.", TextSize::kPage),

      target.number("bulk_density_kg_m3", &Target::bulk_density_kg_m3, Ranges::bulk_density_kg_m3, "Bulk density."),
      target.number("friction_angle_deg", &Target::friction_angle_deg, Ranges::friction_angle_deg,
                    "Angle of internal friction."),
      target.interval("friction_angle_range_deg", &Target::friction_angle_range_deg, Ranges::friction_angle_deg,
                      "Its uncertainty as the source gives it; may be left out."),
      target.number("cohesion_pa", &Target::cohesion_pa, Ranges::cohesion_pa, "Cohesion."),
      target.interval("cohesion_range_pa", &Target::cohesion_range_pa, Ranges::cohesion_pa,
                      "Its uncertainty as the source gives it; may be left out."),
      target.word("strength", &Target::strength, kSoilStrengthWords,
                  "Strength of the target: after large strain, or peak; left out: `residual`."),

      reached.number("friction_angle_deg", &Reached::friction_angle_deg, Ranges::friction_angle_deg,
                     "Angle of internal friction, mean over the seeds."),
      reached.number("friction_angle_sd_deg", &Reached::friction_angle_sd_deg, Ranges::friction_angle_deg,
                     "Its standard deviation."),
      // A straight line through scattered strengths may meet the axis a little below zero.
      reached.number("cohesion_pa", &Reached::cohesion_pa, {-Ranges::cohesion_pa.highest, Ranges::cohesion_pa.highest},
                     "Cohesion, mean over the seeds."),
      reached.number("cohesion_sd_pa", &Reached::cohesion_sd_pa, Ranges::cohesion_pa, "Its standard deviation."),
      reached.number("bulk_density_kg_m3", &Reached::bulk_density_kg_m3, Ranges::bulk_density_kg_m3,
                     "Bulk density, mean over the seeds."),
      reached.count("seeds", &Reached::seeds, {1, 1e6}, "Number of beds, each from another seed."),
  };
  keys[0].parameter = keys[0].name;
  keys[1].parameter = keys[1].name;
  return keys;
}

/// What can be written is the soil's own; a preset, a name or a file is a scene's way to choose one.
bool belongsToSoil(const SceneFileKey& key) {
  const auto* number = std::get_if<SceneFileKey::NumberValue>(&key.value);
  const auto* word = std::get_if<SceneFileKey::WordValue>(&key.value);
  return key.table == "soil" &&
         ((number != nullptr && number->get != nullptr) || (word != nullptr && word->get != nullptr));
}

}  // namespace

std::span<const SoilFileKey> soilFileKeys() {
  static const std::vector<SoilFileKey> kKeys = allSoilFileKeys();
  return kKeys;
}

std::span<const SceneFileKey> soilKeys() {
  static const std::vector<SceneFileKey> kKeys = [] {
    std::vector<SceneFileKey> keys;
    std::ranges::copy_if(sceneFileKeys(), std::back_inserter(keys), belongsToSoil);
    return keys;
  }();
  return kKeys;
}

}  // namespace haptolith

#include "haptolith/study/protocol/protocol_levels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"
#include "haptolith/soil/strength.h"

namespace haptolith {

namespace {

/// Quantity that a block may vary: its name in messages and on axes, and the stimulus for a word or number in the file.
struct Variation {
  std::string_view levels_are, axis_label;
  Stimulus (*stimulus)(std::string_view varies, const TextOrNumber& level);
};

Stimulus presetStimulus(std::string_view /*varies*/, const TextOrNumber& level) {
  const Preset& preset = findPreset(level.text);
  return {.name = std::string(preset.name),
          .value = preset.friction_coefficient,
          .change = {.preset = std::string(preset.name)}};
}

Stimulus bodyStimulus(std::string_view /*varies*/, const TextOrNumber& level) {
  const Body& body = findBody(level.text);
  return {.name = std::string(body.name), .value = body.gravity_m_s2, .change = {.body = std::string(body.name)}};
}

Stimulus soilStimulus(std::string_view /*varies*/, const TextOrNumber& level) {
  const std::vector<std::string> names = soilNames();  // a file next to the protocol would not be stored in the study
  if (std::ranges::find(names, level.text) == names.end()) {
    throw InvalidParameter("soil", fmt::format("'{}'", level.text), fmt::format("one of {}", fmt::join(names, ", ")));
  }
  return {.name = level.text, .value = 0, .change = {.soil = level.text}};
}

Stimulus sliderStimulus(std::string_view varies, const TextOrNumber& level) {
  if (!level.number) {
    throw InvalidParameter(std::string(varies), fmt::format("'{}'", level.text), "a number");
  }
  return {.name = level.text, .value = *level.number, .change = {.sliders = {{std::string(varies), *level.number}}}};
}

Stimulus frictionStimulus(std::string_view varies, const TextOrNumber& level) {
  Stimulus stimulus = sliderStimulus(varies, level);
  constexpr double kPerDegree = std::numbers::pi / 180;
  stimulus.change.sliders = {{"friction_angle_deg", frictionAngle(stimulus.value) / kPerDegree}};
  return stimulus;
}

const SceneNumber* sceneNumberNamed(std::string_view key) {
  const std::span<const SceneNumber> numbers = sceneNumbers();
  const auto found = std::ranges::find(numbers, key, &SceneNumber::key);
  return found == numbers.end() ? nullptr : &*found;
}

Stimulus sceneStimulus(std::string_view varies, const TextOrNumber& level) {
  Stimulus stimulus = sliderStimulus(varies, level);
  const SceneNumber& number = *sceneNumberNamed(varies);
  stimulus.change = {};
  stimulus.change.*number.member = stimulus.value * number.unit;
  return stimulus;
}

/// Quantity that a block may vary, other than numbers of the soil with a slider and numbers of the scene.
struct NamedVariation {
  std::string_view key;
  Variation variation;
};
constexpr std::array kVariations{
    NamedVariation{"preset", {"presets", "friction coefficient", presetStimulus}},
    NamedVariation{"body", {"bodies", "gravity (m/s²)", bodyStimulus}},
    NamedVariation{"soil", {"soils by name", "", soilStimulus}},
    NamedVariation{"friction_coefficient", {"numbers", "friction coefficient, tan φ", frictionStimulus}},
    NamedVariation{"friction_angle_deg", {"numbers", "friction angle (°)", sliderStimulus}},
    NamedVariation{"cohesion_pa", {"numbers", "cohesion (Pa)", sliderStimulus}},
};

/// @param varies  one of variedThings()
Variation variationOf(std::string_view varies) {
  if (const SceneNumber* number = sceneNumberNamed(varies)) {
    return {"numbers", number->axis_label, sceneStimulus};
  }
  if (const auto named = std::ranges::find(kVariations, varies, &NamedVariation::key); named != kVariations.end()) {
    return named->variation;
  }
  const auto varied = [&](const SoilNumber& number) { return number.control.key == varies; };
  return {"numbers", std::ranges::find_if(kSoilNumbers, varied)->control.axis_label, sliderStimulus};
}

/// Returns the stimulus for a level. @throws InvalidParameter with the key that contains it.
Stimulus stimulusOf(const BlockDraft& draft, std::string_view key, const TextOrNumber& level) {
  const Variation variation = variationOf(draft.varies);
  try {
    return variation.stimulus(draft.varies, level);
  } catch (const InvalidParameter& error) {
    throw InvalidParameter(std::string(key), error.value(),
                           fmt::format("{}; {} is not: {}", variation.levels_are, error.value(), error.valid()));
  }
}

void readReference(BlockDraft& draft) {
  if (draft.reference.size() != 1) {
    throw InvalidParameter("reference", "", "one name or number");
  }
  draft.block.reference = stimulusOf(draft, "reference", draft.reference.front());
  if (draft.reference_value) {
    draft.block.reference.value = *draft.reference_value;
  } else if (draft.varies == "soil" || !draft.values.empty()) {
    throw InvalidParameter("reference_value", "nothing", "given, because the levels have `values`");
  }
}

void readLevels(BlockDraft& draft) {
  for (const TextOrNumber& level : draft.levels) {
    draft.block.levels.push_back(stimulusOf(draft, "levels", level));
  }
  if (draft.levels.size() < 2) {
    throw InvalidParameter("levels", "", "two or more: a curve needs two levels");
  }
  if (draft.values.empty() && (draft.varies == "soil" || draft.reference_value)) {
    throw InvalidParameter("values", "nothing", "given: the value of each level on the axis");
  }
  if (draft.values.empty()) {
    return;
  }
  if (draft.values.size() != draft.levels.size()) {
    throw InvalidParameter("values", "", fmt::format("as many numbers as there are levels, {}", draft.levels.size()));
  }
  for (std::size_t i = 0; i < draft.values.size(); ++i) {
    if (!draft.values[i].number) {
      throw InvalidParameter("values", "", fmt::format("numbers; '{}' is not a number", draft.values[i].text));
    }
    draft.block.levels[i].value = *draft.values[i].number;
  }
}

/// Returns the stimuli of practice or catch trials: levels, with their values, or other stimuli of this kind.
std::vector<Stimulus> easyLevels(const BlockDraft& draft, const char* key, const std::vector<TextOrNumber>& items) {
  const bool has_places = draft.values.empty();  // axis positions that follow from the name or number
  std::vector<Stimulus> stimuli;
  for (const TextOrNumber& wanted : items) {
    Stimulus stimulus = stimulusOf(draft, key, wanted);
    const auto level = std::ranges::find(draft.block.levels, stimulus.name, &Stimulus::name);
    if (level != draft.block.levels.end()) {
      stimulus = *level;
    } else if (!has_places) {
      throw InvalidParameter(key, wanted.text, "one of the levels, because the levels have `values`");
    }
    if (stimulus.value == draft.block.reference.value) {
      throw InvalidParameter(key, wanted.text, "another than the reference");
    }
    stimuli.push_back(std::move(stimulus));
  }
  return stimuli;
}

void sortLevels(StudyBlock& block) {
  std::ranges::stable_sort(block.levels, {}, &Stimulus::value);
  for (std::size_t i = 1; i < block.levels.size(); ++i) {
    const Stimulus& one = block.levels[i - 1];
    const Stimulus& other = block.levels[i];
    if (one.value == other.value) {
      throw InvalidParameter("levels", "",
                             one.name == other.name ? fmt::format("each once; {} occurs twice", one.name)
                                                    : fmt::format("apart on the axis; {} and {} are both {}", one.name,
                                                                  other.name, one.value));
    }
  }
}

}  // namespace

std::vector<std::string_view> variedThings() {
  std::vector<std::string_view> things;
  std::ranges::transform(kVariations, std::back_inserter(things), &NamedVariation::key);
  for (const SoilNumber& number : kSoilNumbers) {
    if (!number.control.key.empty()) {
      things.push_back(number.control.key);
    }
  }
  std::ranges::transform(sceneNumbers(), std::back_inserter(things), &SceneNumber::key);
  return things;
}

std::string_view axisLabelOf(std::string_view varies) {
  return variationOf(varies).axis_label;
}

void readStimuli(BlockDraft& draft) {
  readReference(draft);
  readLevels(draft);
  draft.block.practice_levels = easyLevels(draft, "practice_levels", draft.practice_levels);
  draft.block.catch_levels = easyLevels(draft, "catch_levels", draft.catch_levels);
  sortLevels(draft.block);
}

}  // namespace haptolith

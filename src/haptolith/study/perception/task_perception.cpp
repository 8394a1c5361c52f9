#include "haptolith/study/perception/task_perception.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <span>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/process/in_parallel.h"

namespace haptolith {

namespace {

/// Haptic or visual cue of an exploration, with its sense.
struct AnyCue {
  std::string_view name, unit;
  Sense sense;
  double (*sensed)(const Exploration&) = nullptr;
  double (*seen)(const Picture&) = nullptr;
  bool of_tool = false;

  [[nodiscard]] double operator()(const Exploration& one) const {
    return sensed != nullptr ? sensed(one) : seen(one.seen);
  }
};

using Explorations = std::vector<Exploration>;

/// Returns the cues that are available in every exploration.
std::vector<AnyCue> cuesOf(const std::vector<Explorations>& stimuli, bool seen, double sense_scale) {
  std::vector<AnyCue> all;
  if (seen) {
    for (const SeenCue& cue : seenCues()) {
      all.push_back({cue.name, cue.unit, cue.sense, nullptr, cue.value, cue.of_tool});
    }
  } else {
    for (const std::span<const Cue> of_hand : {cues(), placeCues()}) {
      for (const Cue& cue : of_hand) {
        all.push_back({cue.name, cue.unit, cue.sense, cue.value, nullptr, false});
      }
    }
  }
  std::erase_if(all, [&](const AnyCue& cue) {
    return std::ranges::any_of(stimuli, [&](const Explorations& explorations) {
      return std::ranges::any_of(explorations, [&](const Exploration& one) { return !std::isfinite(cue(one)); });
    });
  });
  for (AnyCue& cue : all) {
    cue.sense.weber_fraction *= sense_scale;
    cue.sense.threshold *= sense_scale;
  }
  return all;
}

SensedStimulus magnitudesOf(const Explorations& explorations, std::span<const AnyCue> cues) {
  SensedStimulus stimulus;
  for (const Exploration& one : explorations) {
    std::vector<double>& magnitudes = stimulus.magnitudes.emplace_back();
    for (const AnyCue& cue : cues) {
      magnitudes.push_back(cue(one));
    }
  }
  return stimulus;
}

double meanOf(const Explorations& explorations, const AnyCue& cue) {
  double sum = 0;
  for (const Exploration& one : explorations) {
    sum += cue(one);
  }
  return sum / static_cast<double>(explorations.size());
}

Detectability detectability(const Explorations& reference, const Explorations& test, std::span<const AnyCue> cues,
                            const ObserverOptions& options) {
  std::vector<Sense> senses;
  std::ranges::transform(cues, std::back_inserter(senses), &AnyCue::sense);
  const PairDiscrimination pair =
      discriminatePair(magnitudesOf(reference, cues), magnitudesOf(test, cues), senses, options);
  return {.d_prime = dPrime(pair.jnds),
          .interval = {.low = dPrime(pair.interval.low), .high = dPrime(pair.interval.high)}};
}

/// Returns explorations of every scene: [scene][repeat].
std::vector<Explorations> exploreAll(const std::vector<SceneFile>& scenes, const TaskOptions& options,
                                     const PerceptionProgress& progress) {
  const auto repeats = static_cast<std::size_t>(options.repeats);
  const std::size_t beds = static_cast<std::size_t>(std::min(options.beds, options.repeats));
  std::vector<Explorations> all(scenes.size(), Explorations(repeats));
  std::mutex mutex;
  std::size_t done = 0;
  inParallel(scenes.size() * beds, options.threads, [&](std::size_t i) {
    SceneFile scene = scenes[i / beds];
    const std::size_t number = i % beds;
    scene.bed.seed = options.seed + number;
    const LevelBed bed = levelBed(scene);
    for (std::size_t repeat = number; repeat < repeats; repeat += beds) {
      all[i / beds][repeat] =
          explore(scene, bed, {.motion = scene.hand.motion, .rounds = options.rounds, .seed = options.seed + repeat});
      const std::scoped_lock lock(mutex);
      ++done;
      if (progress && !progress(static_cast<double>(done) / static_cast<double>(scenes.size() * repeats))) {
        throw Failure("interrupted before the exploration was complete");
      }
    }
  });
  return all;
}

}  // namespace

TaskPerception perceiveTask(const StudyProtocol& protocol, const StudyBlock& block, const TaskOptions& options,
                            const PerceptionProgress& progress) {
  requireInRange("repeats", options.repeats, {4, 100'000});
  requireInRange("beds", options.beds, {1, 1000});
  requireInRange("sense_scale", options.perceive.sense_scale, {0.1, 10});
  std::vector<SceneFile> scenes{sceneOf(protocol, block, block.reference)};
  for (const Stimulus& level : block.levels) {
    scenes.push_back(sceneOf(protocol, block, level));
  }
  const std::vector<Explorations> explored = exploreAll(scenes, options, progress);

  TaskPerception found{.block = block.name,
                       .reference = block.reference.name,
                       .axis_label = block.axis_label,
                       .hand = protocol.scene.hand.motion,
                       .duration_s = options.rounds * protocol.scene.hand.period_s,
                       .levels = {},
                       .cues = {}};
  const std::vector<AnyCue> sensed = cuesOf(explored, false, options.perceive.sense_scale);
  const std::vector<AnyCue> seen = cuesOf(explored, true, options.perceive.sense_scale);
  std::vector<AnyCue> seen_of_soil = seen;
  std::erase_if(seen_of_soil, [](const AnyCue& cue) { return cue.of_tool; });
  for (std::size_t i = 0; i < block.levels.size(); ++i) {
    found.levels.push_back(
        {.name = block.levels[i].name,
         .value = block.levels[i].value,
         .force = detectability(explored[0], explored[i + 1], sensed, options.perceive.observer),
         .picture = detectability(explored[0], explored[i + 1], seen, options.perceive.observer),
         .soil_picture = detectability(explored[0], explored[i + 1], seen_of_soil, options.perceive.observer)});
  }
  for (const std::vector<AnyCue>* cues : {&sensed, &seen}) {
    for (const AnyCue& cue : *cues) {
      TaskCue mean{.name = std::string(cue.name),
                   .unit = std::string(cue.unit),
                   .is_seen = cue.seen != nullptr,
                   .reference = meanOf(explored[0], cue),
                   .levels = {}};
      for (std::size_t i = 0; i < block.levels.size(); ++i) {
        mean.levels.push_back(meanOf(explored[i + 1], cue));
      }
      found.cues.push_back(std::move(mean));
    }
  }
  return found;
}

}  // namespace haptolith

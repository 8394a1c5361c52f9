#include "haptolith/study/perception/perception.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "haptolith/core/error.h"
#include "haptolith/core/process/in_parallel.h"
#include "haptolith/core/statistics.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/contact_strength.h"
#include "haptolith/soil/presets.h"

namespace haptolith {

namespace {

constexpr std::string_view kFrictionReference = "P3", kGravityReference = "Moon", kGravityPreset = "P4";

/// Number of beds of a scene that starts by rain: each arrangement feels slightly different. A crystal has one bed.
constexpr int kBedsOfRain = 5;

/// Contact friction at which cohesionless soil has the peak friction angle of a preset: docs/reports/perception.md.
struct Twin {
  std::string_view preset;
  double contact_friction;
};
constexpr std::array kTwins{Twin{"P1", 0.571}, Twin{"P2", 0.452}, Twin{"P3", 0.357},
                            Twin{"P4", 0.307}, Twin{"P5", 0.261}, Twin{"P6", 0.234}};

/// Returns the preset's soil with contact friction: the contacts of the named soils, and a density of 1500 kg/m^3.
SoilParameters contactFrictionTwin(std::string_view preset, double contact_cohesion_n) {
  SoilParameters soil = lunarContacts();
  soil.contact_friction = std::ranges::find(kTwins, preset, &Twin::preset)->contact_friction;
  soil.contact_cohesion_n = contact_cohesion_n;
  return soil;
}

SceneFile sceneFor(std::string_view preset, std::string_view body, FrictionModel friction, double contact_cohesion_n) {
  SceneFile scene;
  changePreset(scene, preset);
  changeBody(scene, body);
  if (friction == FrictionModel::kContact) {
    SoilFile twin;
    twin.name = fmt::format("{} contact", preset);
    twin.soil = contactFrictionTwin(preset, contact_cohesion_n);
    setSoil(scene, twin);
  }
  return scene;
}

PerceptionBlock blockOf(const std::string& name, FrictionModel friction, double contact_cohesion_n) {
  PerceptionBlock block{.name = name, .friction = friction, .stimuli = {}};
  if (name == "friction") {
    for (const Preset& preset : presets()) {
      block.stimuli.push_back({std::string(preset.name), preset.friction_coefficient,
                               sceneFor(preset.name, kGravityReference, friction, contact_cohesion_n)});
    }
  } else {
    for (const Body& body : bodies()) {
      block.stimuli.push_back({std::string(body.name), body.gravity_m_s2,
                               sceneFor(kGravityPreset, body.name, friction, contact_cohesion_n)});
    }
  }
  std::ranges::sort(block.stimuli, {}, &PerceptionStimulus::x);
  const std::string_view reference = name == "friction" ? kFrictionReference : kGravityReference;
  const auto at = std::ranges::find(block.stimuli, reference, &PerceptionStimulus::name);
  block.reference = static_cast<std::size_t>(at - block.stimuli.begin());
  return block;
}

/// Returns the hand for a motion: deep and stiff for scooping, else the scene's hand with its measured compliance.
HandParameters handFor(HandMotion motion, HandParameters hand) {
  if (motion == HandMotion::kScoop) {
    hand.depth_m = 0.032;
    hand.stiffness_n_m = 400;
    hand.damping_n_s_m = 15;
  }
  return hand;
}

/// Counts pieces of work that run in parallel.
class Progress {
 public:
  Progress(const PerceptionProgress& tell, std::size_t pieces) : tell_(tell), pieces_(pieces) {}

  void requireWanted() {
    const std::scoped_lock lock(mutex_);
    if (tell_ && !tell_(static_cast<double>(done_) / static_cast<double>(pieces_))) {
      throw Failure("interrupted before the exploration was complete");
    }
  }
  void finished() {
    const std::scoped_lock lock(mutex_);
    ++done_;
  }

 private:
  const PerceptionProgress& tell_;
  std::size_t pieces_, done_ = 0;
  std::mutex mutex_;
};

/// Stimulus and the beds on which it is explored.
struct Site {
  PerceptionStimulus* stimulus;
  std::vector<std::vector<Exploration>>* explorations;
  std::vector<LevelBed> beds = {};
};

/// Cue of the hand with this index.
struct HandsCue {
  std::size_t hand = 0;
  const Cue* cue = nullptr;
};

std::vector<SensedStimulus> sensedBy(const PerceptionBlock& block, std::span<const HandsCue> judged) {
  std::vector<SensedStimulus> sensed;
  sensed.reserve(block.stimuli.size());
  for (std::size_t i = 0; i < block.stimuli.size(); ++i) {
    SensedStimulus stimulus{.x = block.stimuli[i].x};
    stimulus.magnitudes.resize(block.explorations[i].front().size());
    for (std::size_t repeat = 0; repeat < stimulus.magnitudes.size(); ++repeat) {
      for (const HandsCue& one : judged) {
        stimulus.magnitudes[repeat].push_back(one.cue->value(block.explorations[i][one.hand][repeat]));
      }
    }
    sensed.push_back(std::move(stimulus));
  }
  return sensed;
}

/// Computes mean and standard deviation of a cue for each stimulus.
PerceivedCue statisticsOf(const PerceptionBlock& block, const HandsCue& of) {
  PerceivedCue one{.hand = {}, .cue = of.cue, .means = {}, .deviations = {}, .discrimination = {}};
  for (const SensedStimulus& stimulus : sensedBy(block, std::span(&of, 1))) {
    std::vector<double> magnitudes;
    for (const std::vector<double>& exploration : stimulus.magnitudes) {
      magnitudes.push_back(exploration.front());
    }
    one.means.push_back(mean(magnitudes));
    one.deviations.push_back(standardDeviation(magnitudes));
  }
  return one;
}

}  // namespace

std::vector<PerceptionBlock> explorePaperStimuli(const PerceptionOptions& options, const PerceptionProgress& progress) {
  requireInRange("repeats", options.repeats, {2, 100'000});
  std::vector<PerceptionBlock> blocks;
  for (const std::string& name : options.blocks) {
    for (const FrictionModel friction : options.frictions) {
      blocks.push_back(blockOf(name, friction, options.contact_cohesion_n));
    }
  }
  const auto repeats = static_cast<std::size_t>(options.repeats);
  const std::size_t hands = options.hands.size();
  std::vector<Site> sites;
  for (PerceptionBlock& block : blocks) {
    const std::vector<std::vector<Exploration>> none(hands, std::vector<Exploration>(repeats));
    block.explorations.assign(block.stimuli.size(), none);
    for (std::size_t i = 0; i < block.stimuli.size(); ++i) {
      sites.push_back({.stimulus = &block.stimuli[i], .explorations = &block.explorations[i]});
    }
  }
  Progress done(progress, sites.size() * (1 + hands * repeats));

  inParallel(sites.size(), options.threads, [&](std::size_t i) {
    SceneFile scene = sites[i].stimulus->scene;
    const int beds = scene.bed.start == BedStart::kRain ? std::min(kBedsOfRain, options.repeats) : 1;
    for (int bed = 0; bed < beds; ++bed) {
      done.requireWanted();
      scene.bed.seed = options.seed + static_cast<std::uint64_t>(bed);
      sites[i].beds.push_back(levelBed(scene));
    }
    done.finished();
  });
  inParallel(sites.size() * hands * repeats, options.threads, [&](std::size_t i) {
    done.requireWanted();
    const Site& site = sites[i / (hands * repeats)];
    const std::size_t hand = i / repeats % hands;
    const std::size_t repeat = i % repeats;
    SceneFile scene = site.stimulus->scene;
    const std::size_t bed = repeat % site.beds.size();
    scene.bed.seed = options.seed + bed;
    scene.hand = handFor(options.hands[hand], scene.hand);
    (*site.explorations)[hand][repeat] =
        explore(scene, site.beds[bed],
                {.motion = options.hands[hand], .rounds = options.rounds, .seed = options.seed + repeat});
    done.finished();
  });
  return blocks;
}

std::vector<PerceivedCue> perceive(const PerceptionBlock& block, const std::vector<HandMotion>& hands,
                                   const PerceiveOptions& options) {
  requireInRange("sense_scale", options.sense_scale, {0.1, 10});
  std::vector<PerceivedCue> perceived;
  const auto judge = [&](std::span<const HandsCue> judged) {
    std::vector<Sense> senses;
    senses.reserve(judged.size());
    for (const HandsCue& one : judged) {
      senses.push_back({.weber_fraction = options.sense_scale * one.cue->sense.weber_fraction,
                        .threshold = options.sense_scale * one.cue->sense.threshold});
    }
    return discriminate(sensedBy(block, judged), block.reference, senses, options.observer);
  };
  std::vector<HandsCue> of_all_hands;
  for (std::size_t hand = 0; hand < hands.size(); ++hand) {
    std::vector<HandsCue> of_hand;
    for (const Cue& cue : cues()) {
      PerceivedCue one = statisticsOf(block, {hand, &cue});
      if (std::ranges::all_of(one.means, [](double mean) { return std::isfinite(mean); })) {
        of_hand.push_back({hand, &cue});
        one.hand = hands[hand];
        one.discrimination = judge(std::span(&of_hand.back(), 1));
        perceived.push_back(std::move(one));
      }
    }
    perceived.push_back(
        {.hand = hands[hand], .cue = nullptr, .means = {}, .deviations = {}, .discrimination = judge(of_hand)});
    of_all_hands.insert(of_all_hands.end(), of_hand.begin(), of_hand.end());
  }
  if (hands.size() > 1) {
    perceived.push_back(
        {.hand = {}, .cue = nullptr, .means = {}, .deviations = {}, .discrimination = judge(of_all_hands)});
  }
  return perceived;
}

std::string nameOf(const PerceivedCue& perceived) {
  return fmt::format("{}, {}", perceived.hand ? wordFor(kHandMotionWords, *perceived.hand) : "all hands",
                     perceived.cue != nullptr ? perceived.cue->name : "all cues");
}

ParticipantsWeberFraction participantsWeberFraction(std::string_view block) {
  const double told = block == "friction" ? 0.29 : 3.31;  // icra2021, III
  return {.as_meant = told,
          .as_printed = std::exp(std::sqrt(std::log(1 + told))) - 1,
          .as_printed_log10 = std::pow(10, std::sqrt(std::log10(1 + told))) - 1};
}

}  // namespace haptolith

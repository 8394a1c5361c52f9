#include "haptolith/study/perception.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "haptolith/core/error.h"
#include "haptolith/core/in_parallel.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"

namespace haptolith {

namespace {

constexpr std::string_view kFrictionReference = "P3", kGravityReference = "Moon", kGravityPreset = "P4";

/// A crystal has one bed; rain falls differently every time, and each arrangement feels a little different.
constexpr int kBedsOfRain = 5;

/// Contact friction with which cohesionless soil shows a preset's angle of friction at its peak: docs/perception.md.
struct Twin {
  std::string_view preset;
  double contact_friction;
};
constexpr std::array kTwins{Twin{"P1", 0.571}, Twin{"P2", 0.452}, Twin{"P3", 0.357},
                            Twin{"P4", 0.307}, Twin{"P5", 0.261}, Twin{"P6", 0.234}};

/// The preset's soil with friction between its particles: contacts as those of the named soils, and 1500 kg/m^3.
SoilParameters contactFrictionTwin(std::string_view preset, double contact_cohesion_n) {
  SoilParameters soil;
  soil.gamma_nm = 6e-5;
  soil.rho0_kg_m3 = 1430;
  soil.rho_max_kg_m3 = 1840;
  soil.stiffness_n_m = 3000;
  soil.friction = FrictionModel::kContact;
  soil.size_spread = 0.15;
  soil.contact_friction = std::ranges::find(kTwins, preset, &Twin::preset)->contact_friction;
  soil.contact_cohesion_n = contact_cohesion_n;
  return soil;
}

Scenario sceneFor(std::string_view preset, std::string_view body, FrictionModel friction, double contact_cohesion_n) {
  Scenario scene;
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

/// Who lifts soil digs deep and holds the tool firmly; else the scene's hand, which is as limp as a measured one.
HandParameters handFor(Manoeuvre manoeuvre, HandParameters hand) {
  if (manoeuvre == Manoeuvre::kScoop) {
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
      throw Failure("given up before all was explored");
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

/// A stimulus, and the beds on which it is explored.
struct Site {
  PerceptionStimulus* stimulus;
  std::vector<std::vector<Exploration>>* explorations;
  std::vector<LevelBed> beds = {};
};

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
    Scenario scene = sites[i].stimulus->scene;
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
    Scenario scene = site.stimulus->scene;
    const std::size_t bed = repeat % site.beds.size();
    scene.bed.seed = options.seed + bed;
    scene.hand = handFor(options.hands[hand], scene.hand);
    (*site.explorations)[hand][repeat] =
        explore(scene, site.beds[bed],
                {.manoeuvre = options.hands[hand], .rounds = options.rounds, .seed = options.seed + repeat});
    done.finished();
  });
  return blocks;
}

std::vector<PerceivedCue> perceive(const PerceptionBlock& block, const std::vector<Manoeuvre>& hands) {
  std::vector<PerceivedCue> perceived;
  for (std::size_t hand = 0; hand < hands.size(); ++hand) {
    for (const Cue& cue : cues()) {
      PerceivedCue one{.hand = hands[hand], .cue = &cue, .means = {}, .deviations = {}, .discrimination = {}};
      std::vector<FeltStimulus> felt;
      for (std::size_t i = 0; i < block.stimuli.size(); ++i) {
        FeltStimulus stimulus{.x = block.stimuli[i].x};
        double sum = 0, sum_of_squares = 0;
        for (const Exploration& exploration : block.explorations[i][hand]) {
          stimulus.magnitudes.push_back(cue.value(exploration));
          sum += stimulus.magnitudes.back();
          sum_of_squares += stimulus.magnitudes.back() * stimulus.magnitudes.back();
        }
        const auto count = static_cast<double>(stimulus.magnitudes.size());
        one.means.push_back(sum / count);
        one.deviations.push_back(std::sqrt(std::max(0.0, (sum_of_squares - sum * sum / count) / (count - 1))));
        felt.push_back(std::move(stimulus));
      }
      if (std::ranges::all_of(one.means, [](double mean) { return std::isfinite(mean); })) {
        one.discrimination = discriminate(felt, block.reference, cue.sense);
        perceived.push_back(std::move(one));
      }
    }
  }
  return perceived;
}

double participantsWeberFraction(std::string_view block) {
  return block == "friction" ? 0.29 : 3.31;
}

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "haptolith/study/protocol/random_draws.h"
#include "haptolith/study/run/conductor.h"

namespace haptolith {

/// What the codes of simulated participants begin with, and no others.
inline constexpr const char* kSimulatedCode = "sim";

/// The scale after a block of work for a robot that a simulated participant answers by the error of force: at 1 less
/// the error of its length, give or take a tenth of it (normally distributed), within its ends.
inline constexpr const char* kTrustKey = "trust";

/// What a simulated participant judges by.
enum class JudgedBy {
  kValue,      ///< the stimulus' value on the block's axis, as if it were felt directly
  kMeanForce,  ///< what the hand felt: see TrialSummary
  kPeakForce,
  kWork,
};

/// A participant whose answers follow a known psychometric function: that of (paper 22), with lapses.
///
///     P("more") = lapse + (1 - 2 lapse) Phi(ln((1 + bias) x / p) / ln(1 + w))
///
/// Each of the two stimuli is felt with a noise of ln(1 + w) / sqrt(2) in its logarithm.
struct ObserverParameters {
  double weber_fraction = 0.29;  ///< w, > 0
  double bias = 0;               ///< > -1: the test feels like 1 + bias times what it is
  double lapse = 0;              ///< 0 to 1/2: both asymptotes; twice that are answers given without having felt
  double learning = 0;           ///< >= 0: w is larger by so much at the first trial; a third of it is left after
  double learning_trials = 20;   ///< so many trials, > 0
  double group_factor = 1;       ///< > 0: of w from one of the study's groups to the next in the protocol
  JudgedBy judged_by = JudgedBy::kValue;
};

/// @throws InvalidParameter for what is out of range.
void validate(const ObserverParameters& observer);

/// That observers who judge ratios can take part: by value, every reference and level is above 0.
/// @throws InvalidParameter with the block, the value and what is valid.
void requireRatios(const StudyProtocol& protocol, JudgedBy by);

/// A normally distributed number of mean 0 and standard deviation 1; the same on every machine (Box and Muller 1958).
[[nodiscard]] double normal(std::mt19937_64& random);

/// Judges pairs of stimuli.
class SimulatedObserver {
 public:
  SimulatedObserver(const ObserverParameters& observer, std::uint64_t seed);

  /// Whether the test is said to have more than the reference, both > 0.
  /// @param factor  of w now.
  [[nodiscard]] bool saysMore(double test, double reference, double factor = 1);

 private:
  ObserverParameters observer_;
  std::mt19937_64 random_;
  int trials_ = 0;
};

/// A rig without a bed, for observers who judge by value: every stimulus is there at once, and nothing is felt.
class RigWithoutBed final : public Rig {
 public:
  void show(const StudyBlock&, const Stimulus&) override {}
  [[nodiscard]] bool ready() override { return true; }
  void feel() override {}
  TrialSummary rest() override { return {}; }
  void pause() override {}
  void resume() override {}
  void startRecording(const std::filesystem::path&) override {}
  void stopRecording() override {}
  [[nodiscard]] double force() const override { return 0; }
  [[nodiscard]] std::uint32_t buttons() const override { return 0; }
  [[nodiscard]] bool pageMayHold() const override { return false; }
  [[nodiscard]] std::string deviceName() const override { return "none"; }
};

/// Takes part in a study from its first page to its last, as a person would, in no time.
class SimulatedParticipant {
 public:
  /// The study's clock, for ConductorOptions.
  [[nodiscard]] double now() const noexcept { return now_s_; }

  SimulatedParticipant(const ObserverParameters& observer, std::uint64_t seed)
      : observer_(observer, seed),
        by_(observer.judged_by),
        group_factor_(observer.group_factor),
        stratum_random_(seedOf({seed, static_cast<std::uint64_t>(Purpose::kGroups)})),
        trust_random_(seedOf({seed, static_cast<std::uint64_t>(Purpose::kTrust)})) {}

  /// Until the study is over for everyone who has begun. @throws Failure when it pauses with a problem;
  /// InvalidParameter for a block whose values an observer of ratios cannot judge.
  void takePart(Conductor& conductor);

 private:
  void step(Conductor& conductor);
  [[nodiscard]] double trust(const FormItem& item, const std::vector<TrialRow>& trials, const std::string& block);
  [[nodiscard]] int choose(const Conductor& conductor, const StudyState& now);

  SimulatedObserver observer_;
  JudgedBy by_;
  double group_factor_;
  std::mt19937_64 stratum_random_;  ///< apart from the observer's, whose answers are the same with and without strata
  std::mt19937_64 trust_random_;    ///< likewise
  double now_s_ = 0;
};

}  // namespace haptolith

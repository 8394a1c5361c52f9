#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "haptolith/study/protocol/random_draws.h"
#include "haptolith/study/run/conductor.h"

namespace haptolith {

/// Prefix of the codes of simulated participants, reserved for them.
inline constexpr const char* kSimulatedCode = "sim";

/// Key of the scale after a teleoperation block that a simulated participant answers by the force error e: at 1 - e of
/// the scale's length, with normally distributed noise (SD 0.1), clamped to its ends.
inline constexpr const char* kTrustKey = "trust";

/// Quantity by which a simulated participant judges.
enum class JudgedBy {
  kValue,      ///< the stimulus' value on the block's axis, as if sensed directly
  kMeanForce,  ///< mean force on the hand: see TrialSummary
  kPeakForce,
  kWork,
};

/// Simulated participant whose responses follow a known psychometric function: eq. (22) of icra2021, with lapses.
///
///     P("more") = lapse + (1 - 2 lapse) Phi(ln((1 + bias) x / p) / ln(1 + w))
///
/// Each of the two stimuli is sensed with noise of SD ln(1 + w) / sqrt(2) in its logarithm.
struct ObserverParameters {
  double weber_fraction = 0.29;  ///< w, > 0
  double bias = 0;               ///< > -1: the test is perceived as 1 + bias times its value
  double lapse = 0;     ///< 0 to 1/2: distance of the asymptotes from 0 and 1; half the rate of random responses
  double learning = 0;  ///< >= 0: relative increase of w at the first trial; decays by a factor e
  double learning_trials = 20;  ///< in this number of trials, > 0
  double group_factor = 1;      ///< > 0: ratio of w between consecutive groups of the protocol
  JudgedBy judged_by = JudgedBy::kValue;
};

/// Checks the ranges. @throws InvalidParameter for a value out of range.
void validate(const ObserverParameters& observer);

/// Checks that observers of ratios can judge the study: by value, every reference and level must be above 0.
/// @throws InvalidParameter with block, value and valid values.
void requireRatios(const StudyProtocol& protocol, JudgedBy by);

/// Draws a normally distributed number with mean 0 and SD 1, identical on every machine (Box and Muller 1958).
[[nodiscard]] double normal(std::mt19937_64& random);

/// Simulated judgement of pairs of stimuli.
class SimulatedObserver {
 public:
  SimulatedObserver(const ObserverParameters& observer, std::uint64_t seed);

  /// Judges whether the test has more than the reference, both > 0.
  /// @param factor  current factor on w.
  [[nodiscard]] bool saysMore(double test, double reference, double factor = 1);

 private:
  ObserverParameters observer_;
  std::mt19937_64 random_;
  int trials_ = 0;
};

/// Rig without a bed, for observers who judge by value: every stimulus is ready immediately, and no force is rendered.
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

/// Simulated participant of a study, from the first page to the last, in simulated time.
class SimulatedParticipant {
 public:
  /// Returns the time of the study's clock, for ConductorOptions.
  [[nodiscard]] double now() const noexcept { return now_s_; }

  SimulatedParticipant(const ObserverParameters& observer, std::uint64_t seed)
      : observer_(observer, seed),
        by_(observer.judged_by),
        group_factor_(observer.group_factor),
        stratum_random_(seedOf({seed, static_cast<std::uint64_t>(Purpose::kGroups)})),
        trust_random_(seedOf({seed, static_cast<std::uint64_t>(Purpose::kTrust)})) {}

  /// Takes part until the study is over for the current participant. @throws Failure if it pauses with a problem;
  /// InvalidParameter for a block whose values an observer of ratios cannot judge.
  void takePart(Conductor& conductor);

 private:
  void step(Conductor& conductor);
  [[nodiscard]] double trust(const FormItem& item, const std::vector<TrialRow>& trials, const std::string& block);
  [[nodiscard]] int choose(const Conductor& conductor, const StudyState& now);

  SimulatedObserver observer_;
  JudgedBy by_;
  double group_factor_;
  std::mt19937_64 stratum_random_;  ///< separate, so that the observer's responses do not depend on strata
  std::mt19937_64 trust_random_;    ///< separate, for the same reason
  double now_s_ = 0;
};

}  // namespace haptolith

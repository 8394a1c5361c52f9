#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/study/perception/exploration.h"

namespace haptolith {

/// Resolution of a sense, as measured in psychophysics.
struct Sense {
  double weber_fraction = 0;  ///< for magnitudes well above the threshold, > 0
  double threshold = 0;       ///< detection threshold, > 0, in the magnitude's unit
};

/// Quantity by which a hand could judge soil.
struct Cue {
  std::string_view name, unit, title;
  Sense sense;
  double (*value)(const Exploration&);
};

/// Returns the force cues of exploring hands, each with its sense; docs/reports/perception.md names the sources.
[[nodiscard]] std::span<const Cue> cues();

/// Returns the cues from the hand's position, each with its sense; used for studies' tasks, not for the stimuli of
/// icra2021.
[[nodiscard]] std::span<const Cue> placeCues();

/// Converts a magnitude to just noticeable differences (JNDs) above zero.
///
///     s(x) = arsinh(k x / x0) / k,  k = ln(1 + w)
///
/// Well above x0 / k it increases by 1 when x increases by the Weber fraction w (Fechner); near zero it is x / x0, so
/// that the threshold x0 is the first JND. Odd in x.
[[nodiscard]] double sensation(double magnitude, const Sense& sense) noexcept;

/// Returns the difference between the magnitudes `b` and `a` in JNDs. Each magnitude is from one exploration, and they
/// vary between explorations.
///
///     d = (mean s(b) - mean s(a)) / sqrt(1 + var s(a) + var s(b))
///
/// The 1 is the noise of the sense in a comparison, because one JND gives 84 % correct comparisons. Phi(d) is then the
/// fraction of comparisons in which an ideal observer calls b the greater one.
/// @throws InvalidParameter for fewer than two magnitudes on a side.
[[nodiscard]] double discriminability(std::span<const double> a, std::span<const double> b, const Sense& sense);

/// Quantity by which an observer could judge soil from vision alone.
struct SeenCue {
  std::string_view name, unit, title;
  Sense sense;
  double (*value)(const Picture&);
  bool of_tool = false;  ///< describes the tool, not the soil: how deep the hand could push
};

/// Returns the visual cues of an exploration, each with its sense; docs/reports/perception.md names the source.
[[nodiscard]] std::span<const SeenCue> seenCues();

/// Magnitudes of the cues of one stimulus.
struct SensedStimulus {
  double x = 0;  ///< position on the axis of the psychometric function, > 0
  /// [exploration][cue], each in the unit of its cue.
  std::vector<std::vector<double>> magnitudes = {};
};

/// Options for the interval of the observer's Weber fraction.
struct ObserverOptions {
  int resamplings = 0;       ///< bootstrap samples of the explorations for the interval; 0: no interval
  std::uint64_t seed = 1;    ///< seed of the resamplings
  double confidence = 0.95;  ///< probability of the interval
};

/// Performance of an observer with one cue or several together.
struct Discrimination {
  /// Difference of each stimulus from the reference, in JNDs: > 0 for "more", if the directions of the cues are known.
  std::vector<double> jnds;
  /// Difference between each stimulus and the next, in JNDs; one element less.
  std::vector<double> steps;
  /// Weight of one JND of each cue in the judgement; the squares sum to 1. Negative: the cue decreases with x.
  std::vector<double> weights;
  double weber_fraction = 0;  ///< eq. (22) in icra2021, fitted to the fractions Phi(d); infinite above `most`
  Interval interval = {};     ///< bootstrap percentiles of weber_fraction; NaN without resampling
  double most = 0;            ///< maximum Weber fraction that these stimuli can show
};

/// Computes how well an observer discriminates stimuli from a reference. The observer weighs the sensations of one or
/// several cues and has learnt the optimum weights for these stimuli (Fisher's linear discriminant),
///
///     v ~ (1 + 2 C)^-1 sum_i ln(x_i / x_ref) (mean s_i - mean s_ref)
///     d_i = v . (mean s_i - mean s_ref) / sqrt(v . (1 + C_i + C_ref) v)
///
/// with C_i the covariance between explorations, C its mean, and 1 the noise of the senses, assumed independent
/// between cues. With all cues of an exploration this is the ideal linear observer; with one cue d is
/// discriminability().
/// @param stimuli    three or more, in the order of their x, all different, each with two explorations or more.
/// @param reference  index of the stimulus with which the others are compared.
/// @param senses     one for each cue.
/// @throws InvalidParameter for other numbers of stimuli or senses, and as fitPsychometric().
[[nodiscard]] Discrimination discriminate(std::span<const SensedStimulus> stimuli, std::size_t reference,
                                          std::span<const Sense> senses, const ObserverOptions& options = {});

/// Discrimination of two stimuli, in JNDs.
struct PairDiscrimination {
  double jnds = 0;         ///< 0 is chance; larger values identify the test more reliably
  Interval interval = {};  ///< bootstrap percentiles of `jnds`; NaN without resampling
};

/// Computes how well an observer who weighs the sensations of all cues discriminates `test` from `reference`. Weights
/// are learnt from every second exploration and applied to the others, and vice versa; `jnds` is the mean of both.
/// Weights applied to the explorations they were learnt from would find a difference in any noise.
///
///     v_k ~ (mean s_k,test - mean s_k,ref) / (1 + var s_k,test + var s_k,ref),   d as discriminate()
///
/// Each weight ignores the covariance between cues. A small number of explorations does not determine the covariances,
/// and weights from their estimates are worse (Dudoit, Fridlyand and Speed 2002, J. Am. Stat. Assoc. 97:77).
/// @throws InvalidParameter for fewer than four explorations of a stimulus, or different numbers of magnitudes and
/// senses.
[[nodiscard]] PairDiscrimination discriminatePair(const SensedStimulus& reference, const SensedStimulus& test,
                                                  std::span<const Sense> senses, const ObserverOptions& options = {});

/// Converts a distance d in JNDs to d'. The correct one of two intervals is found in a fraction Phi(d) of trials, and
/// by definition in Phi(d' / sqrt 2) (Green and Swets 1966): d' = sqrt(2) d.
[[nodiscard]] double dPrime(double jnds) noexcept;

}  // namespace haptolith

#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/study/perception/exploration.h"

namespace haptolith {

/// How finely a sense tells magnitudes apart, as psychophysics has measured it.
struct Sense {
  double weber_fraction = 0;  ///< of magnitudes well above the threshold, > 0
  double threshold = 0;       ///< least magnitude that is noticed at all, > 0, in the magnitude's unit
};

/// A number that a hand could judge soil by.
struct Cue {
  std::string_view name, unit, title;
  Sense sense;
  double (*value)(const Exploration&);
};

/// The forces that exploring hands feel, each with the sense for it; docs/reports/perception.md names the sources.
[[nodiscard]] std::span<const Cue> cues();

/// What a hand tells by where it is, likewise; asked of studies' tasks, not of the paper's stimuli.
[[nodiscard]] std::span<const Cue> placeCues();

/// A magnitude in just noticeable differences (JNDs) above nothing.
///
///     s(x) = arsinh(k x / x0) / k,  k = ln(1 + w)
///
/// Well above x0 / k it grows by 1 when x grows by the Weber fraction w (Fechner); near nothing it is x / x0, so that
/// the threshold x0 is the first JND. Odd in x.
[[nodiscard]] double sensation(double magnitude, const Sense& sense) noexcept;

/// By how many JNDs the magnitudes `b` are above the magnitudes `a`, each from one exploration, when they differ from
/// one exploration to the next.
///
///     d = (mean s(b) - mean s(a)) / sqrt(1 + var s(a) + var s(b))
///
/// The 1 is the sense's own noise in a comparison, since a JND is told right in 84 % of comparisons. Phi(d) is then the
/// share of comparisons in which an ideal observer calls b the greater one.
/// @throws InvalidParameter for fewer than two magnitudes on a side.
[[nodiscard]] double discriminability(std::span<const double> a, std::span<const double> b, const Sense& sense);

/// A number that somebody could judge soil by who only looks on.
struct SeenCue {
  std::string_view name, unit, title;
  Sense sense;
  double (*value)(const Picture&);
  bool of_tool = false;  ///< of the tool, not of the soil: it tells how far a hand could push
};

/// What can be seen of an exploration, each with the eye's sense for it; docs/reports/perception.md names the source.
[[nodiscard]] std::span<const SeenCue> seenCues();

/// What one stimulus feels like.
struct SensedStimulus {
  double x = 0;  ///< on the axis of the psychometric function, > 0
  /// [exploration][cue], each in the unit of its cue.
  std::vector<std::vector<double>> magnitudes = {};
};

/// How an observer judges, and how well the Weber fraction is known.
struct ObserverOptions {
  int resamplings = 0;       ///< of the explorations, for the interval of the Weber fraction; 0: without
  std::uint64_t seed = 1;    ///< of the resamplings
  double confidence = 0.95;  ///< of the interval
};

/// What an observer can make of one cue or of several together.
struct Discrimination {
  /// Of each stimulus against the reference, in JNDs: > 0 for "more", if the observer knows which way the cues go.
  std::vector<double> jnds;
  /// Between each stimulus and the next, likewise; one less.
  std::vector<double> steps;
  /// What one JND of each cue counts in the judgement; their squares sum to 1. Negative: the cue falls with x.
  std::vector<double> weights;
  double weber_fraction = 0;  ///< of (paper 22) through the shares Phi(d); infinite when it is beyond `most`
  Interval interval = {};     ///< of it: percentiles of what resampled explorations give; NaN without
  double most = 0;            ///< the greatest Weber fraction that these stimuli could show
};

/// How well an observer tells stimuli from a reference who weighs the sensations of one or several cues and has learnt
/// the best weights for these stimuli (Fisher's linear discriminant),
///
///     v ~ (1 + 2 C)^-1 sum_i ln(x_i / x_ref) (mean s_i - mean s_ref)
///     d_i = v . (mean s_i - mean s_ref) / sqrt(v . (1 + C_i + C_ref) v)
///
/// where C_i is the covariance between explorations, C its mean, and 1 the noise of the senses, taken as independent
/// from cue to cue. With all cues of an exploration that is the ideal observer among those who sum up; with one cue d
/// is discriminability().
/// @param stimuli    three or more, in the order of their x, all different, each with two explorations or more.
/// @param reference  which of them the others are compared with.
/// @param senses     one for each cue.
/// @throws InvalidParameter for other numbers of them, and as fitPsychometric().
[[nodiscard]] Discrimination discriminate(std::span<const SensedStimulus> stimuli, std::size_t reference,
                                          std::span<const Sense> senses, const ObserverOptions& options = {});

/// Of two stimuli alone, in JNDs.
struct PairDiscrimination {
  double jnds = 0;         ///< by how much the observer finds the second to be the one; chance at 0
  Interval interval = {};  ///< percentiles of what resampled explorations give; NaN without
};

/// How well an observer tells `test` from `reference` who weighs the sensations of all cues. Weights are learnt from
/// every second exploration and judged by the others, and the other way round; `jnds` is the mean of both: weights that
/// are judged by what they were learnt from find a difference in any noise.
///
///     v_k ~ (mean s_k,test - mean s_k,ref) / (1 + var s_k,test + var s_k,ref),   d as discriminate()
///
/// Each cue has its weight as if it scattered by itself: few explorations do not tell how cues scatter together, and
/// weights that believe they do are worse (Dudoit, Fridlyand and Speed 2002, J. Am. Stat. Assoc. 97:77).
/// @throws InvalidParameter for fewer than four explorations of one, or other numbers of magnitudes than of senses.
[[nodiscard]] PairDiscrimination discriminatePair(const SensedStimulus& reference, const SensedStimulus& test,
                                                  std::span<const Sense> senses, const ObserverOptions& options = {});

/// d' of an observer for whom two stimuli are so many JNDs apart. Of two intervals the right one is found in a share
/// Phi(d) of trials, and by definition in Phi(d' / sqrt 2) (Green and Swets 1966): d' = sqrt(2) d.
[[nodiscard]] double dPrime(double jnds) noexcept;

}  // namespace haptolith

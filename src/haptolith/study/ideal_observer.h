#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/fit.h"
#include "haptolith/study/exploration.h"

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

/// The forces that exploring hands feel, each with the sense for it; docs/perception.md names the sources.
[[nodiscard]] std::span<const Cue> cues();

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

/// Magnitudes of one stimulus, each from one exploration.
struct FeltStimulus {
  double x = 0;  ///< on the axis of the psychometric function, > 0
  std::vector<double> magnitudes = {};
};

/// What an observer can make of one cue.
struct Discrimination {
  /// Of each stimulus against the reference, in JNDs: > 0 for "more", if the observer knows which way the cue goes.
  std::vector<double> jnds;
  /// Between each stimulus and the next, likewise; one less.
  std::vector<double> steps;
  bool rises = true;          ///< whether the cue grows with x
  double weber_fraction = 0;  ///< of (paper 22) through the shares Phi(d); infinite when it is beyond `most`
  double most = 0;            ///< the greatest Weber fraction that these stimuli could show
};

/// How well an ideal observer tells stimuli from a reference by one cue alone. The observer has learnt whether the cue
/// rises or falls with x.
/// @param stimuli    three or more, in the order of their x, all different.
/// @param reference  which of them the others are compared with.
/// @throws InvalidParameter as discriminability() and fitPsychometric().
[[nodiscard]] Discrimination discriminate(std::span<const FeltStimulus> stimuli, std::size_t reference,
                                          const Sense& sense);

}  // namespace haptolith

#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace haptolith {

/// Shape S between 0 and 1 of a psychometric function. On its axis (x, or ln x if the axis is logarithmic) each is the
/// distribution function of a location-scale family.
enum class Sigmoid {
  kNorm,            ///< cumulative Gaussian
  kLogistic,        ///< logistic
  kWeibull,         ///< Weibull: the Gumbel of ln x; its axis is always logarithmic
  kGumbel,          ///< Gumbel of the smallest value, 1 - exp(-exp(.))
  kReversedGumbel,  ///< its mirror image, Gumbel of the largest value, exp(-exp(-.))
  kStudent,         ///< Student's t with one degree of freedom (Cauchy): heavy tails
  kWeber,           ///< (paper 22) as meant: cumulative Gaussian of ln(x/p) with standard deviation ln(1 + w)
  kWeberAsPrinted,  ///< (paper 22) as printed, with natural logarithms: its standard deviation is sqrt(ln(1 + w))
  kWeberLog10       ///< (paper 22) as printed, with logarithms to base 10: it is sqrt(ln(10) ln(1 + w))
};

/// Asymptotes of a psychometric function.
enum class Design {
  kYesNo,          ///< guess rate and lapse rate are free
  kForcedChoice,   ///< n alternatives: the guess rate is 1/n
  kEqualAsymptote  ///< the guess rate is the lapse rate, as in a comparison with symmetric responses
};

/// Name of a sigmoid or design on the command line and in files.
template <class Kind>
struct NamedKind {
  std::string_view name;
  Kind kind;
};
inline constexpr std::array<NamedKind<Sigmoid>, 9> kSigmoidNames{{{"norm", Sigmoid::kNorm},
                                                                  {"logistic", Sigmoid::kLogistic},
                                                                  {"weibull", Sigmoid::kWeibull},
                                                                  {"gumbel", Sigmoid::kGumbel},
                                                                  {"rgumbel", Sigmoid::kReversedGumbel},
                                                                  {"tdist", Sigmoid::kStudent},
                                                                  {"weber", Sigmoid::kWeber},
                                                                  {"as-printed", Sigmoid::kWeberAsPrinted},
                                                                  {"as-printed-log10", Sigmoid::kWeberLog10}}};
inline constexpr std::array<NamedKind<Design>, 3> kDesignNames{
    {{"yesno", Design::kYesNo}, {"nafc", Design::kForcedChoice}, {"equal-asymptote", Design::kEqualAsymptote}}};

/// Returns all names for lists; those of the designs also contain "2afc".
[[nodiscard]] std::vector<std::string> sigmoidNames();
[[nodiscard]] std::vector<std::string> designNames();

[[nodiscard]] std::string_view nameOf(Sigmoid sigmoid);
[[nodiscard]] std::string_view nameOf(Design design);
/// @throws InvalidParameter for a name that is not in kSigmoidNames.
[[nodiscard]] Sigmoid sigmoidNamed(std::string_view name);
/// @throws InvalidParameter for a name that is not in kDesignNames.
[[nodiscard]] Design designNamed(std::string_view name);

/// Whether the sigmoid is one of the three readings of (paper 22), with the Weber fraction w as its scale.
[[nodiscard]] bool isWeber(Sigmoid sigmoid) noexcept;
/// Whether the sigmoid's axis is always ln x.
[[nodiscard]] bool isAlwaysLogarithmic(Sigmoid sigmoid) noexcept;

/// Psychometric function psi(x) = guess + (1 - guess - lapse) S(x), the probability of a positive response to the
/// stimulus x; see also falling.
struct PsychometricFunction {
  Sigmoid sigmoid = Sigmoid::kNorm;
  bool log_axis = false;  ///< S is a function of ln x; weber, as-printed and weibull always are
  double threshold = 0;   ///< stimulus with S = 1/2, in the unit of x; in a comparison the point of subjective equality
  double width = 1;       ///< distance from S = 0.05 to S = 0.95, in the unit of x, or of ln x on a logarithmic axis
  double guess = 0;       ///< lower asymptote, 0 to 1
  double lapse = 0;       ///< one minus the upper asymptote, 0 to 1
  bool falling = false;   ///< positive responses decrease with the stimulus: S is replaced by 1 - S
};

/// Returns the function of (paper 22) with reference p, Weber fraction w and no lapses.
///
///     kWeber:           S = 1/2 + 1/2 erf(ln(x/p) / (sqrt(2) ln(1 + w)))       w = x84/p - 1
///     kWeberAsPrinted:  S = 1/2 + 1/2 erf(ln(x/p) / sqrt(2 ln(1 + w)))         (paper 22)
///     kWeberLog10:      S = 1/2 + 1/2 erf(lg(x/p) / sqrt(2 lg(1 + w)))         (paper 22)
///
/// @throws InvalidParameter unless reference > 0, w > 0 and the sigmoid is one of these.
[[nodiscard]] PsychometricFunction weberFunction(double reference, double w, Sigmoid sigmoid = Sigmoid::kWeber);

/// Returns S(x), 0 to 1: the sigmoid without its asymptotes, rising or falling.
[[nodiscard]] double sigmoidAt(const PsychometricFunction& function, double x) noexcept;

/// Returns psi(x), the probability of a positive response, 0 to 1. @param x above 0 on a logarithmic axis.
[[nodiscard]] double probability(const PsychometricFunction& function, double x) noexcept;

/// Returns the stimulus at which S is `share`, in the unit of x. @param share between 0 and 1, both excluded.
[[nodiscard]] double stimulusAt(const PsychometricFunction& function, double share);

/// Returns the just noticeable difference x84 - x50, in the unit of x: from S = 1/2 to S = 0.8413, one standard
/// deviation of a Gaussian. For a falling function it is the distance to S = 1 - 0.8413.
[[nodiscard]] double jndOf(const PsychometricFunction& function);

/// Returns x84 - x50 on the axis (x or ln x), as a fraction of the width.
[[nodiscard]] double jndInWidths(const PsychometricFunction& function);

/// Returns the Weber fraction x84/x50 - 1, the JND over the threshold.
[[nodiscard]] double weberFractionOf(const PsychometricFunction& function);

/// Quantity that follows from threshold and width, such as these two.
using Derived = double (*)(const PsychometricFunction&);

/// Returns w of (paper 22) for this width; the inverse of weberWidth().
[[nodiscard]] double weberParameter(Sigmoid sigmoid, double width) noexcept;

/// Returns the width in ln x for w with a sigmoid of (paper 22).
[[nodiscard]] double weberWidth(Sigmoid sigmoid, double w) noexcept;

/// Returns the place on the axis: x, or ln x.
[[nodiscard]] double toAxis(const PsychometricFunction& function, double x) noexcept;
[[nodiscard]] double fromAxis(const PsychometricFunction& function, double place) noexcept;

/// Returns the rising sigmoid as a function of the distance from the threshold, in widths.
[[nodiscard]] double standardSigmoid(Sigmoid sigmoid, double widths) noexcept;

}  // namespace haptolith

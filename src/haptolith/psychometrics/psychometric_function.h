#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace haptolith {

/// The shape S between 0 and 1 of a psychometric function. On its axis (x, or ln x when the axis is logarithmic) each
/// is the distribution function of a location-scale family.
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

/// What the asymptotes of a psychometric function are.
enum class Design {
  kYesNo,          ///< guess rate and lapse rate are free
  kForcedChoice,   ///< n alternatives: the guess rate is 1/n
  kEqualAsymptote  ///< the guess rate is the lapse rate, as in a comparison whose answers mean the same both ways
};

/// A sigmoid or design as the command line and files call it.
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

/// For lists of what there is; the designs with "2afc", too.
[[nodiscard]] std::vector<std::string> sigmoidNames();
[[nodiscard]] std::vector<std::string> designNames();

[[nodiscard]] std::string_view nameOf(Sigmoid sigmoid);
[[nodiscard]] std::string_view nameOf(Design design);
/// @throws InvalidParameter for a name that is not among kSigmoidNames.
[[nodiscard]] Sigmoid sigmoidNamed(std::string_view name);
/// @throws InvalidParameter for a name that is not among kDesignNames.
[[nodiscard]] Design designNamed(std::string_view name);

/// Whether the sigmoid is one of the three readings of (paper 22), whose scale is given by the Weber fraction w.
[[nodiscard]] bool isWeber(Sigmoid sigmoid) noexcept;
/// Whether the sigmoid lives on ln x whatever is asked for.
[[nodiscard]] bool isAlwaysLogarithmic(Sigmoid sigmoid) noexcept;

/// psi(x) = guess + (1 - guess - lapse) S(x), the probability of a positive answer to the stimulus x; see also falling.
struct PsychometricFunction {
  Sigmoid sigmoid = Sigmoid::kNorm;
  bool log_axis = false;  ///< S is a function of ln x; weber, as-printed and weibull always are
  double threshold = 0;   ///< where S is 1/2, in the unit of x; of a comparison, the point of subjective equality
  double width = 1;       ///< from S = 0.05 to S = 0.95, in the unit of x, or of ln x where the axis is logarithmic
  double guess = 0;       ///< the lower asymptote, 0 to 1
  double lapse = 0;       ///< one less the upper asymptote, 0 to 1
  bool falling = false;   ///< more of the stimulus, fewer positive answers: S is replaced by 1 - S
};

/// The function of (paper 22) with reference p, Weber fraction w and no lapses.
///
///     kWeber:           S = 1/2 + 1/2 erf(ln(x/p) / (sqrt(2) ln(1 + w)))       w = x84/p - 1
///     kWeberAsPrinted:  S = 1/2 + 1/2 erf(ln(x/p) / sqrt(2 ln(1 + w)))         (paper 22)
///     kWeberLog10:      S = 1/2 + 1/2 erf(lg(x/p) / sqrt(2 lg(1 + w)))         (paper 22)
///
/// @throws InvalidParameter unless reference > 0, w > 0 and the sigmoid is one of these.
[[nodiscard]] PsychometricFunction weberFunction(double reference, double w, Sigmoid sigmoid = Sigmoid::kWeber);

/// S(x), 0 to 1: the sigmoid without its asymptotes, rising or falling.
[[nodiscard]] double sigmoidAt(const PsychometricFunction& function, double x) noexcept;

/// psi(x), the probability of a positive answer, 0 to 1. @param x above 0 where the axis is logarithmic.
[[nodiscard]] double probability(const PsychometricFunction& function, double x) noexcept;

/// The stimulus at which S is `share`, in the unit of x. @param share between 0 and 1, both excluded.
[[nodiscard]] double stimulusAt(const PsychometricFunction& function, double share);

/// The just noticeable difference x84 - x50, in the unit of x: from S = 1/2 up to S = 0.8413, which is one standard
/// deviation of a Gaussian; of a falling function, up to where it is 1 - 0.8413.
[[nodiscard]] double jndOf(const PsychometricFunction& function);

/// x84 - x50 on the axis (x or ln x), as a share of the width.
[[nodiscard]] double jndInWidths(const PsychometricFunction& function);

/// The Weber fraction x84/x50 - 1, the JND as a share of the threshold.
[[nodiscard]] double weberFractionOf(const PsychometricFunction& function);

/// A quantity that follows from threshold and width, such as these two.
using Derived = double (*)(const PsychometricFunction&);

/// The w of (paper 22) that gives this width; the inverse of weberWidth().
[[nodiscard]] double weberParameter(Sigmoid sigmoid, double width) noexcept;

/// The width in ln x that w gives under the sigmoid, one of those of (paper 22).
[[nodiscard]] double weberWidth(Sigmoid sigmoid, double w) noexcept;

/// Place on the axis: x, or ln x.
[[nodiscard]] double toAxis(const PsychometricFunction& function, double x) noexcept;
[[nodiscard]] double fromAxis(const PsychometricFunction& function, double place) noexcept;

/// The rising sigmoid as a function of its distance from the threshold, in widths.
[[nodiscard]] double standardSigmoid(Sigmoid sigmoid, double widths) noexcept;

}  // namespace haptolith

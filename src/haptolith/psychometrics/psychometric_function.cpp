#include "haptolith/psychometrics/psychometric_function.h"

#include <boost/math/special_functions/erf.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr double kTail = 0.05;                        // the width is from here to 1 - kTail
constexpr double kGaussianWidth = 3.289707253902943;  // widths of 5 % to 95 %, in standard deviations: 2 Phi^-1(0.95)
constexpr double kOneSigma = 0.8413447460685429;      // Phi(1)

double logisticWidth() noexcept {
  return 2 * std::log((1 - kTail) / kTail);
}

double gumbelWidth() noexcept {
  return std::log(-std::log(kTail)) - std::log(-std::log1p(-kTail));
}

template <class Kind, std::size_t kCount>
std::vector<std::string> namesOf(const std::array<NamedKind<Kind>, kCount>& named) {
  std::vector<std::string> names;
  names.reserve(kCount);
  for (const NamedKind<Kind>& it : named) {
    names.emplace_back(it.name);
  }
  return names;
}

/// Returns the width of Student's t with one degree of freedom.
double studentWidth() noexcept {
  return 2 * std::tan(std::numbers::pi * (0.5 - kTail));
}

/// Converts w to the standard deviation of ln x; the next function is its inverse.
double weberSigma(Sigmoid sigmoid, double w) noexcept {
  const double log = std::log1p(w);
  return sigmoid == Sigmoid::kWeberAsPrinted ? std::sqrt(log)
         : sigmoid == Sigmoid::kWeberLog10   ? std::sqrt(std::numbers::ln10 * log)
                                             : log;
}

double weberOfSigma(Sigmoid sigmoid, double sigma) noexcept {
  const double log = sigmoid == Sigmoid::kWeberAsPrinted ? sigma * sigma
                     : sigmoid == Sigmoid::kWeberLog10   ? sigma * sigma / std::numbers::ln10
                                                         : sigma;
  return std::expm1(log);
}

/// Inverts standardSigmoid().
double standardPlace(Sigmoid sigmoid, double share) {
  HAPTO_ASSERT(share > 0 && share < 1);
  switch (sigmoid) {
    case Sigmoid::kLogistic: return std::log(share / (1 - share)) / logisticWidth();
    case Sigmoid::kWeibull:
    case Sigmoid::kGumbel: return (std::log(-std::log1p(-share)) - std::log(std::numbers::ln2)) / gumbelWidth();
    case Sigmoid::kReversedGumbel: return (std::log(std::numbers::ln2) - std::log(-std::log(share))) / gumbelWidth();
    case Sigmoid::kStudent: return std::tan(std::numbers::pi * (share - 0.5)) / studentWidth();
    case Sigmoid::kNorm:
    case Sigmoid::kWeber:
    case Sigmoid::kWeberAsPrinted:
    case Sigmoid::kWeberLog10: break;
  }
  return std::numbers::sqrt2 * boost::math::erf_inv(2 * share - 1) / kGaussianWidth;
}

template <class Kind, std::size_t kCount>
std::string_view nameIn(const std::array<NamedKind<Kind>, kCount>& names, Kind kind) {
  for (const NamedKind<Kind>& named : names) {
    if (named.kind == kind) {
      return named.name;
    }
  }
  return "";
}

template <class Kind, std::size_t kCount>
Kind kindNamed(std::string_view key, const std::array<NamedKind<Kind>, kCount>& names, std::string_view name) {
  std::string all;
  for (const NamedKind<Kind>& named : names) {
    if (named.name == name) {
      return named.kind;
    }
    all += (all.empty() ? "" : ", ") + std::string(named.name);
  }
  throw InvalidParameter(std::string(key), fmt::format("'{}'", name), "one of " + all);
}

}  // namespace

std::vector<std::string> sigmoidNames() {
  return namesOf(kSigmoidNames);
}

std::vector<std::string> designNames() {
  std::vector<std::string> names = namesOf(kDesignNames);
  names.emplace_back("2afc");
  return names;
}

std::string_view nameOf(Sigmoid sigmoid) {
  return nameIn(kSigmoidNames, sigmoid);
}

std::string_view nameOf(Design design) {
  return nameIn(kDesignNames, design);
}

Sigmoid sigmoidNamed(std::string_view name) {
  return kindNamed("sigmoid", kSigmoidNames, name);
}

Design designNamed(std::string_view name) {
  if (name == "2afc") {
    return Design::kForcedChoice;
  }
  return kindNamed("design", kDesignNames, name);
}

bool isWeber(Sigmoid sigmoid) noexcept {
  return sigmoid == Sigmoid::kWeber || sigmoid == Sigmoid::kWeberAsPrinted || sigmoid == Sigmoid::kWeberLog10;
}

bool isAlwaysLogarithmic(Sigmoid sigmoid) noexcept {
  return isWeber(sigmoid) || sigmoid == Sigmoid::kWeibull;
}

double standardSigmoid(Sigmoid sigmoid, double widths) noexcept {
  switch (sigmoid) {
    case Sigmoid::kLogistic: return 1 / (1 + std::exp(-logisticWidth() * widths));
    case Sigmoid::kWeibull:
    case Sigmoid::kGumbel: return -std::expm1(-std::numbers::ln2 * std::exp(gumbelWidth() * widths));
    case Sigmoid::kReversedGumbel: return std::exp(-std::numbers::ln2 * std::exp(-gumbelWidth() * widths));
    case Sigmoid::kStudent: return 0.5 + std::atan(studentWidth() * widths) / std::numbers::pi;
    case Sigmoid::kNorm:
    case Sigmoid::kWeber:
    case Sigmoid::kWeberAsPrinted:
    case Sigmoid::kWeberLog10: break;
  }
  return std::erfc(-kGaussianWidth / std::numbers::sqrt2 * widths) / 2;
}

double weberWidth(Sigmoid sigmoid, double w) noexcept {
  return kGaussianWidth * weberSigma(sigmoid, w);
}

double weberParameter(Sigmoid sigmoid, double width) noexcept {
  return weberOfSigma(sigmoid, width / kGaussianWidth);
}

PsychometricFunction weberFunction(double reference, double w, Sigmoid sigmoid) {
  requireInRange("reference", reference, {.lowest = 0, .ends = Ends::kOpen});
  requireInRange("w", w, {.lowest = 0, .ends = Ends::kOpen});
  if (!isWeber(sigmoid)) {
    throw InvalidParameter("sigmoid", std::string(nameOf(sigmoid)), "weber, as-printed or as-printed-log10");
  }
  return {.sigmoid = sigmoid, .log_axis = true, .threshold = reference, .width = weberWidth(sigmoid, w)};
}

double toAxis(const PsychometricFunction& function, double x) noexcept {
  return function.log_axis ? std::log(x) : x;
}

double fromAxis(const PsychometricFunction& function, double place) noexcept {
  return function.log_axis ? std::exp(place) : place;
}

double sigmoidAt(const PsychometricFunction& function, double x) noexcept {
  const double widths = (toAxis(function, x) - toAxis(function, function.threshold)) / function.width;
  const double rising = standardSigmoid(function.sigmoid, widths);
  return function.falling ? 1 - rising : rising;
}

double probability(const PsychometricFunction& function, double x) noexcept {
  return function.guess + (1 - function.guess - function.lapse) * sigmoidAt(function, x);
}

double stimulusAt(const PsychometricFunction& function, double share) {
  requireInRange("share of a sigmoid", share, {0, 1, Ends::kOpen});
  const double rising = function.falling ? 1 - share : share;
  const double place = toAxis(function, function.threshold) + function.width * standardPlace(function.sigmoid, rising);
  return fromAxis(function, place);
}

double jndInWidths(const PsychometricFunction& function) {
  return standardPlace(function.sigmoid, kOneSigma);
}

double jndOf(const PsychometricFunction& function) {
  const double place = toAxis(function, function.threshold) + function.width * jndInWidths(function);
  return fromAxis(function, place) - function.threshold;
}

double weberFractionOf(const PsychometricFunction& function) {
  return jndOf(function) / function.threshold;
}

}  // namespace haptolith

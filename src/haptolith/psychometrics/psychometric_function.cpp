#include "haptolith/psychometrics/psychometric_function.h"

#include <boost/math/special_functions/erf.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr double kTail = 0.05;                        // the width goes from here to 1 - kTail
constexpr double kGaussianWidth = 3.289707253902943;  // widths of 5 % to 95 %, in standard deviations: 2 Phi^-1(0.95)
constexpr double kOneSigma = 0.8413447460685429;      // Phi(1)

double logisticWidth() noexcept {
  return 2 * std::log((1 - kTail) / kTail);
}

double gumbelWidth() noexcept {
  return std::log(-std::log(kTail)) - std::log(-std::log1p(-kTail));
}

/// The inverse of standardSigmoid().
double standardPlace(Sigmoid sigmoid, double share) {
  switch (sigmoid) {
    case Sigmoid::kLogistic: return std::log(share / (1 - share)) / logisticWidth();
    case Sigmoid::kWeibull:
    case Sigmoid::kGumbel: return (std::log(-std::log1p(-share)) - std::log(std::numbers::ln2)) / gumbelWidth();
    case Sigmoid::kNorm:
    case Sigmoid::kWeber:
    case Sigmoid::kWeberAsPrinted: break;
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
  return kindNamed("design", kDesignNames, name);
}

bool isWeber(Sigmoid sigmoid) noexcept {
  return sigmoid == Sigmoid::kWeber || sigmoid == Sigmoid::kWeberAsPrinted;
}

bool isAlwaysLogarithmic(Sigmoid sigmoid) noexcept {
  return isWeber(sigmoid) || sigmoid == Sigmoid::kWeibull;
}

double standardSigmoid(Sigmoid sigmoid, double widths) noexcept {
  switch (sigmoid) {
    case Sigmoid::kLogistic: return 1 / (1 + std::exp(-logisticWidth() * widths));
    case Sigmoid::kWeibull:
    case Sigmoid::kGumbel: return -std::expm1(-std::numbers::ln2 * std::exp(gumbelWidth() * widths));
    case Sigmoid::kNorm:
    case Sigmoid::kWeber:
    case Sigmoid::kWeberAsPrinted: break;
  }
  return std::erfc(-kGaussianWidth / std::numbers::sqrt2 * widths) / 2;
}

double weberWidth(Sigmoid sigmoid, double w) noexcept {
  const double sigma = sigmoid == Sigmoid::kWeberAsPrinted ? std::sqrt(std::log1p(w)) : std::log1p(w);
  return kGaussianWidth * sigma;
}

double weberParameter(Sigmoid sigmoid, double width) noexcept {
  const double sigma = width / kGaussianWidth;
  return std::expm1(sigmoid == Sigmoid::kWeberAsPrinted ? sigma * sigma : sigma);
}

PsychometricFunction weberFunction(double reference, double w, Sigmoid sigmoid) {
  requireInRange("reference", reference, {.lowest = 0, .ends = Ends::kOpen});
  requireInRange("w", w, {.lowest = 0, .ends = Ends::kOpen});
  if (!isWeber(sigmoid)) {
    throw InvalidParameter("sigmoid", std::string(nameOf(sigmoid)), "weber or as-printed");
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
  return standardSigmoid(function.sigmoid,
                         (toAxis(function, x) - toAxis(function, function.threshold)) / function.width);
}

double probability(const PsychometricFunction& function, double x) noexcept {
  return function.guess + (1 - function.guess - function.lapse) * sigmoidAt(function, x);
}

double stimulusAt(const PsychometricFunction& function, double share) {
  requireInRange("share of a sigmoid", share, {0, 1, Ends::kOpen});
  const double place = toAxis(function, function.threshold) + function.width * standardPlace(function.sigmoid, share);
  return fromAxis(function, place);
}

double jndOf(const PsychometricFunction& function) {
  return stimulusAt(function, kOneSigma) - function.threshold;
}

double weberFractionOf(const PsychometricFunction& function) {
  return stimulusAt(function, kOneSigma) / function.threshold - 1;
}

}  // namespace haptolith

#include "haptolith/psychometrics/fit_request.h"

#include <fmt/format.h>

#include <charconv>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// Parses a rate: fixed at a number, or free.
std::optional<double> rateOf(const std::string& key, const std::string& text, std::optional<double> otherwise) {
  if (text.empty()) {
    return otherwise;
  }
  if (text == "free") {
    return std::nullopt;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw InvalidParameter(key, fmt::format("'{}'", text), "a number or free");
  }
  return value;
}

}  // namespace

FitOptions fitOptionsOf(const FitRequest& request, std::string_view prefix) {
  const auto key = [prefix](const char* name) { return fmt::format("{}{}", prefix, name); };
  if (request.alternatives != 2 && request.design != "nafc") {
    throw InvalidParameter(key("alternatives"),
                           fmt::format("{} with {}design {}", request.alternatives, prefix, request.design),
                           fmt::format("a number of alternatives only with {}design nafc", prefix));
  }
  FitOptions fit{.sigmoid = sigmoidNamed(request.sigmoid), .design = designNamed(request.design)};
  fit.alternatives = request.alternatives;
  fit.log_axis = request.log_x || isAlwaysLogarithmic(fit.sigmoid);
  fit.falling = request.falling;
  fit.confidence = request.confidence;
  fit.simulations = request.simulations;
  // (paper 22) has neither lapses nor overdispersion, and its threshold is the reference.
  const std::optional<double> usual = isWeber(fit.sigmoid) ? std::optional<double>(0) : std::nullopt;
  fit.lapse = rateOf(key("lapse"), request.lapse, usual);
  fit.overdispersion = rateOf(key("overdispersion"), request.overdispersion, usual);
  fit.guess = rateOf(key("guess"), request.guess, fit.design == Design::kYesNo ? usual : std::nullopt);
  if (isWeber(fit.sigmoid) && !request.free_threshold) {
    fit.threshold = request.reference;
  }
  if (request.method == "map") {
    fit.estimate = PointEstimate::kMap;
  } else if (request.method == "median") {
    fit.estimate = PointEstimate::kMedian;
  } else if (!request.method.empty() && request.method != "ml") {
    throw InvalidParameter(key("method"), fmt::format("'{}'", request.method), "map, median or ml");
  }
  return fit;
}

Fit fitAsAsked(std::span<const Level> levels, const FitRequest& request, std::string_view prefix) {
  const FitOptions options = fitOptionsOf(request, prefix);
  return request.method == "ml" ? fitMaximumLikelihood(levels, options) : fitPsychometric(levels, options);
}

}  // namespace haptolith

#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "haptolith/psychometrics/fit.h"

namespace haptolith {

/// Fit options as text, for the command line and the library.
struct FitRequest {
  std::string design = "equal-asymptote";    ///< element of designNames()
  std::string sigmoid = "weber";             ///< element of sigmoidNames()
  std::string method;                        ///< map, median, ml; empty: weber median, else map
  std::string lapse, guess, overdispersion;  ///< a number, "free", or empty: the sigmoid's default
  int alternatives = 2;                      ///< for nafc
  bool log_x = false;
  bool falling = false;
  bool free_threshold = false;
  std::optional<double> reference = std::nullopt;  ///< p for weber: fixes the threshold
  double confidence = 0.95;
  int simulations = 1000;
};

/// Parses a request. @param prefix  prefix of the keys in messages: "--" on the command line. @throws InvalidParameter
/// for unknown words.
[[nodiscard]] FitOptions fitOptionsOf(const FitRequest& request, std::string_view prefix);

/// Fits by the requested method. @throws as fitOptionsOf(), fitPsychometric().
[[nodiscard]] Fit fitAsAsked(std::span<const Level> levels, const FitRequest& request, std::string_view prefix);

}  // namespace haptolith

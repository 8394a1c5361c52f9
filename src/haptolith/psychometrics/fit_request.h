#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "haptolith/psychometrics/fit.h"

namespace haptolith {

/// A fit in words, as the command line and the library take it.
struct FitRequest {
  std::string design = "equal-asymptote";    ///< one of designNames()
  std::string sigmoid = "weber";             ///< one of sigmoidNames()
  std::string method;                        ///< map, median, ml; empty: weber median, else map
  std::string lapse, guess, overdispersion;  ///< a number, "free", or nothing: as the sigmoid has it
  int alternatives = 2;                      ///< of nafc
  bool log_x = false;
  bool falling = false;
  bool free_threshold = false;
  std::optional<double> reference = std::nullopt;  ///< p of weber: fixes the threshold
  double confidence = 0.95;
  int simulations = 1000;
};

/// @param prefix  of the keys in messages: "--" on the command line. @throws InvalidParameter for words that are none.
[[nodiscard]] FitOptions fitOptionsOf(const FitRequest& request, std::string_view prefix);

/// By the method that is asked for. @throws as fitOptionsOf(), fitPsychometric().
[[nodiscard]] Fit fitAsAsked(std::span<const Level> levels, const FitRequest& request, std::string_view prefix);

}  // namespace haptolith

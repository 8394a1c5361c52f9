#pragma once

#include <optional>

namespace haptolith {

/// What an adaptive procedure has found so far.
struct AdaptiveEstimate {
  double threshold = 0;  ///< x50; of a comparison, the point of subjective equality
  double jnd = 0;        ///< x84 - x50, in the unit of x
};

/// Chooses the next stimulus from the answers to those before. Deterministic, and without memory of its own beyond the
/// answers: told them again in their order, it goes on exactly where it was.
class AdaptiveProcedure {
 public:
  AdaptiveProcedure() = default;
  AdaptiveProcedure(const AdaptiveProcedure&) = delete;
  AdaptiveProcedure& operator=(const AdaptiveProcedure&) = delete;
  virtual ~AdaptiveProcedure() = default;

  /// The level to show next, one of those it was made with; none when it has finished. Asking changes nothing.
  [[nodiscard]] virtual std::optional<double> next() const = 0;

  /// Whether the answer to level `x` was positive: "the test had more". @throws InvalidParameter when `x` is no level.
  virtual void answer(double x, bool positive) = 0;

  /// None before there is anything to tell.
  [[nodiscard]] virtual std::optional<AdaptiveEstimate> estimate() const = 0;
};

}  // namespace haptolith

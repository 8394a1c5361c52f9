#pragma once

#include <optional>

namespace haptolith {

/// Current estimate of an adaptive procedure.
struct AdaptiveEstimate {
  double threshold = 0;  ///< x50; in a comparison the point of subjective equality
  double jnd = 0;        ///< x84 - x50, in the unit of x
};

/// Chooses the next stimulus from the previous responses. Deterministic, with no state except the responses: replaying
/// them in order restores its state exactly.
class AdaptiveProcedure {
 public:
  AdaptiveProcedure() = default;
  AdaptiveProcedure(const AdaptiveProcedure&) = delete;
  AdaptiveProcedure& operator=(const AdaptiveProcedure&) = delete;
  virtual ~AdaptiveProcedure() = default;

  /// Returns the next level, one of those given to the constructor; empty when it has finished. Does not change the
  /// state.
  [[nodiscard]] virtual std::optional<double> next() const = 0;

  /// Adds the response to level `x`; positive means "the test had more". @throws InvalidParameter if `x` is not a
  /// level.
  virtual void answer(double x, bool positive) = 0;

  /// Returns the estimate, if there is enough data.
  [[nodiscard]] virtual std::optional<AdaptiveEstimate> estimate() const = 0;
};

}  // namespace haptolith

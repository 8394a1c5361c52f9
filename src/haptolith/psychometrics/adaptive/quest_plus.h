#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/adaptive/adaptive_procedure.h"
#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

/// Options of QUEST+ (Watson 2017, Journal of Vision 17(3):10). It chooses the stimulus with the least expected entropy
/// of the posterior over a grid of psychometric functions.
struct QuestPlusOptions {
  Sigmoid sigmoid = Sigmoid::kWeber;
  Design design = Design::kEqualAsymptote;
  int alternatives = 2;                 ///< for kForcedChoice, 2 to 100: the guess rate is 1/alternatives
  bool log_axis = false;                ///< weber, as-printed and weibull are always logarithmic
  std::vector<double> thresholds = {};  ///< empty: 15 within the levels' range; for weber sigmoids about the reference
  std::vector<double> widths = {};  ///< empty: 25 that the levels can discriminate; Weber fractions for weber sigmoids
  std::vector<double> lapses = {0, 0.02, 0.05};
  std::vector<double> guesses = {0, 0.02, 0.05};  ///< guess rates for kYesNo
  int trials = 30;
  /// Posterior standard deviation of ln(width) below which the procedure ends early; 0: never.
  double enough_spread = 0;
};

/// Function of the grid with its probability.
struct Hypothesis {
  PsychometricFunction function;
  double probability = 0;
};

/// QUEST+ over any list of hypotheses. If several stimuli are equally good, the first in the list is taken.
class QuestPlus : public AdaptiveProcedure {
 public:
  /// @param hypotheses  hypotheses with prior probabilities of sum 1.
  /// @throws InvalidParameter without levels, hypotheses or trials.
  QuestPlus(std::vector<double> levels, std::vector<Hypothesis> hypotheses, int trials, double enough_spread = 0);

  [[nodiscard]] std::optional<double> next() const override;
  void answer(double x, bool positive) override;
  /// Returns posterior medians.
  [[nodiscard]] std::optional<AdaptiveEstimate> estimate() const override;

  /// Returns median and percentile interval of a marginal. Each hypothesis represents all values closer to it than to
  /// others, uniformly on the axis (widths uniformly in their logarithm). If all have the same value, that is the
  /// interval.
  /// @param confidence  between 0 and 1, both excluded.
  [[nodiscard]] Estimate threshold(double confidence = 0.95) const;
  [[nodiscard]] Estimate width(double confidence = 0.95) const;

  [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const noexcept { return hypotheses_; }
  /// Returns the posterior standard deviation of ln(width).
  [[nodiscard]] double logWidthSpread() const;

 private:
  [[nodiscard]] double expectedEntropy(std::size_t level) const;

  std::vector<double> levels_;
  std::vector<Hypothesis> hypotheses_;
  std::vector<std::vector<double>> positive_;  // per level, the probability under each hypothesis
  int trials_;
  double enough_spread_;
  int answered_ = 0;
};

/// Creates QUEST+ over a grid of threshold, width, lapse rate and, for kYesNo, guess rate, with a uniform prior.
/// @param levels  two or more. @param reference  reference of a comparison; otherwise any value within the levels.
/// @throws InvalidParameter for invalid levels or options.
[[nodiscard]] std::unique_ptr<QuestPlus> makeQuestPlus(const QuestPlusOptions& options, std::vector<double> levels,
                                                       double reference);

}  // namespace haptolith

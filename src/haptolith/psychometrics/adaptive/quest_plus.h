#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "haptolith/psychometrics/adaptive/adaptive_procedure.h"
#include "haptolith/psychometrics/fit.h"
#include "haptolith/psychometrics/psychometric_function.h"

namespace haptolith {

/// QUEST+ (Watson 2017, Journal of Vision 17(3):10): each time the stimulus after which the expected entropy of the
/// posterior over a grid of psychometric functions is least.
struct QuestPlusOptions {
  Sigmoid sigmoid = Sigmoid::kWeber;
  Design design = Design::kEqualAsymptote;
  int alternatives = 2;                 ///< of kForcedChoice, 2 to 100: the guess rate is 1/alternatives
  bool log_axis = false;                ///< weber, as-printed and weibull are logarithmic anyway
  std::vector<double> thresholds = {};  ///< empty: 15 within the levels' range; of weber sigmoids, about the reference
  std::vector<double> widths = {};      ///< empty: 25 that the levels can tell apart; of weber sigmoids Weber fractions
  std::vector<double> lapses = {0, 0.02, 0.05};
  std::vector<double> guesses = {0, 0.02, 0.05};  ///< of kYesNo
  int trials = 30;
  /// Ends it before, when the posterior's standard deviation of ln(width) falls below this; 0: never.
  double enough_spread = 0;
};

/// One function of the grid with its probability.
struct Hypothesis {
  PsychometricFunction function;
  double probability = 0;
};

/// The engine of QUEST+, over any list of hypotheses. Where two stimuli are equally good, the first of the list is
/// taken.
class QuestPlus : public AdaptiveProcedure {
 public:
  /// @param hypotheses  with probabilities before the first answer that sum to 1.
  /// @throws InvalidParameter when there are no levels, no hypotheses or no trials.
  QuestPlus(std::vector<double> levels, std::vector<Hypothesis> hypotheses, int trials, double enough_spread = 0);

  [[nodiscard]] std::optional<double> next() const override;
  void answer(double x, bool positive) override;
  /// Posterior medians.
  [[nodiscard]] std::optional<AdaptiveEstimate> estimate() const override;

  /// Median and percentile interval of a marginal. Each hypothesis stands for all values that are nearer to its own
  /// than to those of the others, evenly on the axis (of widths, evenly in their logarithm); where all have the same
  /// value, the interval is that value.
  /// @param confidence  between 0 and 1, both excluded.
  [[nodiscard]] Estimate threshold(double confidence = 0.95) const;
  [[nodiscard]] Estimate width(double confidence = 0.95) const;

  [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const noexcept { return hypotheses_; }
  /// Standard deviation of ln(width), from the posterior.
  [[nodiscard]] double logWidthSpread() const;

 private:
  [[nodiscard]] double expectedEntropy(std::size_t level) const;

  std::vector<double> levels_;
  std::vector<Hypothesis> hypotheses_;
  std::vector<std::vector<double>> positive_;  // of each level, the probability under each hypothesis
  int trials_;
  double enough_spread_;
  int answered_ = 0;
};

/// QUEST+ over a grid of threshold, width, lapse rate and, of kYesNo, guess rate, equally probable at first.
/// @param levels  two or more. @param reference  of a comparison; otherwise any value within the levels.
/// @throws InvalidParameter when levels and options make no sense.
[[nodiscard]] std::unique_ptr<QuestPlus> makeQuestPlus(const QuestPlusOptions& options, std::vector<double> levels,
                                                       double reference);

}  // namespace haptolith

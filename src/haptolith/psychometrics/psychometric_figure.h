#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/psychometrics/fit.h"

namespace haptolith {

/// Curve of a figure with the responses that it was fitted to.
struct FigureCurve {
  std::string title = {};  ///< "S01", "all"
  Fit fit = {};
};

/// Content of a figure of psychometric functions; similar to Fig. 5 of the paper.
struct PsychometricFigure {
  std::string title = {};
  std::string x_label = {};  ///< label with its unit: "gravity / (m/s²)"
  std::string y_label = "fraction of responses \"more\"";
  bool log_axis = false;                            ///< axis of the drawing; independent of the fits' axes
  std::optional<double> reference = std::nullopt;   ///< stimulus marked by a vertical line
  std::optional<FigureCurve> group = std::nullopt;  ///< bold curve, with band, threshold and JND
  std::vector<FigureCurve> participants = {};  ///< thin curves, each with its colour; a single one is drawn as a group
};

/// Draws points (k of n, larger for more responses), binomial (Wilson) intervals of the bold curve's points, curves and
/// the credible band. Writes an .svg or .png file atomically.
/// @throws InvalidParameter without a curve or for stimuli that are invalid on a logarithmic axis; as Figure otherwise.
void drawPsychometricFigure(const OutputFile& path, const PsychometricFigure& wanted);

/// Returns Wilson's score interval of a fraction k of n, 0 to 1 (Wilson 1927, J. Am. Stat. Assoc. 22, 209). @param n
/// above 0.
[[nodiscard]] Interval wilsonInterval(double k, double n, double confidence);

}  // namespace haptolith

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/psychometrics/fit.h"

namespace haptolith {

/// One curve of a figure with the answers it was fitted to.
struct FigureCurve {
  std::string title = {};  ///< "S01", "all"
  Fit fit = {};
};

/// What a figure of psychometric functions says and shows; like the paper's Fig. 5.
struct PsychometricFigure {
  std::string title = {};
  std::string x_label = {};  ///< with its unit: "gravity / (m/s²)"
  std::string y_label = "share of answers \"more\"";
  bool log_axis = false;                            ///< of the drawing; the fits have their own
  std::optional<double> reference = std::nullopt;   ///< marked by a vertical line
  std::optional<FigureCurve> group = std::nullopt;  ///< bold, with band, threshold and JND
  std::vector<FigureCurve> participants = {};       ///< thin, each in its colour; alone, one has what a group has
};

/// Draws points (k of n, larger for more answers), binomial (Wilson) intervals of the bold curve's points, curves and
/// the credible band, into an .svg or .png file that appears whole or not at all.
/// @throws InvalidParameter without a curve or for stimuli that a logarithmic axis cannot show; as Figure otherwise.
void drawPsychometricFigure(const OutputFile& path, const PsychometricFigure& wanted);

/// Wilson's score interval of a share k of n, 0 to 1 (Wilson 1927, J. Am. Stat. Assoc. 22, 209). @param n above 0.
[[nodiscard]] Interval wilsonInterval(double k, double n, double confidence);

}  // namespace haptolith

#include "haptolith/psychometrics/psychometric_figure.h"

#include <boost/math/special_functions/erf.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"

namespace haptolith {

namespace {

constexpr int kCurvePoints = 240;
constexpr double kMargin = 0.06;  // fraction of the axis beyond the outermost stimuli

constexpr double kDodge = 0.006;  // fraction of the axis between the points of two participants

// Okabe and Ito's colours, which colour-blind readers can discriminate; the bold curve is black. After the last colour
// they repeat with another dash.
constexpr std::array<std::string_view, 7> kColours{"#e69f00", "#56b4e9", "#009e73", "#cc79a7",
                                                   "#0072b2", "#d55e00", "#999999"};
constexpr std::array<std::string_view, 3> kDashes{"dashtype 1", "dashtype (9,4)", "dashtype (2,3)"};
constexpr std::string_view kBold = "#111111";

/// Style of a curve and its points.
struct Look {
  std::string_view colour = kBold;
  std::string_view dash = kDashes.front();
  double line_width = 3.5;
  double dodge = 0;  // fraction of the axis
  bool bold = true;
};

/// Returns the style of the i-th of `count` participants; their points are side by side.
Look lookOf(std::size_t i, std::size_t count) {
  return {.colour = kColours[i % kColours.size()],
          .dash = kDashes[i / kColours.size() % kDashes.size()],
          .line_width = 1.6,
          .dodge = kDodge * (double(i) - double(count - 1) / 2),
          .bold = false};
}

using Rows = std::vector<std::vector<double>>;

/// Returns the stimuli that are drawn, evenly along the axis.
std::vector<double> stimuliOf(const PsychometricFigure& wanted) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  const auto reach = [&](double x) {
    requireInRange(wanted.log_axis ? "x on a logarithmic axis" : "x of a figure", x,
                   {wanted.log_axis ? kLeastStimulus : -kMostStimulus, kMostStimulus});
    low = std::min(low, wanted.log_axis ? std::log(x) : x);
    high = std::max(high, wanted.log_axis ? std::log(x) : x);
  };
  const auto reach_all = [&](const FigureCurve& curve) {
    for (const Level& level : curve.fit.levels) {
      reach(level.x);
    }
  };
  std::ranges::for_each(wanted.participants, reach_all);
  if (wanted.group) {
    reach_all(*wanted.group);
  }
  if (wanted.reference) {
    reach(*wanted.reference);
  }
  const double margin = kMargin * (high - low);
  const bool at_zero = !wanted.log_axis && low >= 0 && low < margin;
  low = at_zero ? 0 : low - margin;
  high += margin;
  std::vector<double> xs;
  for (int i = 0; i <= kCurvePoints; ++i) {
    const double place = low + (high - low) * i / kCurvePoints;
    xs.push_back(wanted.log_axis ? std::exp(place) : place);
  }
  return xs;
}

/// Builds one figure: data blocks and plot clauses of gnuplot, in order.
class Drawing {
 public:
  Drawing(Figure& figure, const PsychometricFigure& wanted, std::vector<double> xs)
      : figure_(figure), wanted_(wanted), xs_(std::move(xs)) {}

  void drawBand(const Fit& fit) {
    Rows rows;
    const std::vector<double> xs = defined(fit);
    const std::vector<Interval> band = credibleBand(fit, xs);
    for (std::size_t i = 0; i < xs.size(); ++i) {
      rows.push_back({xs[i], 100 * band[i].low, 100 * band[i].high});
    }
    add(rows, fmt::format("using 1:2:3 with filledcurves fillcolor rgb '{}' fillstyle solid 0.12 noborder title {}",
                          kBold, gnuplotQuoted(fmt::format("{:g} % band", 100 * fit.confidence))));
  }

  /// Draws the threshold, where half of the responses are positive, and the JND from there.
  void drawMarks(const Fit& fit) {
    const PsychometricFunction& function = fit.function;
    const double x50 = function.threshold;
    const double x84 = x50 + jndOf(function);
    constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
    const double at50 = 100 * probability(function, x50);
    const double at84 = 100 * probability(function, x84);
    add({{x50, 0}, {x50, at50}, {kGap, kGap}, {x84, 0}, {x84, at84}},
        fmt::format("using 1:2 with lines dashtype (3,4) linewidth 1.3 linecolor rgb '{}'", kBold));
    const auto told = [](const Estimate& it) {
      return it.interval.low == it.interval.high
                 ? fmt::format("{:.3g}, fixed", it.value)
                 : fmt::format("{:.3g}, {:.3g} to {:.3g}", it.value, it.interval.low, it.interval.high);
    };
    add({{fit.threshold.interval.low, at50}, {fit.threshold.interval.high, at50}},
        "using 1:2 with lines linewidth 5 linecolor rgb '#888888'");
    // Under the title, because inside the key would cover responses.
    figure_.command(
        fmt::format("set label {} at graph 0.5,1.035 center textcolor rgb '{}'",
                    gnuplotQuoted(fmt::format("PSE {}; {} {}", told(fit.threshold), fit.w ? "Weber fraction" : "width",
                                              told(fit.w ? fit.weber_fraction : fit.width))),
                    kBold));
    if (inside(x84)) {
      figure_.command(
          fmt::format("set arrow from first {},graph 0.045 to first {},graph 0.045 heads size graph 0.012,20 "
                      "filled linewidth 1.4 linecolor rgb '{}' front",
                      x50, x84, kBold));
      figure_.command(fmt::format("set label {} at first {},graph 0.085 center front textcolor rgb '{}'",
                                  gnuplotQuoted(fmt::format("JND {:.3g}", x84 - x50)), middle(x50, x84), kBold));
    }
  }

  void drawCurve(const FigureCurve& curve, const Look& look) {
    Rows rows;
    for (const double x : defined(curve.fit)) {
      rows.push_back({x, 100 * probability(curve.fit.function, x)});
    }
    add(rows, fmt::format("using 1:2 with lines linewidth {} {} linecolor rgb '{}' title {}", look.line_width,
                          look.dash, look.colour, gnuplotQuoted(curve.title)));
  }

  void drawPoints(const Fit& fit, const Look& look) {
    Rows rows;
    for (const Level& level : fit.levels) {
      const Interval interval = wilsonInterval(level.k, level.n, fit.confidence);
      const double size = (look.bold ? 0.6 : 0.4) + 0.22 * std::sqrt(level.n);
      rows.push_back(
          {dodged(level.x, look.dodge), 100 * level.k / level.n, 100 * interval.low, 100 * interval.high, size});
    }
    if (look.bold) {
      add(rows, fmt::format("using 1:2:3:4 with yerrorbars pointtype 7 pointsize 0 linewidth 1.4 linecolor rgb '{}'",
                            look.colour));
    }
    add(rows, fmt::format("using 1:2:5 with points pointtype 7 pointsize variable linecolor rgb '{}'", look.colour));
  }

  void plot() {
    figure_.command(fmt::format("set xrange [{}:{}]", xs_.front(), xs_.back()));
    figure_.command(plot_);
  }

 private:
  void add(const Rows& rows, std::string_view how) {
    const std::string name = fmt::format("rows{}", clauses_++);
    figure_.data(name, rows);
    plot_ += fmt::format("{}${} {}", plot_.empty() ? "plot " : ", \\\n     ", name, how);
  }

  /// Returns the drawn stimuli that are valid on the fit's axis.
  [[nodiscard]] std::vector<double> defined(const Fit& fit) const {
    std::vector<double> xs = xs_;
    if (fit.function.log_axis) {
      std::erase_if(xs, [](double x) { return x <= 0; });
    }
    return xs;
  }

  /// Returns a stimulus shifted by a fraction of the axis.
  [[nodiscard]] double dodged(double x, double share) const {
    return wanted_.log_axis ? x * std::pow(xs_.back() / xs_.front(), share) : x + share * (xs_.back() - xs_.front());
  }

  [[nodiscard]] bool inside(double x) const { return xs_.front() <= x && x <= xs_.back(); }

  [[nodiscard]] double middle(double a, double b) const { return wanted_.log_axis ? std::sqrt(a * b) : (a + b) / 2; }

  Figure& figure_;
  const PsychometricFigure& wanted_;
  std::vector<double> xs_;
  std::string plot_;
  int clauses_ = 0;
};

/// Returns tics at 1, 2 and 5 of every drawn decade; more of them in a short range, and at most a dozen decades.
std::string logarithmicTics(const std::vector<double>& xs) {
  const double decades = std::log10(xs.back() / xs.front());
  const std::vector<double> steps = decades < 0.8   ? std::vector{1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0}
                                    : decades < 2.5 ? std::vector{1.0, 2.0, 3.0, 5.0}
                                                    : std::vector{1.0};
  constexpr double kMostDecades = 12;
  const double stride = std::ceil(decades / kMostDecades);
  std::string tics;
  for (double decade = std::floor(std::log10(xs.front())); decade < std::log10(xs.back()); decade += stride) {
    for (const double step : steps) {
      const double tic = step * std::pow(10, decade);
      if (xs.front() <= tic && tic <= xs.back()) {
        tics += fmt::format("{}'{:.4g}' {}", tics.empty() ? "" : ",", tic, tic);
      }
    }
  }
  return tics;
}

void setAxes(Figure& figure, const PsychometricFigure& wanted, const std::vector<double>& xs) {
  figure.command(fmt::format(R"(
set title {} offset 0,1.2
set tmargin 5
set xlabel {}
set ylabel {}
set yrange [-3:103]
set ytics 0,25,100 format '%.0f %%'
set key outside right center Left reverse samplen 2.2 spacing 1.3
set bars 0.5
)",
                             gnuplotQuoted(wanted.title), gnuplotQuoted(wanted.x_label),
                             gnuplotQuoted(wanted.y_label)));
  if (wanted.log_axis) {
    figure.command(fmt::format("set logscale x\nset xtics ({})\nset mxtics 1", logarithmicTics(xs)));
  }
  if (wanted.reference) {
    figure.command(
        fmt::format("set arrow from first {0},graph 0 to first {0},graph 1 nohead linewidth 1.2 "
                    "linecolor rgb '#aaaaaa' back",
                    *wanted.reference));
    figure.command(
        fmt::format("set label 'reference' at first {},graph 0.985 right rotate by 90 offset -0.6,0 "
                    "textcolor rgb '#888888' back",
                    *wanted.reference));
  }
}

}  // namespace

Interval wilsonInterval(double k, double n, double confidence) {
  requireInRange("n", n, {.lowest = 0, .ends = Ends::kOpen});
  const double z = std::numbers::sqrt2 * boost::math::erf_inv(confidence);
  const double share = k / n;
  const double middle = (share + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(share * (1 - share) / n + z * z / (4 * n * n));
  return {std::max(middle - half, 0.0), std::min(middle + half, 1.0)};
}

void drawPsychometricFigure(const OutputFile& path, const PsychometricFigure& wanted) {
  if (wanted.participants.empty() && !wanted.group) {
    throw InvalidParameter("curves of a figure", "none", "one or more");
  }
  Figure figure(path, 1000, 640);
  const std::vector<double> xs = stimuliOf(wanted);
  setAxes(figure, wanted, xs);
  Drawing drawing(figure, wanted, xs);
  const bool alone = !wanted.group && wanted.participants.size() == 1;
  const FigureCurve* bold = wanted.group ? &*wanted.group : alone ? &wanted.participants.front() : nullptr;
  if (bold != nullptr) {
    drawing.drawBand(bold->fit);
    drawing.drawMarks(bold->fit);
  }
  if (!alone) {
    for (std::size_t i = 0; i < wanted.participants.size(); ++i) {
      const Look look = lookOf(i, wanted.participants.size());
      drawing.drawCurve(wanted.participants[i], look);
      drawing.drawPoints(wanted.participants[i].fit, look);
    }
  }
  if (bold != nullptr) {
    drawing.drawCurve(*bold, {});
    drawing.drawPoints(bold->fit, {});
  }
  drawing.plot();
  figure.save();
}

}  // namespace haptolith

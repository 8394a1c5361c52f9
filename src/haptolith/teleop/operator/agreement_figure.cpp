#include "haptolith/teleop/operator/agreement_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"

namespace haptolith {

namespace {

constexpr int kWidth_px = 1200, kPanelHeight_px = 230, kMargins_px = 120;
// Two of Okabe and Ito's colours, distinguishable for colour-blind readers.
constexpr const char* kDisplayed = "#0072b2";
constexpr const char* kMet = "#d55e00";

double strongestOf(const AgreementPanel& panel) {
  double strongest_n = 0;
  for (const AgreementPoint& point : panel.points) {
    strongest_n = std::max({strongest_n, point.displayed_n.norm(), point.met_n.norm()});
  }
  return strongest_n;
}

/// Index of the panel with room for the legend.
std::size_t quietestOf(const std::vector<AgreementPanel>& panels) {
  const auto quietest = std::ranges::min_element(panels, {}, strongestOf);
  return static_cast<std::size_t>(quietest - panels.begin());
}

}  // namespace

void drawAgreement(const OutputFile& file, const std::vector<AgreementPanel>& panels) {
  if (panels.empty()) {
    throw InvalidParameter("panels", "none", "one or more");
  }
  double longest_s = 1, strongest_n = 1;
  for (const AgreementPanel& panel : panels) {
    strongest_n = std::max(strongest_n, strongestOf(panel));
    for (const AgreementPoint& point : panel.points) {
      longest_s = std::max(longest_s, point.time_s);
    }
  }
  const std::size_t quietest = quietestOf(panels);
  const std::size_t columns = std::min<std::size_t>(2, panels.size());
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  const int height_px = kPanelHeight_px * static_cast<int>(rows) + kMargins_px;
  const double bottom = 60.0 / height_px;
  Figure figure(file, kWidth_px, height_px);
  figure.command(fmt::format(
      "set multiplot layout {},{} margins 0.06,0.985,{},{} spacing 0.06,{}\nset border 3\nset grid ytics linecolor rgb "
      "'#e6e6e6'\nset xtics nomirror scale 0.5\nset ytics nomirror scale 0.5\nset xrange [0:{}]\nset yrange "
      "[0:{}]\nset "
      "key top right samplen 1.5",
      rows, columns, bottom, 1 - 40.0 / height_px, 80.0 / height_px, longest_s, 1.05 * strongest_n));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    std::vector<std::vector<double>> data;
    for (const AgreementPoint& point : panels[i].points) {
      data.push_back({point.time_s, point.displayed_n.norm(), point.met_n.norm()});
    }
    const std::string name = fmt::format("run{}", i);
    figure.data(name, data);
    figure.command(fmt::format("set title {} font ',11'\nset ylabel '{}'\nset xlabel '{}'\nset key {}",
                               gnuplotQuoted(panels[i].title), i % columns == 0 ? "force, N" : "",
                               i + columns >= panels.size() ? "time of the command, s" : "",
                               i == quietest ? "on" : "off"));
    figure.command(
        data.empty()
            ? std::string("plot NaN notitle")
            : fmt::format("plot ${0} using 1:3 with lines linewidth 2.5 linecolor rgb '{2}' title 'remote force', ${0} "
                          "using 1:2 with lines linewidth 1.5 linecolor rgb '{1}' title 'rendered force'",
                          name, kDisplayed, kMet));
  }
  figure.command("unset multiplot");
  figure.save();
}

}  // namespace haptolith

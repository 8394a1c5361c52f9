#include "haptolith/study/results/teleop_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "haptolith/figure/figure.h"

namespace haptolith {

namespace {

constexpr std::size_t kMostColumns = 4;
constexpr int kPanelWidth_px = 340, kPanelHeight_px = 340, kTitle_px = 60;
constexpr double kBesideTheBars = 0.12;  // offset of the participants' points, fraction of a block's width

/// Measure shown in a panel; blocks may differ in the items of their forms.
struct TaskPanel {
  std::string name, unit;
};

std::vector<TaskPanel> panelsOf(const std::vector<TeleopBlockResult>& results) {
  std::vector<TaskPanel> panels;
  for (const TeleopBlockResult& result : results) {
    for (const TeleopMeasure& measure : result.measures) {
      if (std::ranges::find(panels, measure.name, &TaskPanel::name) == panels.end()) {
        panels.push_back({measure.name, measure.unit});
      }
    }
  }
  return panels;
}

const TeleopMeasure* measureIn(const TeleopBlockResult& result, const TaskPanel& panel) {
  const auto found = std::ranges::find(result.measures, panel.name, &TeleopMeasure::name);
  return found == result.measures.end() ? nullptr : &*found;
}

/// Returns tick labels with names and delays of the blocks.
std::string ticsOf(const StudyProtocol& protocol, const std::vector<TeleopBlockResult>& results) {
  std::string tics;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const StudyBlock& block = protocol.blocks[results[i].block];
    tics += fmt::format("{}{} {}", i == 0 ? "" : ", ",
                        gnuplotQuoted(fmt::format("{}, {:g} s", block.name, block.teleop->round_trip_s)), i);
  }
  return tics;
}

}  // namespace

void drawTeleopFigure(const OutputFile& path, const StudyProtocol& protocol,
                      const std::vector<TeleopBlockResult>& results, double confidence, std::string_view title) {
  const std::vector<TaskPanel> panels = panelsOf(results);
  const std::size_t rows = (panels.size() + kMostColumns - 1) / kMostColumns;
  const std::size_t columns = (panels.size() + rows - 1) / rows;
  const int height_px = kTitle_px + kPanelHeight_px * static_cast<int>(rows);
  Figure figure(path, kPanelWidth_px * static_cast<int>(columns), height_px);
  figure.command(fmt::format(
      "set multiplot layout {},{} margins {:.3f},0.985,{:.3f},{:.3f} spacing {:.3f},{:.3f} title {}\n"
      "set border 3\nset grid ytics linecolor rgb '#e6e6e6'\nset xtics nomirror scale 0 rotate by 30 right\n"
      "set ytics nomirror scale 0.5\nset bars 0.6\nset key off\nset xrange [-0.5:{}]\nset xtics ({})",
      rows, columns, 0.22 / static_cast<double>(columns), 85.0 / height_px, 1 - (kTitle_px + 35.0) / height_px,
      0.25 / static_cast<double>(columns), 135.0 / height_px,
      gnuplotQuoted(fmt::format("{}: each person, and the mean with its {:g} % interval", title, 100 * confidence)),
      static_cast<double>(results.size()) - 0.5, ticsOf(protocol, results)));
  for (std::size_t p = 0; p < panels.size(); ++p) {
    std::map<std::int64_t, std::vector<std::vector<double>>> people;
    std::vector<std::vector<double>> means;
    double highest = 0;
    for (std::size_t i = 0; i < results.size(); ++i) {
      const auto x = static_cast<double>(i);
      const TeleopMeasure* measure = measureIn(results[i], panels[p]);
      if (measure == nullptr || measure->of_people.empty()) {
        continue;
      }
      for (const auto& [person, value] : measure->of_people) {
        people[person].push_back({x - kBesideTheBars, value});
        highest = std::max(highest, value);
      }
      const PeopleMean mean = meanOf(*measure, confidence);
      means.push_back({x + kBesideTheBars, mean.mean, mean.interval.low, mean.interval.high});
      highest = std::isnan(mean.interval.high) ? highest : std::max(highest, mean.interval.high);
    }
    if (means.empty()) {
      figure.command("set multiplot next");
      continue;
    }
    std::string plot;
    for (const auto& [person, values] : people) {
      const std::string data = fmt::format("person{}_{}", p, person);
      figure.data(data, values);
      plot +=
          fmt::format("{}${} using 1:2 with linespoints pointtype 7 pointsize 0.7 linewidth 1 linecolor rgb '#9aa7b1'",
                      plot.empty() ? "plot " : ", ", data);
    }
    const std::string data = fmt::format("mean{}", p);
    figure.data(data, means);
    plot += fmt::format(
        ", ${0} using 1:2:3:4 with yerrorbars pointtype 7 pointsize 1.2 linewidth 2 linecolor rgb '#0072b2', "
        "${0} using 1:2 with points pointtype 7 pointsize 1.2 linecolor rgb '#0072b2'",
        data);
    figure.command(fmt::format("set title {}\nset yrange [0:{}]",
                               gnuplotQuoted(fmt::format("{}, {}", panels[p].name, panels[p].unit)),
                               highest > 0 ? 1.08 * highest : 1.0));
    figure.command(plot);
  }
  figure.command("unset multiplot");
  figure.save();
}

}  // namespace haptolith

#include <fmt/format.h>

#include <vector>

#include "haptolith/figure/figure.h"
#include "haptolith/identify/check/soil_check.h"

namespace haptolith {

namespace {

constexpr int kWidth_px = 1200, kHeight_px = 470;
// Two of Okabe and Ito's colours, which colour-blind readers can discriminate.
constexpr const char* kSoil = "#0072b2";
constexpr const char* kStone = "#d55e00";

/// Quantity of the soils, and its plot settings.
struct Panel {
  const char* title;
  const char* unit;
  const char* axes;
  double (*truth)(const CheckedSoil&);
  const SoilEstimate& (*told)(const CheckedSoil&);
};

constexpr Panel kPanels[]{
    {"friction angle, residual", "degrees", "[15:55]", [](const CheckedSoil& s) { return s.truth.friction_angle_deg; },
     [](const CheckedSoil& s) -> const SoilEstimate& { return s.belief.friction_angle_deg; }},
    {"cohesion, residual", "Pa", "[0:1200]", [](const CheckedSoil& s) { return s.truth.cohesion_pa; },
     [](const CheckedSoil& s) -> const SoilEstimate& { return s.belief.cohesion_pa; }},
    {"soil-tool friction", "degrees", "[0:40]", [](const CheckedSoil& s) { return s.tool_friction_angle_deg; },
     [](const CheckedSoil& s) -> const SoilEstimate& { return s.belief.tool_friction_angle_deg; }}};

std::vector<std::vector<double>> rowsOf(const std::vector<CheckedSoil>& soils, const Panel& panel, bool with_stone) {
  std::vector<std::vector<double>> rows;
  for (const CheckedSoil& soil : soils) {
    if (soil.has_stone == with_stone) {
      const SoilEstimate& told = panel.told(soil);
      rows.push_back({panel.truth(soil), told.middle, told.low, told.high});
    }
  }
  return rows;
}

}  // namespace

void drawCheck(const OutputFile& file, const std::vector<CheckedSoil>& soils) {
  Figure figure(file, kWidth_px, kHeight_px);
  figure.command(
      "set multiplot layout 1,3 margins 0.06,0.985,0.14,0.88 spacing 0.07,0\nset border 3\nset grid linecolor rgb "
      "'#e6e6e6'\nset xtics nomirror scale 0.5\nset ytics nomirror scale 0.5\nset key top left samplen 1.5");
  int number = 0;
  for (const Panel& panel : kPanels) {
    const std::string soil = fmt::format("soil{}", number), stone = fmt::format("stone{}", number);
    figure.data(soil, rowsOf(soils, panel, false));
    figure.data(stone, rowsOf(soils, panel, true));
    figure.command(
        fmt::format("set title '{}'\nset xlabel 'measured by a shear test, {}'\nset ylabel 'estimated from forces, "
                    "{}'\nset xrange {}\nset yrange {}\nset key {}",
                    panel.title, panel.unit, panel.unit, panel.axes, panel.axes, number == 0 ? "on" : "off"));
    if (number == 2) {
      figure.command("set xlabel 'set, degrees'");
    }
    figure.command(
        fmt::format("plot x with lines linecolor rgb '#888888' notitle, ${0} using 1:2:3:4 with yerrorbars pointtype 7 "
                    "pointsize 0.6 "
                    "linecolor rgb '{2}' title 'soil, 90 % interval', ${1} using 1:2:3:4 with yerrorbars pointtype 5 "
                    "pointsize 0.8 "
                    "linecolor rgb '{3}' title 'with a stone in it'",
                    soil, stone, kSoil, kStone));
    ++number;
  }
  figure.command("unset multiplot");
  figure.save();
}

}  // namespace haptolith

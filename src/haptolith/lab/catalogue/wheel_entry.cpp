// Catalogue entry of the wheel test: options, table, numbers, comparison with measurements.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/table.h"
#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/lab/tests/wheel.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

/// Options as given.
struct WheelGiven {
  WheelOptions options;
  std::vector<double> slips{-0.5, 0, 0.2, 0.5, 0.8};
  std::vector<double> slip_angles_rad{0};
  double load_n = 20;
  std::string measured_file;
  bool slips_given = false, angles_given = false;
};

/// Reads measurements: slip, slip angle, load, forces and sinkage.
std::vector<MeasuredWheel> readMeasured(const std::string& file) {
  constexpr std::array<std::string_view, 6> kNames{"slip", "slip_angle_deg", "load_n", "f_x_n", "f_y_n", "sinkage_mm"};
  constexpr TextLimits kLimits{.bytes = 10'000'000, .line_bytes = 10'000, .rows = 10'000};
  Table table(file, {.columns = kNames, .limits = kLimits});
  const std::vector<Table::Column> columns = table.columns(kNames);
  std::vector<MeasuredWheel> measured;
  while (table.next()) {
    measured.push_back({.setting = {.slip = std::max(-1.0, table.number(columns[0], {-1.01, 0.95})),
                                    .slip_angle_rad = radians(table.number(columns[1], {-90, 90})),
                                    .load_n = table.number(columns[2], {0, 1e5, Ends::kOpenBelow})},
                        .drawbar_n = table.number(columns[3]),
                        .side_n = table.number(columns[4]),
                        .sinkage_m = table.number(columns[5]) * kMm});
  }
  return measured;
}

bool isAmong(double value, const std::vector<double>& values) {
  constexpr double kRounding = 5e-3;  // measured slip differs from the wanted one
  return std::ranges::any_of(values, [&](double other) { return std::abs(value - other) <= kRounding; });
}

/// Sets the settings; returns the measurements, one per setting, or none.
std::vector<MeasuredWheel> chooseSettings(const WheelGiven& given, WheelOptions& options) {
  std::vector<MeasuredWheel> measured;
  if (given.measured_file.empty()) {
    for (const double angle_rad : given.slip_angles_rad) {
      for (const double slip : given.slips) {
        options.settings.push_back({slip, angle_rad, given.load_n});
      }
    }
    return measured;
  }
  if (options.sinkage_m > 0) {
    throw InvalidParameter("measured", given.measured_file, "left out with sinkage_mm: it is compared under its loads");
  }
  for (const MeasuredWheel& point : readMeasured(given.measured_file)) {
    if ((!given.slips_given || isAmong(point.setting.slip, given.slips)) &&
        (!given.angles_given || isAmong(point.setting.slip_angle_rad, given.slip_angles_rad))) {
      measured.push_back(point);
      options.settings.push_back(point.setting);
    }
  }
  if (measured.empty()) {
    throw InvalidParameter("measured", given.measured_file, "a table with rows of these slips and slip angles");
  }
  return measured;
}

std::string wheelTable(const WheelResult& result) {
  std::string text = "   slip   angle   load / N   drawbar / load    side / load   torque / (load r)   sinkage / mm\n";
  for (const WheelPoint& point : result.points) {
    const double load_n = point.vertical_n.value;
    const auto over_load = [&](const WheelMean& mean, double unit) {
      return fmt::format("{:.3f} ± {:.3f}", mean.value / unit, mean.sd / unit);
    };
    text += fmt::format("  {:>5.2f}   {:>4.0f}°   {:>8.3g}   {:>14}  {:>13}   {:>17}   {:>12}{}\n", point.setting.slip,
                        degrees(point.setting.slip_angle_rad), load_n, over_load(point.drawbar_n, load_n),
                        over_load(point.side_n, load_n), over_load(point.torque_nm, load_n * result.radius_m),
                        fmt::format("{:.1f} ± {:.1f}", point.sinkage_m.value / kMm, point.sinkage_m.sd / kMm),
                        point.is_steady ? "" : "   not steady");
    const auto theory = [&](std::string_view name, double vertical_n, double drawbar_n, double side_n, double torque_nm,
                            double sinkage_m) {
      text += fmt::format("  {:<16} {:>8.3g}   {:>14.3f}  {:>13.3f}   {:>17.3f}   {:>12.1f}\n", name, vertical_n,
                          drawbar_n / vertical_n, side_n / vertical_n, torque_nm / vertical_n / result.radius_m,
                          sinkage_m / kMm);
    };
    if (const auto& rft = point.resistive) {
      theory("  rft", rft->vertical_n, rft->drawbar_n, rft->side_n, rft->torque_nm, rft->sinkage_m);
    }
    if (const auto& bekker = point.bekker) {
      theory("  bekker-wong", bekker->vertical_n, bekker->drawbar_n, 0, bekker->torque_nm, bekker->sinkage_m);
    }
  }
  text += fmt::format("\n  bulk density {:.0f} kg/m³, {} particles, bed {:.0f} mm deep\n", result.bulk_density_kg_m3,
                      result.particles, result.bed_depth_m / kMm);
  return text;
}

Json pointJson(const WheelPoint& point, double radius_m) {
  const double load_n = point.vertical_n.value;
  Json json = {{"slip", point.setting.slip},
               {"slip_angle_deg", degrees(point.setting.slip_angle_rad)},
               {"travel_m_s", point.travel_m_s},
               {"rim_m_s", point.rim_m_s},
               {"vertical_n", load_n},
               {"vertical_sd_n", point.vertical_n.sd},
               {"drawbar_n", point.drawbar_n.value},
               {"drawbar_sd_n", point.drawbar_n.sd},
               {"side_n", point.side_n.value},
               {"side_sd_n", point.side_n.sd},
               {"torque_nm", point.torque_nm.value},
               {"torque_sd_nm", point.torque_nm.sd},
               {"sinkage_mm", point.sinkage_m.value / kMm},
               {"sinkage_sd_mm", point.sinkage_m.sd / kMm},
               {"sinkage_change_mm", point.sinkage_change_m / kMm},
               {"steady", point.is_steady},
               {"drawbar_over_load", point.drawbar_n.value / load_n},
               {"side_over_load", point.side_n.value / load_n},
               {"torque_over_load_radius", point.torque_nm.value / load_n / radius_m},
               {"sinkage_over_radius", point.sinkage_m.value / radius_m}};
  json["resistive"] = nullptr;
  if (const auto& rft = point.resistive) {
    json["resistive"] = {{"vertical_n", rft->vertical_n},
                         {"drawbar_n", rft->drawbar_n},
                         {"side_n", rft->side_n},
                         {"torque_nm", rft->torque_nm},
                         {"sinkage_mm", rft->sinkage_m / kMm}};
  }
  json["bekker_wong"] = nullptr;
  if (const auto& bekker = point.bekker) {
    json["bekker_wong"] = {{"vertical_n", bekker->vertical_n},
                           {"drawbar_n", bekker->drawbar_n},
                           {"torque_nm", bekker->torque_nm},
                           {"sinkage_mm", bekker->sinkage_m / kMm}};
  }
  return json;
}

Json comparisonJson(const WheelComparison& comparison) {
  return {{"points", comparison.points},
          {"drawbar_error", comparison.drawbar_error},
          {"side_error", comparison.side_error},
          {"slipping_points", comparison.slipping},
          {"drawbar_sign", comparison.drawbar_sign},
          {"side_sign", comparison.side_sign},
          {"sinkage_within", comparison.sinkage_within}};
}

std::string comparisonText(std::string_view name, const WheelComparison& comparison) {
  return fmt::format("  {:<10} {:>20.3f}   {:>15.3f}   {:>15.0f} %   {:>12.0f} %   {:>14.0f} %\n", name,
                     comparison.drawbar_error, comparison.side_error, 100 * comparison.drawbar_sign,
                     100 * comparison.side_sign, 100 * comparison.sinkage_within);
}

void compareWithMeasured(const WheelResult& result, const std::vector<MeasuredWheel>& measured, LabOutput& output) {
  std::vector<WheelEstimate> simulated;
  std::vector<WheelEstimate> theory;
  Json& points = output.json["points"];
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const WheelPoint& point = result.points[i];
    simulated.push_back({point.drawbar_n.value, point.side_n.value, point.sinkage_m.value});
    if (const auto& rft = point.resistive) {
      theory.push_back({rft->drawbar_n, rft->side_n, rft->sinkage_m});
    }
    points[i]["measured"] = {{"load_n", measured[i].setting.load_n},
                             {"drawbar_n", measured[i].drawbar_n},
                             {"side_n", measured[i].side_n},
                             {"sinkage_mm", measured[i].sinkage_m / kMm}};
  }
  output.text += fmt::format(
      "\n  compared with {} measured points, |slip| above 0.2 for the signs\n"
      "             median |error| of drawbar / load   side / load   sign of drawbar    of side      sinkage within "
      "35 %\n",
      measured.size());
  const WheelComparison comparison = compareWheel(measured, simulated);
  output.text += comparisonText("simulated", comparison);
  output.json["compared"] = comparisonJson(comparison);
  output.json["compared_resistive"] = nullptr;
  if (theory.size() == measured.size()) {
    const WheelComparison of_theory = compareWheel(measured, theory);
    output.text += comparisonText("rft", of_theory);
    output.json["compared_resistive"] = comparisonJson(of_theory);
  }
}

LabOutput wheelOutput(const LabSoil& soil, const LabConditions& conditions, const WheelGiven& given) {
  WheelOptions options = given.options;
  const std::vector<MeasuredWheel> measured = chooseSettings(given, options);
  if (options.friction_angle_rad == 0 && soil.target) {
    options.friction_angle_rad = radians(soil.target->friction_angle_deg);
  }
  const WheelResult result = wheelTest(conditions, options);
  LabOutput output;
  output.text = wheelTable(result);
  Json points = Json::array();
  for (const WheelPoint& point : result.points) {
    points.push_back(pointJson(point, result.radius_m));
  }
  output.json = {{"points", points},
                 {"diameter_mm", options.wheel.diameter_m / kMm},
                 {"width_mm", options.wheel.width_m / kMm},
                 {"grousers", options.wheel.grousers},
                 {"preparation", preparationWord(options.preparation)},
                 {"friction_angle_deg", degrees(options.friction_angle_rad)},
                 {"bulk_density_kg_m3", result.bulk_density_kg_m3},
                 {"bed_depth_mm", result.bed_depth_m / kMm},
                 {"particles", result.particles}};
  if (!measured.empty()) {
    compareWithMeasured(result, measured, output);
  }
  output.trace = result.trace;
  output.draw = [result, measured](const OutputFile& path, const std::string& title) {
    drawWheel(path, result, title, measured);
  };
  return output;
}

/// Returns a list option that also notes that it was given.
LabOption noted(LabOption option, bool& given) {
  option.set =
      LabOption::List([set = std::get<LabOption::List>(option.set), &given](const std::vector<double>& values) {
        given = true;
        set(values);
      });
  return option;
}

}  // namespace

LabTest wheelEntry() {
  auto own = std::make_shared<WheelGiven>();
  WheelOptions& options = own->options;
  return {
      .name = "wheel",
      .description = "Drive a wheel through soil: drawbar pull, side force, torque and sinkage over slip",
      .examples =
          "  haptolith lab wheel --soil toyoura --body Earth --slip -0.5,0,0.5 --load-n 20 --figure wheel.svg\n"
          "  haptolith lab wheel --slip 0.3 --slip-angle-deg 0,30 --sinkage-mm 15 --grousers 12",
      .radius_mm = 5,
      .in_report = false,
      .typical_s = 300,
      .options = {noted(listOption("slip", own->slips, 1,
                                   "Slips: 1 - travel/rim speed when driven, rim/travel speed - 1 when braked"),
                        own->slips_given),
                  noted(listOption("slip_angle_deg", own->slip_angles_rad, radians(1),
                                   "Angles of the wheel's plane to the left of the path"),
                        own->angles_given),
                  numberOption("load_n", own->load_n, "Constant vertical load, on a free slide"),
                  {.key = "sinkage_mm",
                   .help = "Constant sinkage",
                   .usual = "constant load",
                   .set = LabOption::Number([own](double mm) { own->options.sinkage_m = mm * kMm; })},
                  {.key = "mass_kg",
                   .help = "Mass that moves with the slide",
                   .usual = "the load over gravity",
                   .set = LabOption::Number([own](double kg) { own->options.mass_kg = kg; })},
                  {.key = "travel_mm_s",
                   .help = "Speed of travel, less where the rim would exceed 200 mm/s",
                   .usual = "80",
                   .set = LabOption::Number([own](double mm_s) { own->options.travel_m_s = mm_s * kMm; })},
                  millimetresOption("travel_mm", options.travel_m, "Distance; its last 40 % is evaluated"),
                  millimetresOption("diameter_mm", options.wheel.diameter_m, "Diameter of the rim"),
                  millimetresOption("width_mm", options.wheel.width_m, "Width of the wheel"),
                  countOption("grousers", options.wheel.grousers, {0, 60}, "Number of bars across the rim"),
                  millimetresOption("grouser_height_mm", options.wheel.grouser_height_m,
                                    "Height of the bars over the rim"),
                  millimetresOption("grouser_thickness_mm", options.wheel.grouser_thickness_m, "Thickness of the bars"),
                  numberOption("wheel_friction", options.wheel.friction, "Friction coefficient between wheel and soil"),
                  {.key = "bed_depth_mm",
                   .help = "Depth of the soil as filled",
                   .usual = "the diameter",
                   .set = LabOption::Number([own](double mm) { own->options.bed_depth_m = mm * kMm; })},
                  preparationOption(options.preparation),
                  depthFromOption(options.depth_from),
                  {.key = "friction_angle_deg",
                   .help = "Friction angle for the theories",
                   .usual = "the soil's",
                   .set = LabOption::Number([own](double deg) { own->options.friction_angle_rad = radians(deg); })},
                  {.key = "plate_modulus",
                   .help = "Factor k of p = k z^n in Pa/m^n, for the theory of Bekker and Wong",
                   .usual = "not compared",
                   .set = LabOption::Number([own](double modulus) { own->options.plate.modulus = modulus; })},
                  numberOption("plate_exponent", options.plate.exponent, "Exponent n of p = k z^n"),
                  textOption(
                      "measured", own->measured_file,
                      "Table of measured settings to simulate and to compare with (.csv), of these slips and angles")},
      .run = [own](const LabSoil& soil, const LabConditions& conditions) {
        return wheelOutput(soil, conditions, *own);
      }};
}

}  // namespace haptolith

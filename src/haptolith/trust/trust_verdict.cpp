#include "haptolith/trust/trust_verdict.h"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/report/specimen_statistics.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kFelt_mean = 0.1;      ///< changes of the mean force that are complained of
constexpr double kFelt_peak = 0.2;      ///< changes of the peak
constexpr double kLeastForce_n = 1e-6;  ///< less is no contact

/// Mean of the ratios minus 1, and its standard error.
TrustShift shiftOf(const std::vector<double>& ratios) {
  const Scatter scatter = scatterOf(ratios);
  const double n = static_cast<double>(scatter.specimens);
  return {scatter.mean - 1, scatter.specimens > 1 ? scatter.sd / std::sqrt(n) : std::abs(scatter.mean - 1)};
}

TrustEffect effectOf(const TrustForces& changed, const TrustForces& usual) {
  TrustEffect effect{.change = changed.change, .radius_ratio = changed.radius_ratio, .why_not = changed.why_not};
  std::vector<double> mean, peak;
  for (std::size_t i = 0; i < std::min(changed.specimens.size(), usual.specimens.size()); ++i) {
    const auto& now = changed.specimens[i];
    const auto& before = usual.specimens[i];
    if (now && before && before->mean_n > 0 && before->peak_n > 0) {
      mean.push_back(now->mean_n / before->mean_n);
      peak.push_back(now->peak_n / before->peak_n);
    }
  }
  effect.specimens = mean.size();
  if (!mean.empty()) {
    effect.mean = shiftOf(mean);
    effect.peak = shiftOf(peak);
  }
  return effect;
}

/// The effect of the limit that a change goes towards: of half the radius, by a straight line in R.
TrustShift towardsLimit(const TrustEffect& effect, bool peak) {
  const TrustShift& shift = peak ? effect.peak : effect.mean;
  if (effect.change != TrustChange::kRadius) {
    return shift;
  }
  const double factor = 0.5 / (1 - effect.radius_ratio);
  return {factor * shift.value, std::abs(factor) * shift.error};
}

bool isOfBoxOrRadius(TrustChange change) {
  return change == TrustChange::kWideX || change == TrustChange::kWideY || change == TrustChange::kDeep ||
         change == TrustChange::kRadius;
}

const char* complaintOf(TrustChange change) {
  switch (change) {
    case TrustChange::kNone: return "specimens differ";
    case TrustChange::kWideX: return "the box is too narrow along x";
    case TrustChange::kWideY: return "the box is too narrow along y";
    case TrustChange::kDeep: return "the floor is felt";
    case TrustChange::kRadius: return "the particles are too large";
    case TrustChange::kStep: return "the step is too long";
    case TrustChange::kAwake: return "sleep changes the force";
    case TrustChange::kStiff: return "the contacts are too soft";
    case TrustChange::kMesh: return "the tool's mesh has another force than its shape";
  }
  return "";
}

bool isFelt(const TrustEffect& effect) {
  const auto exceeds = [&](bool peak, double limit) {
    const TrustShift shift = towardsLimit(effect, peak);
    return std::abs(shift.value) > std::max(limit, 2 * shift.error);
  };
  return effect.specimens > 0 && (exceeds(false, kFelt_mean) || exceeds(true, kFelt_peak));
}

/// Rules for intruders: a passive wedge of 40 degrees is tan(65 degrees) = 2.1 depths long and disturbs soil to half a
/// tool's width below it, and blades want 8 particles across (docs/reports/accuracy.md).
TrustRoom roomOf(const SceneFile& scene, const TrustReach& reach) {
  TrustRoom room;
  if (reach.depth_m <= 0) {
    return room;
  }
  const double diameter_m = 2 * scene.bed.soil.radius_m;
  const ToolCorners box = cornersOf(scene.tool);
  std::array<double, 3> edges{};
  for (int axis = 0; axis < 3; ++axis) {
    edges.at(static_cast<std::size_t>(axis)) = box.high_m[axis] - box.low_m[axis];
  }
  std::ranges::sort(edges);
  const double wedge_m = std::tan(65 * std::numbers::pi / 180) * reach.depth_m + diameter_m;
  if (!scene.bed.periodic_x) {
    room.wall_x = reach.to_wall_x_m / wedge_m;
  }
  if (!scene.bed.periodic_y) {
    room.wall_y = reach.to_wall_y_m / wedge_m;
  }
  room.floor = reach.to_floor_m / (edges[1] / 2 + diameter_m);
  const double finest_m = scene.bed.grading.fine_radius_m > 0 ? 2 * scene.bed.grading.fine_radius_m : diameter_m;
  room.grains = edges[1] / (8 * finest_m);
  return room;
}

/// Whether an effect may be as large as what is complained of: it was not measured, or not well enough.
bool mayBeFelt(const std::vector<TrustEffect>& effects, TrustChange change) {
  const auto found = std::ranges::find(effects, change, &TrustEffect::change);
  if (found == effects.end() || found->specimens == 0) {
    return true;
  }
  const TrustShift shift = towardsLimit(*found, false);
  return std::abs(shift.value) + 2 * shift.error > kFelt_mean;
}

bool isAsStrongAsAsked(const TrustStrength& strength) {
  constexpr double kWithin_deg = 2;
  constexpr double kWithin = 0.2, kWithin_pa = 50;
  return std::abs(strength.shown_deg - strength.asked_deg) <= std::max(kWithin_deg, 2 * strength.error_deg) &&
         std::abs(strength.shown_pa - strength.asked_pa) <=
             std::max({kWithin * strength.asked_pa, kWithin_pa, 2 * strength.error_pa});
}

struct TooClose {
  TrustChange change;
  const char* what;
};

/// Returns parts with less than half of the room that rules ask for.
std::vector<TooClose> tooClose(const TrustRoom& room) {
  constexpr double kClearlyLess = 0.5;
  std::vector<TooClose> close;
  if (room.wall_x < kClearlyLess) {
    close.push_back({TrustChange::kWideX, "the walls along x"});
  }
  if (room.wall_y < kClearlyLess) {
    close.push_back({TrustChange::kWideY, "the walls along y"});
  }
  if (room.floor < kClearlyLess) {
    close.push_back({TrustChange::kDeep, "the floor"});
  }
  if (room.grains < kClearlyLess) {
    close.push_back({TrustChange::kRadius, "the size of the particles"});
  }
  return close;
}

void addComplaint(std::vector<std::string>& complaints, std::string complaint) {
  if (std::ranges::find(complaints, complaint) == complaints.end()) {
    complaints.push_back(std::move(complaint));
  }
}

std::vector<std::string> complaintsOf(const TrustVerdict& verdict) {
  std::vector<std::string> complaints;
  for (const TrustEffect& effect : verdict.effects) {
    if (isFelt(effect)) {
      addComplaint(complaints, complaintOf(effect.change));
    }
  }
  for (const TooClose& close : tooClose(verdict.room)) {
    if (mayBeFelt(verdict.effects, close.change)) {
      addComplaint(complaints, complaintOf(close.change));
    }
  }
  const auto along_x = std::ranges::find(complaints, complaintOf(TrustChange::kWideX));
  const auto along_y = std::ranges::find(complaints, complaintOf(TrustChange::kWideY));
  if (along_x != complaints.end() && along_y != complaints.end()) {
    *along_x = "the box is too narrow along x and y";
    complaints.erase(along_y);
  }
  if (verdict.strength && !isAsStrongAsAsked(*verdict.strength)) {
    complaints.emplace_back("the soil is not as strong as asked for");
  }
  return complaints;
}

/// Sum of the mean's shifts by box and radius that exceed twice their errors.
double expectedShift(const std::vector<TrustEffect>& effects) {
  double sum = 0;
  for (const TrustEffect& effect : effects) {
    const TrustShift shift = towardsLimit(effect, false);
    if (effect.specimens > 0 && isOfBoxOrRadius(effect.change) && std::abs(shift.value) > 2 * shift.error) {
      sum += shift.value;
    }
  }
  return sum;
}

/// Returns parts that are too close by rules alone: their effect was measured and is small.
std::vector<std::string> closeButNotFelt(const TrustVerdict& verdict) {
  std::vector<std::string> names;
  for (const TooClose& close : tooClose(verdict.room)) {
    const auto effect = std::ranges::find(verdict.effects, close.change, &TrustEffect::change);
    if (!mayBeFelt(verdict.effects, close.change) && effect != verdict.effects.end() && !isFelt(*effect)) {
      names.emplace_back(close.what);
    }
  }
  return names;
}

std::string percent(double fraction) {
  return fmt::format("{:.0f} %", 100 * fraction);
}

/// A bound as one should say it: rounded up to two digits.
std::string boundText(double fraction) {
  return percent(std::ceil(100 * fraction) / 100);
}

std::string sentenceOf(const TrustVerdict& verdict) {
  if (verdict.mean_n < kLeastForce_n) {
    return "No force: the tool does not touch the soil in this movement.";
  }
  std::string sentence =
      verdict.within_mean < 1
          ? fmt::format("Mean force within {}, peak within {}", boundText(verdict.within_mean),
                        boundText(verdict.within_peak))
          : fmt::format("The force cannot be believed: its mean changes by {}", boundText(verdict.within_mean));
  if (std::abs(verdict.expected_mean) > kFelt_mean) {
    sentence += fmt::format("; probably too {} by {}", verdict.expected_mean > 0 ? "low" : "high",
                            percent(std::abs(verdict.expected_mean)));
  }
  if (!verdict.complaints.empty()) {
    sentence += fmt::format("; {}", fmt::join(verdict.complaints, ", "));
  }
  if (!verdict.close.empty()) {
    sentence += fmt::format("; near, but not felt: {}", fmt::join(verdict.close, ", "));
  }
  return sentence + ".";
}

std::string shiftText(const TrustShift& shift) {
  return fmt::format("{:+.1f} ± {:.1f}", 100 * shift.value, 100 * shift.error);
}

Json shiftJson(const TrustShift& shift) {
  return {{"change", shift.value}, {"standard_error", shift.error}};
}

std::string rowTitle(const TrustEffect& effect) {
  return titleOf(effect.change, effect.radius_ratio);
}

}  // namespace

double bound(const TrustVerdict& verdict, std::size_t specimens, bool peak) {
  const double n = static_cast<double>(specimens);
  const double scatter = peak ? verdict.scatter_peak.value : verdict.scatter_mean.value;
  double systematic = 0, random = scatter * scatter * (1 + 1 / n);
  for (const TrustEffect& effect : verdict.effects) {
    if (effect.specimens == 0) {
      continue;
    }
    const TrustShift shift = towardsLimit(effect, peak);
    systematic += std::max(0.0, shift.value * shift.value - shift.error * shift.error);
    random += isOfBoxOrRadius(effect.change) ? shift.error * shift.error : 0;
  }
  const double t = boost::math::quantile(boost::math::students_t(n - 1), 0.95);
  return std::sqrt(systematic) + t * std::sqrt(random);
}

TrustVerdict judgeTrust(const SceneFile& scene, const std::vector<TrustForces>& forces,
                        const std::optional<TrustStrength>& strength) {
  TrustVerdict verdict;
  verdict.strength = strength;
  const TrustForces& usual = forces.at(0);
  std::vector<double> mean_n, peak_n, stress_ratios;
  constexpr double kFar_m = std::numeric_limits<double>::max();
  verdict.reach = {.depth_m = 0, .to_floor_m = kFar_m, .to_wall_x_m = kFar_m, .to_wall_y_m = kFar_m};
  for (const std::optional<TrustForce>& force : usual.specimens) {
    if (!force) {
      continue;
    }
    if (force->stress_ratio) {
      stress_ratios.push_back(*force->stress_ratio);
    }
    mean_n.push_back(force->mean_n);
    peak_n.push_back(force->peak_n);
    TrustReach& reach = verdict.reach;
    reach.depth_m = std::max(reach.depth_m, force->reach.depth_m);
    reach.to_floor_m = std::min(reach.to_floor_m, force->reach.to_floor_m);
    reach.to_wall_x_m = std::min(reach.to_wall_x_m, force->reach.to_wall_x_m);
    reach.to_wall_y_m = std::min(reach.to_wall_y_m, force->reach.to_wall_y_m);
  }
  if (!stress_ratios.empty()) {
    const TrustShift over_one = shiftOf(stress_ratios);
    verdict.stress_ratio = {1 + over_one.value, over_one.error};
  }
  if (mean_n.size() < 2) {
    throw InvalidParameter("specimens", fmt::format("{}", mean_n.size()), "at least 2");
  }
  const Scatter mean = scatterOf(mean_n), peak = scatterOf(peak_n);
  verdict.mean_n = mean.mean;
  verdict.peak_n = peak.mean;
  if (mean.mean >= kLeastForce_n) {
    const double n = static_cast<double>(mean_n.size());
    const auto relative = [n](const Scatter& s) { return TrustShift{s.sd / s.mean, s.sd / s.mean / std::sqrt(2 * n)}; };
    verdict.scatter_mean = relative(mean);
    verdict.scatter_peak = relative(peak);
    for (std::size_t i = 1; i < forces.size(); ++i) {
      verdict.effects.push_back(effectOf(forces[i], usual));
    }
    verdict.room = roomOf(scene, verdict.reach);
    verdict.within_mean = bound(verdict, mean_n.size(), false);
    verdict.within_peak = bound(verdict, mean_n.size(), true);
    verdict.expected_mean = expectedShift(verdict.effects);
    verdict.complaints = complaintsOf(verdict);
    verdict.close = closeButNotFelt(verdict);
  }
  verdict.sentence = sentenceOf(verdict);
  return verdict;
}

std::string trustText(const TrustVerdict& verdict) {
  std::string text = verdict.sentence + "\n";
  if (verdict.mean_n < kLeastForce_n) {
    return text;
  }
  text += fmt::format("\n  mean force {:.3g} N, peak {:.3g} N\n\n  {:<32} {:>16} {:>16}\n", verdict.mean_n,
                      verdict.peak_n, "change of the force in %", "mean", "peak");
  text += fmt::format("  {:<32} {:>17} {:>17}\n", titleOf(TrustChange::kNone),
                      fmt::format("± {:.1f}", 100 * verdict.scatter_mean.value),
                      fmt::format("± {:.1f}", 100 * verdict.scatter_peak.value));
  for (const TrustEffect& effect : verdict.effects) {
    if (effect.specimens > 0) {
      text += fmt::format("  {:<32} {:>17} {:>17}{}\n", rowTitle(effect), shiftText(effect.mean),
                          shiftText(effect.peak), isFelt(effect) ? "  felt" : "");
    } else {
      text += fmt::format("  {:<32} not simulated: {}\n", rowTitle(effect), effect.why_not);
    }
  }
  text += fmt::format(
      "\n  The tool reaches {:.0f} mm deep, {:.0f} mm over the floor.\n"
      "  Room over what soil mechanics asks for: walls {:.1f} (x) and {:.1f} (y), floor {:.1f}, particles {:.1f}.\n",
      1e3 * verdict.reach.depth_m, 1e3 * verdict.reach.to_floor_m, verdict.room.wall_x, verdict.room.wall_y,
      verdict.room.floor, verdict.room.grains);
  if (verdict.stress_ratio) {
    text += fmt::format("  Stress at rest over rho g z: {:.2f} ± {:.2f}; the sides carry what is missing.\n",
                        verdict.stress_ratio->value, verdict.stress_ratio->error);
  }
  if (const auto& strength = verdict.strength) {
    text += fmt::format("  Strength asked for: {:.1f}°, {:.0f} Pa. Sheared: {:.1f} ± {:.1f}°, {:.0f} ± {:.0f} Pa.\n",
                        strength->asked_deg, strength->asked_pa, strength->shown_deg, strength->error_deg,
                        strength->shown_pa, strength->error_pa);
  }
  return text;
}

Json trustJson(const TrustVerdict& verdict) {
  Json json{{"sentence", verdict.sentence},
            {"mean_force_n", verdict.mean_n},
            {"peak_force_n", verdict.peak_n},
            {"mean_within", verdict.within_mean},
            {"peak_within", verdict.within_peak},
            {"mean_expected", verdict.expected_mean},
            {"complaints", verdict.complaints},
            {"near_but_not_felt", verdict.close},
            {"scatter_mean", verdict.scatter_mean.value},
            {"scatter_peak", verdict.scatter_peak.value}};
  Json effects = Json::array();
  for (const TrustEffect& effect : verdict.effects) {
    Json row{{"change", nameOf(effect.change)}, {"title", rowTitle(effect)}, {"specimens", effect.specimens}};
    if (effect.change == TrustChange::kRadius) {
      row["radius_ratio"] = effect.radius_ratio;
    }
    if (effect.specimens > 0) {
      row["mean"] = shiftJson(effect.mean);
      row["peak"] = shiftJson(effect.peak);
      row["felt"] = isFelt(effect);
    } else {
      row["why_not"] = effect.why_not;
    }
    effects.push_back(std::move(row));
  }
  json["effects"] = std::move(effects);
  json["reach_mm"] = {{"depth", 1e3 * verdict.reach.depth_m}, {"to_floor", 1e3 * verdict.reach.to_floor_m}};
  json["room"] = {{"wall_x", verdict.room.wall_x},
                  {"wall_y", verdict.room.wall_y},
                  {"floor", verdict.room.floor},
                  {"particles", verdict.room.grains}};
  if (verdict.stress_ratio) {
    json["stress_over_rho_g_z"] = {{"mean", verdict.stress_ratio->value},
                                   {"standard_error", verdict.stress_ratio->error}};
  }
  if (const auto& strength = verdict.strength) {
    json["strength"] = {{"asked_deg", strength->asked_deg},
                        {"shown_deg", strength->shown_deg},
                        {"standard_error_deg", strength->error_deg},
                        {"asked_pa", strength->asked_pa},
                        {"shown_pa", strength->shown_pa},
                        {"standard_error_pa", strength->error_pa}};
  }
  return json;
}

void drawTrust(const OutputFile& file, const TrustVerdict& verdict, std::string_view title) {
  std::vector<std::vector<double>> mean, peak;
  std::vector<std::string> tics;
  const auto add = [&](const std::string& name, const TrustShift& of_mean, const TrustShift& of_peak) {
    const double y = -static_cast<double>(tics.size());
    tics.push_back(fmt::format("{} {}", gnuplotQuoted(name), y));
    mean.push_back({100 * of_mean.value, y + 0.12, 100 * of_mean.error});
    peak.push_back({100 * of_peak.value, y - 0.12, 100 * of_peak.error});
  };
  add(titleOf(TrustChange::kNone), {0, verdict.scatter_mean.value}, {0, verdict.scatter_peak.value});
  for (const TrustEffect& effect : verdict.effects) {
    if (effect.specimens > 0) {
      add(rowTitle(effect), effect.mean, effect.peak);
    }
  }
  Figure figure(file, 900, 140 + 36 * static_cast<int>(tics.size()));
  figure.data("mean", mean);
  figure.data("peak", peak);
  figure.command(fmt::format("set title {}; set ytics ({}); set yrange [{}:0.6]", gnuplotQuoted(title),
                             fmt::join(tics, ", "), 0.4 - static_cast<double>(tics.size())));
  figure.command(
      "set grid xtics; set xlabel 'change of the force / %, with standard errors'; set key outside top right; "
      "set arrow from 0, graph 0 to 0, graph 1 nohead linecolor rgb '#888888'");
  figure.command(
      "plot $mean using 1:2:3 with xerrorbars pointtype 7 linewidth 2 linecolor rgb '#1f6fb4' title 'mean', "
      "$peak using 1:2:3 with xerrorbars pointtype 5 linewidth 2 linecolor rgb '#d2691e' title 'peak'");
  figure.save();
}

}  // namespace haptolith

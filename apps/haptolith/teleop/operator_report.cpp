#include "teleop/operator_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <limits>

#include "haptolith/core/pluralise.h"

#include "teleop/robot_status.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;
constexpr double kEver = std::numeric_limits<double>::infinity();

Json estimateJson(const SoilEstimate& estimate) {
  return {{"low", estimate.low}, {"middle", estimate.middle}, {"high", estimate.high}};
}

bool hasLearned(const RobotLead& robot) {
  return robot.learning() != nullptr && robot.learning()->updates() > 0;
}

}  // namespace

std::string soilText(const ModelSoil& soil) {
  const SoilEstimate& angle = soil.friction_angle_deg;
  const SoilEstimate& cohesion = soil.cohesion_pa;
  const SoilEstimate& tool = soil.tool_friction_angle_deg;
  return fmt::format(
      "{:.1f} ({:.0f} to {:.0f}) deg, {:.0f} ({:.0f} to {:.0f}) Pa, soil-tool {:.1f} ({:.0f} to {:.0f}) deg",
      angle.middle, angle.low, angle.high, cohesion.middle, cohesion.low, cohesion.high, tool.middle, tool.low,
      tool.high);
}

std::string robotText(const RobotLead& robot) {
  const RobotNews& news = robot.end().news();
  if (!news.ever) {
    return "no reports from the robot yet";
  }
  if (!news.heard) {
    return "the robot stopped responding";
  }
  const std::string why = news.state.reason == StopReason::kNone ? "" : fmt::format(" ({})", text(news.state.reason));
  const char* cap = news.state.at_force_cap   ? ", at its force limit"
                    : news.state.at_speed_cap ? ", at its speed limit"
                    : news.state.at_edge      ? ", at the edge of its workspace"
                                              : "";
  const std::string soil = hasLearned(robot) ? fmt::format("; soil {:.1f} deg, {:.0f} Pa",
                                                           robot.learning()->learned().state.friction_angle_deg,
                                                           robot.learning()->learned().state.cohesion_pa)
                                             : "";
  // Lag above that of the link: it was disconnected and catches up, or its machine is too slow.
  constexpr double kCommand_s = 1e-3, kMore_s = 1;
  const bool lags = static_cast<double>(news.behind) * kCommand_s > news.round_trip_s + kMore_s;
  return fmt::format(
      "robot {}{}{}, {} commands behind{}, round trip {:.2f} s; remote force {:.2f} N, this soil {:.2f} N{}",
      text(news.state.state), why, cap, news.behind,
      lags ? " (more than the link delay: it catches up, or its machine is too slow)" : "", news.round_trip_s,
      news.met_n.norm(), news.displayed_n.norm(), soil);
}

RobotShown robotShown(const RobotLead& robot) {
  const RobotNews& news = robot.end().news();
  RobotShown shown;
  shown.state = news.ever ? text(news.state.state) : "no reports yet";
  shown.reason = news.state.reason == StopReason::kNone ? "" : text(news.state.reason);
  shown.heard = news.heard;
  shown.behind = news.behind;
  shown.round_trip_s = news.round_trip_s;
  if (!news.state.reports.empty()) {
    shown.scene_T_tool = news.state.reports.back().pose;
  }
  shown.scene_T_tool.position_m.z() += robot.end().surface();
  shown.displayed_n = news.displayed_n;
  shown.met_n = news.met_n;
  if (hasLearned(robot)) {
    const ModelSoil& soil = robot.learning()->learned();
    const auto interval = [](const SoilEstimate& of) { return std::array{of.low, of.middle, of.high}; };
    shown.learned = {interval(soil.friction_angle_deg), interval(soil.cohesion_pa),
                     interval(soil.tool_friction_angle_deg)};
  }
  if (const SiteMap& site = robot.end().site(); !site.empty()) {
    const HeightGrid& grid = site.grid();
    shown.site = {grid.x_m, grid.y_m, grid.cell_m, grid.columns, grid.rows, site.heights()};
  }
  return shown;
}

std::string robotSummary(const RobotLead& robot) {
  const OperatorEnd& end = robot.end();
  const ForceAgreement& agreement = end.agreement();
  std::string text = fmt::format("  robot      {}\n", robotText(robot));
  if (agreement.rmsMet(0, kEver) > 0) {
    text += fmt::format(
        "  remote     {:.2f} N RMS; the force of this soil before the device's limits differs by {:.2f} N RMS, {:.0f} "
        "%\n",
        agreement.rmsMet(0, kEver), agreement.rmsDifference(0, kEver), 100 * agreement.share(0, kEver));
  }
  if (hasLearned(robot)) {
    text += fmt::format("  learned    {}; {} updates\n", soilText(robot.learning()->learned()),
                        robot.learning()->updates());
  }
  if (robot.mended() > 0) {
    text += fmt::format("  corrected  the surface: {} moved\n", pluralise(robot.mended(), "grain"));
  }
  const PacketCounts& counts = end.counts();
  text += fmt::format("  packets    {} sent, {} accepted; {}, {} forged, {} replayed\n", end.sent(), counts.taken,
                      malformedCountText(counts), counts.forged, counts.replayed);
  return text;
}

Json countsJson(const PacketCounts& counts) {
  return {{"taken", counts.taken},         {"malformed", counts.malformed}, {"forged", counts.forged},
          {"greetings", counts.greetings}, {"replayed", counts.replayed},   {"strangers", counts.strangers}};
}

Json learnedJson(const RobotLead& robot) {
  if (!hasLearned(robot)) {
    return nullptr;
  }
  const ModelSoil& soil = robot.learning()->learned();
  return {{"friction_angle_deg", estimateJson(soil.friction_angle_deg)},
          {"cohesion_pa", estimateJson(soil.cohesion_pa)},
          {"tool_friction_angle_deg", estimateJson(soil.tool_friction_angle_deg)},
          {"stretches", soil.stretches},
          {"updates", robot.learning()->updates()}};
}

Json robotJson(const RobotLead& robot) {
  const OperatorEnd& end = robot.end();
  const RobotNews& news = end.news();
  const ForceAgreement& agreement = end.agreement();
  return {{"heard", news.heard},
          {"state", news.ever ? Json(text(news.state.state)) : Json(nullptr)},
          {"reason", text(news.state.reason)},
          {"round_trip_s", news.round_trip_s},
          {"behind", news.behind},
          {"met_rms_n", agreement.rmsMet(0, kEver)},
          {"force_error_share", agreement.share(0, kEver)},
          {"learned", learnedJson(robot)},
          {"mended_grains", robot.mended()},
          {"sent", end.sent()},
          {"packets", countsJson(end.counts())}};
}

}  // namespace haptolith

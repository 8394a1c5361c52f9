#include "teleop/operator_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;
constexpr double kEver = std::numeric_limits<double>::infinity();

}  // namespace

std::string robotText(const RobotNews& news) {
  if (!news.ever) {
    return "no word of the robot yet";
  }
  if (!news.heard) {
    return "the robot has fallen silent";
  }
  const std::string why = news.state.reason == StopReason::kNone ? "" : fmt::format(" ({})", text(news.state.reason));
  const char* cap = news.state.at_force_cap   ? ", at its largest force"
                    : news.state.at_speed_cap ? ", at its largest speed"
                    : news.state.at_edge      ? ", at the edge of its workspace"
                                              : "";
  return fmt::format("robot {}{}{}, {} commands behind, round trip {:.2f} s; force felt {:.2f} N, met {:.2f} N",
                     text(news.state.state), why, cap, news.behind, news.round_trip_s, news.felt_n.norm(),
                     news.met_n.norm());
}

RobotShown robotShown(const RobotNews& news, double surface_m) {
  RobotShown shown;
  shown.state = news.ever ? text(news.state.state) : "not heard yet";
  shown.reason = news.state.reason == StopReason::kNone ? "" : text(news.state.reason);
  shown.heard = news.heard;
  shown.behind = news.behind;
  shown.round_trip_s = news.round_trip_s;
  if (!news.state.reports.empty()) {
    shown.scene_T_tool = news.state.reports.back().pose;
  }
  shown.scene_T_tool.position_m.z() += surface_m;
  shown.felt_n = news.felt_n;
  shown.met_n = news.met_n;
  return shown;
}

std::string robotSummary(const OperatorEnd& end) {
  const RobotNews& news = end.news();
  const ForceAgreement& agreement = end.agreement();
  std::string text = fmt::format("  robot      {}\n", robotText(news));
  if (agreement.rmsMet(0, kEver) > 0) {
    text += fmt::format("  met        {:.2f} N RMS; felt differs from it by {:.2f} N RMS, {:.0f} %\n",
                        agreement.rmsMet(0, kEver), agreement.rmsDifference(0, kEver), 100 * agreement.share(0, kEver));
  }
  const PacketCounts& counts = end.counts();
  text += fmt::format("  packets    {} sent, {} taken; {} malformed, {} forged, {} replayed\n", end.sent(),
                      counts.taken, counts.malformed, counts.forged, counts.replayed);
  return text;
}

Json countsJson(const PacketCounts& counts) {
  return {{"taken", counts.taken},         {"malformed", counts.malformed}, {"forged", counts.forged},
          {"greetings", counts.greetings}, {"replayed", counts.replayed},   {"strangers", counts.strangers}};
}

Json robotJson(const OperatorEnd& end) {
  const RobotNews& news = end.news();
  const ForceAgreement& agreement = end.agreement();
  return {{"heard", news.heard},
          {"state", news.ever ? Json(text(news.state.state)) : Json(nullptr)},
          {"reason", text(news.state.reason)},
          {"round_trip_s", news.round_trip_s},
          {"behind", news.behind},
          {"met_rms_n", agreement.rmsMet(0, kEver)},
          {"force_error_share", agreement.share(0, kEver)},
          {"sent", end.sent()},
          {"packets", countsJson(end.counts())}};
}

}  // namespace haptolith

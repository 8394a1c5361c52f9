#include "haptolith/core/former_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace haptolith {

namespace {

struct FormerName {
  NameKind kind;
  std::string_view former, current;
};

// Names of version 0.2 and earlier, except "pairwise" (0.1). Version 0.4 no longer needs them.
constexpr std::array kFormerNames{
    FormerName{NameKind::kWord, "pairwise", "contact"},
    FormerName{NameKind::kWord, "paper", "icra2021"},
    FormerName{NameKind::kKey, "soil.friction", "soil.friction_model"},
    FormerName{NameKind::kKey, "scene.friction", "scene.friction_model"},  // [block.scene] of a protocol
    FormerName{NameKind::kKey, "lab.friction", "lab.friction_model"},      // options of hapto_lab_test()
    FormerName{NameKind::kKey, "hand.manoeuvre", "hand.motion"},
    FormerName{NameKind::kKey, "tool.name", "tool.model"},
    FormerName{NameKind::kKey, "loop.paced", "loop.real_time"},
    FormerName{NameKind::kKey, "safety.calm_s", "safety.recovery_s"},
    FormerName{NameKind::kKey, "safety.most_misses", "safety.max_missed_deadlines"},
    FormerName{NameKind::kKey, "safety.heartbeat_ms", "safety.watchdog_timeout_ms"},
    FormerName{NameKind::kScene, "paper", "icra2021"},
    FormerName{NameKind::kScene, "plate-in-sand", "plate-recorded"},
    FormerName{NameKind::kScene, "dig", "teleop-model"},
    FormerName{NameKind::kScene, "dig-site", "teleop-site"},
    FormerName{NameKind::kScene, "field", "probe-field"},
    FormerName{NameKind::kProtocol, "paper", "icra2021"},
    FormerName{NameKind::kProtocol, "paper-friction", "icra2021-friction"},
    FormerName{NameKind::kProtocol, "paper-gravity", "icra2021-gravity"},
    FormerName{NameKind::kLabTest, "funnel", "hopper"},
    FormerName{NameKind::kLabTest, "fall", "free-fall"},
    FormerName{NameKind::kLabTest, "carry", "payload"},
    FormerName{NameKind::kLabTest, "cut", "vertical-cut"},
    FormerName{NameKind::kLabTest, "grain", "grain-size"},
    FormerName{NameKind::kTeleopCase, "model", "static"},
    FormerName{NameKind::kTeleopCase, "probed", "calibrated"},
    FormerName{NameKind::kTeleopCase, "learning", "adaptive"},
    FormerName{NameKind::kTeleopCase, "both", "calibrated+adaptive"},
    FormerName{NameKind::kTeleopCase, "twin", "oracle"},
};

bool sameWord(std::string_view one, std::string_view other) {
  const auto lower = [](unsigned char letter) { return std::tolower(letter); };
  return std::ranges::equal(one, other, {}, lower, lower);
}

struct Reports {
  std::mutex mutex;
  std::function<void(std::string_view)> report;
  std::set<std::string, std::less<>> reported;
};

Reports& reports() {
  static Reports all;
  return all;
}

}  // namespace

std::string_view currentName(NameKind kind, std::string_view name) noexcept {
  const auto* entry = std::ranges::find_if(
      kFormerNames, [&](const FormerName& former) { return former.kind == kind && sameWord(former.former, name); });
  return entry == kFormerNames.end() ? name : entry->current;
}

std::string_view currentNameReported(NameKind kind, std::string_view name) {
  const std::string_view current = currentName(kind, name);
  if (current != name) {
    reportFormerName(fmt::format("{} is now {}; the old name works until version 0.4", name, current));
  }
  return current;
}

void reportFormerName(std::string_view line) {
  const std::lock_guard lock(reports().mutex);
  if (reports().report && reports().reported.emplace(line).second) {
    reports().report(line);
  }
}

void onFormerName(std::function<void(std::string_view)> report) {
  const std::lock_guard lock(reports().mutex);
  reports().report = std::move(report);
}

}  // namespace haptolith

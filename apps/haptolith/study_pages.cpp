#include "study_pages.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <variant>

#include "haptolith/core/error.h"

namespace haptolith {

using namespace std::chrono_literals;

namespace {

constexpr auto kBetweenMessages = 100ms;

}  // namespace

LiveView::Guest StudyPages::guest() {
  return {.obey = [this](std::uint32_t client, std::string_view message) { return obey(client, message); },
          .left = [this](std::uint32_t client) { roles_.erase(client); },
          .refuse = [this](std::uint32_t client, const Command& asked) { return refuse(client, asked); }};
}

std::string StudyPages::obey(std::uint32_t client, std::string_view message) {
  const auto known = roles_.find(client);
  const bool joined = known != roles_.end();
  roles_[client] =
      obeyStudyMessage(conductor_, message, joined ? known->second : StudyRole::kParticipant, joined);  // throws
  somebody_new_ = somebody_new_ || !joined;
  return "";
}

/// The soil belongs to the study, and the tool to whoever takes part, while there is something to be felt.
std::string StudyPages::refuse(std::uint32_t client, const Command& asked) const {
  if (std::holds_alternative<command::Colour>(asked) || std::holds_alternative<command::Release>(asked)) {
    return "";
  }
  const auto role = roles_.find(client);
  const bool takes_part = role != roles_.end() && role->second == StudyRole::kParticipant;
  if (!takes_part || !std::holds_alternative<command::Hold>(asked)) {
    return "a study is running: nobody changes the scene";
  }
  const StudyMoment now = conductor_.moment();
  return now.phase == StudyPhase::kInterval && !now.paused ? "" : "there is nothing to feel now";
}

void StudyPages::show(LiveView& view, double force_n) {
  const StudyMoment moment = conductor_.moment();
  const bool feels = moment.phase == StudyPhase::kInterval && !moment.paused;
  if (feels && !feels_) {
    peak_force_n_ = 0;
  } else if (feels_ && !feels) {
    view.letGo();
  }
  feels_ = feels;
  peak_force_n_ = std::max(peak_force_n_, force_n);
  const bool news = conductor_.changes() != told_changes_ || somebody_new_;
  if (roles_.empty() || (!news && Clock::now() < next_)) {
    return;
  }
  if (news || history_.empty()) {
    try {
      history_ = historyJson(conductor_);
    } catch (const Failure& failure) {  // pages may wait; the study goes on
      spdlog::warn("the experimenter's page shows no news: {}", failure.what());
      history_ = history_.empty() ? R"({"answers": [], "blocks": [], "notes": []})" : history_;
    }
  }
  next_ = Clock::now() + kBetweenMessages;
  told_changes_ = conductor_.changes();
  somebody_new_ = false;
  const std::string for_participant = participantMessage(conductor_);
  const std::string for_experimenter = experimenterMessage(conductor_, history_, force_n, peak_force_n_);
  for (const auto& [client, role] : roles_) {
    view.send(client, role == StudyRole::kParticipant ? for_participant : for_experimenter);
  }
}

}  // namespace haptolith

#include "study/study_pages.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "haptolith/core/error.h"

namespace haptolith {

using namespace std::chrono_literals;

namespace {

constexpr auto kBetweenMessages = 100ms;

}  // namespace

std::vector<Entrance> StudyPages::entrances(std::string participant, std::string experimenter) {
  std::vector<Entrance> both(2);
  both[kParticipants] = {.token = std::move(participant), .nameless = true};
  both[kExperimenters] = {.token = std::move(experimenter)};
  return both;
}

LiveView::Guest StudyPages::guest() {
  return {.obey = [this](std::uint32_t client, std::string_view message) { return obey(client, message); },
          .joined =
              [this](std::uint32_t client, std::size_t entrance) {
                pages_[client].role = entrance == kExperimenters ? StudyRole::kExperimenter : StudyRole::kParticipant;
              },
          .left = [this](std::uint32_t client) { pages_.erase(client); },
          .refuse = [this](std::uint32_t client, const Command& asked) { return refuse(client, asked); }};
}

std::string StudyPages::obey(std::uint32_t client, std::string_view message) {
  Page& page = pages_.at(client);
  const bool joined = obeyStudyMessage(conductor_, message, page.role, page.joined);  // throws
  somebody_new_ = somebody_new_ || !page.joined;
  page.joined = joined;
  return "";
}

/// The soil belongs to the study, and the tool to whoever takes part, while there is something to be felt.
std::string StudyPages::refuse(std::uint32_t client, const Command& asked) const {
  if (std::holds_alternative<command::Colour>(asked) || std::holds_alternative<command::Release>(asked)) {
    return "";
  }
  const Page& page = pages_.at(client);
  const bool takes_part = page.joined && page.role == StudyRole::kParticipant;
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
  if (std::ranges::none_of(pages_, [](const auto& page) { return page.second.joined; }) ||
      (!news && Clock::now() < next_)) {
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
  for (const auto& [client, page] : pages_) {
    if (page.joined) {
      view.send(client, page.role == StudyRole::kParticipant ? for_participant : for_experimenter);
    }
  }
}

}  // namespace haptolith

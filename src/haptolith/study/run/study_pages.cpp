#include "haptolith/study/run/study_pages.h"

#include <algorithm>

#include "haptolith/core/error.h"

namespace haptolith {

using namespace std::chrono_literals;

namespace {

constexpr auto kBetweenMessages = 100ms;

bool isPresented(const StudyState& moment) {
  return moment.phase == StudyPhase::kInterval && !moment.paused;
}

}  // namespace

void StudyPages::handleMessages(std::uint32_t client, std::string_view message) {
  Page& page = pages_.at(client);
  const bool joined = handleStudyMessage(conductor_, message, page.role, page.joined);  // throws
  somebody_new_ = somebody_new_ || !page.joined;
  page.joined = joined;
}

std::string StudyPages::refusal(std::uint32_t client, Wish wish) const {
  if (wish == Wish::kLook) {
    return "";
  }
  const Page& page = pages_.at(client);
  const bool takes_part = page.joined && page.role == StudyRole::kParticipant;
  if (!takes_part || wish != Wish::kHoldTool) {
    return "a study is running: the scene cannot be changed";
  }
  return isPresented(conductor_.state()) ? "" : "no stimulus is presented now";
}

StudyPages::News StudyPages::news(double force_n) {
  News news;
  const bool feels = isPresented(conductor_.state());
  if (feels && !feels_) {
    peak_force_n_ = 0;
  }
  news.lets_go = feels_ && !feels;
  feels_ = feels;
  peak_force_n_ = std::max(peak_force_n_, force_n);
  const bool changed = conductor_.changes() != told_changes_ || somebody_new_;
  if (std::ranges::none_of(pages_, [](const auto& page) { return page.second.joined; }) ||
      (!changed && Clock::now() < next_)) {
    return news;
  }
  if (changed || history_.empty()) {
    try {
      history_ = historyJson(conductor_);
    } catch (const Failure& failure) {  // pages may wait; the study continues
      news.problem = failure.what();
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
      news.messages.emplace_back(client, page.role == StudyRole::kParticipant ? for_participant : for_experimenter);
    }
  }
  return news;
}

}  // namespace haptolith

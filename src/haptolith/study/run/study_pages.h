#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "haptolith/study/run/conductor.h"
#include "haptolith/study/run/study_messages.h"

namespace haptolith {

/// The participant's and the experimenter's pages: what each is told and may do. Knows clients by their numbers, and
/// nothing of how messages travel.
class StudyPages {
 public:
  /// What a client asks of the scene rather than of the study.
  enum class Wish { kLook, kHoldTool, kChangeScene };

  /// What there is to send.
  struct News {
    std::vector<std::pair<std::uint32_t, std::string>> messages;  ///< client, JSON
    bool lets_go = false;                                         ///< nobody may hold the tool any more
    std::string problem;                                          ///< why a page is told old news; empty: it is not
  };

  explicit StudyPages(Conductor& conductor) : conductor_(conductor) {}

  /// A client has come, in a role that it can never leave.
  void join(std::uint32_t client, StudyRole role) { pages_[client].role = role; }
  void leave(std::uint32_t client) { pages_.erase(client); }

  /// @throws InvalidParameter, Failure as handleStudyMessage().
  void handleMessages(std::uint32_t client, std::string_view message);

  /// Why a client may not have its wish; empty when it may. The soil belongs to the study, and the tool to the
  /// participant while there is something to be felt.
  [[nodiscard]] std::string refusal(std::uint32_t client, Wish wish) const;

  /// What is new for each page; to be called often. @param force_n  that the hand feels now.
  [[nodiscard]] News news(double force_n);

 private:
  using Clock = std::chrono::steady_clock;

  struct Page {
    StudyRole role = StudyRole::kParticipant;
    bool joined = false;
  };

  Conductor& conductor_;
  std::map<std::uint32_t, Page> pages_;
  bool somebody_new_ = false;
  std::uint64_t told_changes_ = ~std::uint64_t{0};
  std::string history_;
  bool feels_ = false;
  double peak_force_n_ = 0;
  Clock::time_point next_;
};

}  // namespace haptolith

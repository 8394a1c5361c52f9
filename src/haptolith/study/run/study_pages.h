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

/// Pages of the participant and the experimenter: their messages and permissions. Clients are identified by numbers;
/// the transport of messages is elsewhere.
class StudyPages {
 public:
  /// Request of a client to the scene (not to the study).
  enum class Wish { kLook, kHoldTool, kChangeScene };

  /// Messages to send.
  struct News {
    std::vector<std::pair<std::uint32_t, std::string>> messages;  ///< client, JSON
    bool lets_go = false;                                         ///< whether the tool must be released by its client
    std::string problem;  ///< reason for an outdated history; empty: it is current
  };

  explicit StudyPages(Conductor& conductor) : conductor_(conductor) {}

  /// Adds a client, with a role that is never changed.
  void join(std::uint32_t client, StudyRole role) { pages_[client].role = role; }
  void leave(std::uint32_t client) { pages_.erase(client); }

  /// @throws InvalidParameter, Failure as handleStudyMessage().
  void handleMessages(std::uint32_t client, std::string_view message);

  /// Returns the reason to refuse a client's request; empty if it is allowed. Only the study changes the soil, and only
  /// the participant may hold the tool, while a stimulus is presented.
  [[nodiscard]] std::string refusal(std::uint32_t client, Wish wish) const;

  /// Returns new messages for the pages; to be called often. @param force_n  current force on the hand.
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

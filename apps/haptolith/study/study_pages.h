#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/conductor.h"
#include "haptolith/study/study_messages.h"
#include "haptolith/viewer/live_view.h"

namespace haptolith {

/// The participant's and the experimenter's page: tells them what is the case, and does what they ask for.
class StudyPages {
 public:
  explicit StudyPages(Conductor& conductor) : conductor_(conductor) {}

  /// The two ways in, with these tokens. Who has the participant's is not told what is shown, and can never act as the
  /// experimenter.
  [[nodiscard]] static std::vector<Entrance> entrances(std::string participant, std::string experimenter);
  static constexpr std::size_t kParticipants = 0, kExperimenters = 1;

  /// What stands between the view and the study; for as long as this object lives.
  [[nodiscard]] LiveView::Guest guest();

  /// Sends each page what is new; as often as LiveView::show().
  void show(LiveView& view, double force_n);

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::string obey(std::uint32_t client, std::string_view message);
  [[nodiscard]] std::string refuse(std::uint32_t client, const Command& asked) const;

  Conductor& conductor_;
  struct Page {
    StudyRole role = StudyRole::kParticipant;  ///< from the address that it came by: see entrances()
    bool joined = false;
  };

  std::map<std::uint32_t, Page> pages_;
  bool somebody_new_ = false;
  std::uint64_t told_changes_ = ~std::uint64_t{0};
  std::string history_;
  bool feels_ = false;
  double peak_force_n_ = 0;
  Clock::time_point next_;
};

}  // namespace haptolith

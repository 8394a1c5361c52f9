#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/store/store.h"

namespace haptolith {

/// What has become of everybody who began: each of the first five is counted once.
struct ParticipantFlow {
  std::size_t removed = 0;  ///< on request; nothing is known of them
  std::size_t withdrew = 0, excluded = 0;
  std::size_t unfinished = 0, finished = 0;         ///< of those who are analysed
  std::map<std::string, std::size_t> reasons = {};  ///< of exclusions, and for how many each

  [[nodiscard]] std::size_t analysed() const noexcept { return unfinished + finished; }
  [[nodiscard]] std::size_t began() const noexcept { return removed + withdrew + excluded + analysed(); }
};

[[nodiscard]] ParticipantFlow flowOf(const StudyStore& study);

/// "12 began, 1 withdrew, 1 excluded (catch trials), 10 analysed". @param came  what is said of all, in place of
/// "began".
[[nodiscard]] std::string flowText(const ParticipantFlow& flow, std::string_view came = "began");

/// What has become of everybody who was assigned to a group.
struct GroupFlow {
  std::string group = {};
  ParticipantFlow people = {};
  /// How many were assigned out of each stratum, in the protocol's order; also those who were removed.
  std::vector<std::size_t> strata = {};
};

/// In the protocol's order; none where it has no groups.
[[nodiscard]] std::vector<GroupFlow> groupFlowsOf(const StudyStore& study);

/// flowText() of the study, and a line for each group.
[[nodiscard]] std::string flowsText(const StudyStore& study);

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/store/store.h"

namespace haptolith {

/// Flow of all participants who began. Each participant is counted once in the first five numbers.
struct ParticipantFlow {
  std::size_t removed = 0;  ///< removed on request, without any remaining data
  std::size_t withdrew = 0, excluded = 0;
  std::size_t unfinished = 0, finished = 0;         ///< participants who are analysed
  std::map<std::string, std::size_t> reasons = {};  ///< number of exclusions for each reason

  [[nodiscard]] std::size_t analysed() const noexcept { return unfinished + finished; }
  [[nodiscard]] std::size_t began() const noexcept { return removed + withdrew + excluded + analysed(); }
};

[[nodiscard]] ParticipantFlow flowOf(const StudyStore& study);

/// Describes a flow: "12 began, 1 withdrew, 1 excluded (catch trials), 10 analysed". @param came  verb instead of
/// "began".
[[nodiscard]] std::string flowText(const ParticipantFlow& flow, std::string_view came = "began");

/// Flow of the participants of one group.
struct GroupFlow {
  std::string group = {};
  ParticipantFlow people = {};
  /// Number of assigned participants per stratum, in the protocol's order, including removed ones.
  std::vector<std::size_t> strata = {};
};

/// Returns the flows in the protocol's order of groups; empty without groups.
[[nodiscard]] std::vector<GroupFlow> groupFlowsOf(const StudyStore& study);

/// Returns flowText() of the study, and a line for each group.
[[nodiscard]] std::string flowsText(const StudyStore& study);

}  // namespace haptolith

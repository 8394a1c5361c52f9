#pragma once

#include <cstddef>
#include <map>
#include <string>

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

/// "12 began, 1 withdrew, 1 excluded (catch trials), 10 analysed"
[[nodiscard]] std::string flowText(const ParticipantFlow& flow);

}  // namespace haptolith

#pragma once

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/psychometrics/group/group.h"
#include "haptolith/psychometrics/group/group_difference.h"
#include "haptolith/study/results/answers.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Curves fitted to the answers in one block of a study.
struct BlockResult {
  const StudyBlock* block = nullptr;
  std::size_t index = 0;                     ///< of the block in the protocol
  const ParticipantGroup* people = nullptr;  ///< whose answers these are; none: everybody's
  std::vector<std::string> codes;
  std::vector<std::vector<Level>> levels;
  std::optional<GroupFit> group;  ///< of several participants
  std::optional<Fit> pooled;      ///< all answers as of one person: of a single participant, or when it is asked for
  std::optional<double> caught;

  /// "friction", or "friction of group seen".
  [[nodiscard]] std::string name() const {
    return people == nullptr ? block->name : fmt::format("{} of group {}", block->name, people->name);
  }
  [[nodiscard]] const Fit& headline() const { return group ? group->median_person : *pooled; }
};

/// What changes from one block to another within people, or from one group of people to another.
struct Difference {
  const BlockResult* first = nullptr;
  const BlockResult* second = nullptr;
  std::optional<std::size_t> in_both = {};  ///< people; none: between groups
  Change scale = {};
  std::optional<Change> threshold = {};  ///< of thresholds as shares of their references
};

/// Compares within people the first block with each other one, and each group with each that follows it.
[[nodiscard]] std::vector<Difference> differencesOf(const std::vector<BlockResult>& results,
                                                    const StudyProtocol& protocol, double confidence);

/// As text for a terminal.
[[nodiscard]] std::string text(const BlockResult& result);
[[nodiscard]] std::string text(const Difference& difference, double confidence);

/// As objects of `--json`.
[[nodiscard]] nlohmann::ordered_json jsonOf(const BlockResult& result);
[[nodiscard]] nlohmann::ordered_json jsonOf(const Difference& difference);

}  // namespace haptolith

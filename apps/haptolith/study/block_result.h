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

/// Curves fitted to the responses in one block of a study.
struct BlockResult {
  const StudyBlock* block = nullptr;
  std::size_t index = 0;                     ///< index of the block in the protocol
  const ParticipantGroup* people = nullptr;  ///< group of the responses; null: all participants
  std::vector<std::string> codes;
  std::vector<std::vector<Level>> levels;
  std::optional<GroupFit> group;  ///< fit to several participants
  std::optional<Fit> pooled;      ///< fit to pooled responses: for a single participant, or on request
  std::optional<double> caught;

  /// Returns "friction", or "friction of group seen".
  [[nodiscard]] std::string name() const {
    return people == nullptr ? block->name : fmt::format("{} of group {}", block->name, people->name);
  }
  [[nodiscard]] const Fit& headline() const { return group ? group->median_person : *pooled; }
};

/// Change from one block to another within participants, or from one group of participants to another.
struct Difference {
  const BlockResult* first = nullptr;
  const BlockResult* second = nullptr;
  std::optional<std::size_t> in_both = {};  ///< number of participants; empty: between groups
  Change scale = {};
  std::optional<Change> threshold = {};  ///< change of thresholds over their references
};

/// Compares the first block with each other one within participants, and each group with each later one.
[[nodiscard]] std::vector<Difference> differencesOf(const std::vector<BlockResult>& results,
                                                    const StudyProtocol& protocol, double confidence);

/// Returns text for a terminal.
[[nodiscard]] std::string text(const BlockResult& result);
[[nodiscard]] std::string text(const Difference& difference, double confidence);

/// Returns an object for `--json`.
[[nodiscard]] nlohmann::ordered_json jsonOf(const BlockResult& result);
[[nodiscard]] nlohmann::ordered_json jsonOf(const Difference& difference);

}  // namespace haptolith

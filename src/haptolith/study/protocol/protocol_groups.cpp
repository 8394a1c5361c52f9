#include "haptolith/study/protocol/protocol_groups.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/study/protocol/groups.h"
#include "haptolith/study/protocol/protocol_keys.h"

namespace haptolith {

namespace {

constexpr std::size_t kMostStrata = 1000;  // each stratum needs participants

std::vector<std::size_t> blocksNamed(const GroupDraft& draft, const StudyProtocol& protocol) {
  std::vector<std::size_t> blocks;
  if (!draft.blocks) {
    blocks.resize(protocol.blocks.size());
    std::iota(blocks.begin(), blocks.end(), std::size_t{0});
    return blocks;
  }
  std::vector<std::string> names;
  std::ranges::transform(protocol.blocks, std::back_inserter(names), &StudyBlock::name);
  const auto valid = [&](std::string_view what) {
    return InvalidParameter("blocks", "", fmt::format("one or more of {}, each once{}", fmt::join(names, ", "), what));
  };
  for (const std::string& name : *draft.blocks) {
    const auto found = std::ranges::find(names, name);
    const auto number = static_cast<std::size_t>(found - names.begin());
    if (found == names.end()) {
      throw valid(fmt::format("; there is no block '{}'", name));
    }
    if (std::ranges::find(blocks, number) != blocks.end()) {
      throw valid(fmt::format("; '{}' occurs twice", name));
    }
    blocks.push_back(number);
  }
  if (blocks.empty()) {
    throw valid("");
  }
  return blocks;
}

ParticipantGroup readGroup(const TomlReader& reader, const StudyProtocol& protocol) {
  reader.refuseUnknownKeys(keyNames(groupKeys()));
  reader.require("", "name");
  GroupDraft draft;
  for (const GroupKey& key : groupKeys()) {
    reader.apply(key, draft);
  }
  reader.check(groupKeys(), "", [&] { draft.group.blocks = blocksNamed(draft, protocol); });
  if (std::ranges::find(protocol.groups, draft.group.name, &ParticipantGroup::name) != protocol.groups.end()) {
    reader.refuseKey({"", "name"}, "another one: a group above has it");
  }
  return draft.group;
}

/// Rejects blocks that are in no group; otherwise the mistake would stay unnoticed.
void requireEveryBlock(const TomlReader& reader, const StudyProtocol& protocol) {
  for (std::size_t block = 0; block < protocol.blocks.size(); ++block) {
    const auto goes_through = [block](const ParticipantGroup& group) {
      return std::ranges::find(group.blocks, block) != group.blocks.end();
    };
    if (std::ranges::none_of(protocol.groups, goes_through)) {
      reader.refuse(reader.lineOf("", "groups"), fmt::format("[[groups]] leave out the block '{}': must have each "
                                                             "block in one of them, or more",
                                                             protocol.blocks[block].name));
    }
  }
}

/// Returns the number of parts into which a demographics item divides participants.
/// @throws InvalidParameter for an item that makes no strata.
std::size_t partsOfStratum(const StudyProtocol& protocol, const std::string& key) {
  const auto item = std::ranges::find(protocol.demographics, key, &FormItem::key);
  const auto refuse = [&key](std::string_view what) {
    throw InvalidParameter("strata", "", fmt::format("keys of [[demographics]] items; '{}' {}", key, what));
  };
  if (item == protocol.demographics.end()) {
    refuse("does not exist");
  }
  const std::vector<std::string> parts = stratumParts(*item);
  if (item->kind == FormItem::Kind::kText) {
    refuse("is free text: a choice, yes-no, or a number or scale with `cut_points` makes strata");
  }
  if (parts.size() < 2) {
    refuse("has no `cut_points`");
  }
  if (!item->required) {
    refuse("must be `required`: without an answer there is no stratum");
  }
  if (item->personal) {
    refuse("is `personal`: the stratum would disclose it");
  }
  return parts.size();
}

void requireStrata(const StudyProtocol& protocol) {
  const GroupAssignment& assignment = protocol.assignment;
  if ((assignment.method == AssignmentMethod::kStratified) != !assignment.strata.empty()) {
    throw assignment.strata.empty() ? InvalidParameter("strata", "nothing", "given for method = \"stratified\"")
                                    : InvalidParameter("strata", "", "left out: only method = \"stratified\" has them");
  }
  std::size_t strata = 1;
  for (auto key = assignment.strata.begin(); key != assignment.strata.end(); ++key) {
    if (std::find(assignment.strata.begin(), key, *key) != key) {
      throw InvalidParameter("strata", "", fmt::format("each once; '{}' occurs twice", *key));
    }
    strata *= partsOfStratum(protocol, *key);
    if (strata > kMostStrata) {
      throw InvalidParameter("strata", "", fmt::format("at most {} strata; these make {}", kMostStrata, strata));
    }
  }
  for (const FormItem& item : protocol.demographics) {
    const bool makes_strata = std::ranges::find(assignment.strata, item.key) != assignment.strata.end();
    if (!item.cut_points.empty() && !makes_strata) {
      throw InvalidParameter("strata", "nothing", fmt::format("with '{}', which has `cut_points`", item.key));
    }
  }
}

void setBlockSize(const TomlReader& reader, StudyProtocol& protocol) {
  GroupAssignment& assignment = protocol.assignment;
  int shares = 0;
  for (const ParticipantGroup& group : protocol.groups) {
    shares += group.share;
  }
  const bool is_given = assignment.block_size != 0;
  if (is_given && assignment.method == AssignmentMethod::kAlternate) {
    reader.refuseKey({"assignment", "block_size"}, "left out: alternating groups have no permuted blocks");
  }
  if (is_given && assignment.block_size % shares != 0) {
    reader.refuseKey({"assignment", "block_size"}, fmt::format("a multiple of the sum of all shares, {}", shares));
  }
  assignment.block_size = is_given ? assignment.block_size : 2 * shares;
}

}  // namespace

void readGroups(const TomlReader& reader, StudyProtocol& protocol) {
  for (const TomlReader& part : reader.parts("groups")) {
    protocol.groups.push_back(readGroup(part, protocol));
  }
  if (protocol.groups.size() == 1) {
    reader.refuse(reader.lineOf("", "groups"),
                  fmt::format("[[groups]] = {} alone is not valid: must be two or more", protocol.groups[0].name));
  }
  if (protocol.groups.empty() && reader.has("assignment")) {
    reader.refuseKey({"", "assignment"}, "left out: there are no [[groups]]");
  }
  reader.check(protocolKeys(), "assignment", [&] { requireStrata(protocol); });
  if (!protocol.groups.empty()) {
    setBlockSize(reader, protocol);
    requireEveryBlock(reader, protocol);
  }
}

}  // namespace haptolith

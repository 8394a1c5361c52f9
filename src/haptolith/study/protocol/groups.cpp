#include "haptolith/study/protocol/groups.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <random>

#include "haptolith/core/error.h"
#include "haptolith/study/protocol/form.h"
#include "haptolith/study/protocol/random_draws.h"

namespace haptolith {

namespace {

bool isNumber(const FormItem& item) {
  return item.kind == FormItem::Kind::kNumber || item.kind == FormItem::Kind::kScale;
}

const FormItem& itemOf(const StudyProtocol& protocol, const std::string& key) {
  return *std::ranges::find(protocol.demographics, key, &FormItem::key);
}

/// Returns the index of the item's part that contains an answer.
std::size_t partOf(const FormItem& item, const std::string& answer) {
  requireFormValues({item}, {{item.key, answer}});
  if (isNumber(item)) {
    double value = 0;
    std::from_chars(answer.data(), answer.data() + answer.size(), value);
    return static_cast<std::size_t>(std::ranges::upper_bound(item.cut_points, value) - item.cut_points.begin());
  }
  const std::vector<std::string> parts = stratumParts(item);
  return static_cast<std::size_t>(std::ranges::find(parts, answer) - parts.begin());
}

/// Returns one turn of the groups, each as often as its share: with shares 2 and 1: first, second, first.
std::vector<std::size_t> oneTurn(const StudyProtocol& protocol) {
  std::vector<std::size_t> turn;
  int most = 0;
  for (const ParticipantGroup& group : protocol.groups) {
    most = std::max(most, group.share);
  }
  for (int round = 0; round < most; ++round) {
    for (std::size_t group = 0; group < protocol.groups.size(); ++group) {
      if (round < protocol.groups[group].share) {
        turn.push_back(group);
      }
    }
  }
  return turn;
}

}  // namespace

std::vector<std::string> stratumParts(const FormItem& item) {
  if (item.kind == FormItem::Kind::kChoice) {
    return item.choices;
  }
  if (item.kind == FormItem::Kind::kYesNo) {
    return {"yes", "no"};
  }
  if (!isNumber(item) || item.cut_points.empty()) {
    return {};
  }
  std::vector<std::string> parts{fmt::format("< {}", item.cut_points.front())};
  for (std::size_t i = 1; i < item.cut_points.size(); ++i) {
    parts.push_back(fmt::format("{} to < {}", item.cut_points[i - 1], item.cut_points[i]));
  }
  parts.push_back(fmt::format(">= {}", item.cut_points.back()));
  return parts;
}

std::size_t strataOf(const StudyProtocol& protocol) {
  std::size_t strata = 1;
  for (const std::string& key : protocol.assignment.strata) {
    strata *= stratumParts(itemOf(protocol, key)).size();
  }
  return strata;
}

std::size_t stratumOf(const StudyProtocol& protocol, const std::map<std::string, std::string>& answers) {
  std::size_t stratum = 0;
  for (const std::string& key : protocol.assignment.strata) {
    const FormItem& item = itemOf(protocol, key);
    const auto answer = answers.find(key);
    stratum = stratum * stratumParts(item).size() + partOf(item, answer == answers.end() ? "" : answer->second);
  }
  return stratum;
}

std::string stratumText(const StudyProtocol& protocol, std::size_t stratum) {
  std::vector<std::string> texts;
  std::size_t within = strataOf(protocol);  // number of strata in each part of the items so far
  for (const std::string& key : protocol.assignment.strata) {
    const std::vector<std::string> parts = stratumParts(itemOf(protocol, key));
    within /= parts.size();
    texts.push_back(fmt::format("{} {}", key, parts[stratum / within % parts.size()]));
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

std::size_t groupAt(const StudyProtocol& protocol, std::uint64_t study_seed, std::size_t stratum, std::size_t place) {
  const std::vector<std::size_t> turn = oneTurn(protocol);
  if (protocol.assignment.method == AssignmentMethod::kAlternate) {
    return turn[place % turn.size()];
  }
  const auto size = static_cast<std::size_t>(protocol.assignment.block_size);
  std::vector<std::size_t> block;
  while (block.size() < size) {
    block.insert(block.end(), turn.begin(), turn.end());
  }
  constexpr std::uint64_t kNobody = 0;  // participants are counted from 1
  std::mt19937_64 random(
      seedOf({study_seed, kNobody, stratum, static_cast<std::uint64_t>(Purpose::kGroups), place / size}));
  shuffle(block, random);
  return block[place % size];
}

const ParticipantGroup& groupNamed(const StudyProtocol& protocol, std::string_view name) {
  const auto found = std::ranges::find(protocol.groups, name, &ParticipantGroup::name);
  if (found == protocol.groups.end()) {
    std::vector<std::string_view> names;
    std::ranges::transform(protocol.groups, std::back_inserter(names), &ParticipantGroup::name);
    throw InvalidParameter("group", fmt::format("'{}'", name), fmt::format("one of {}", fmt::join(names, ", ")));
  }
  return *found;
}

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// The parts into which an item's answers fall: its choices, "yes" and "no", or "< 30", "30 to < 50", ">= 50". Empty
/// for an item that makes no strata.
[[nodiscard]] std::vector<std::string> stratumParts(const FormItem& item);

/// How many strata a protocol has; 1 where it does not stratify.
[[nodiscard]] std::size_t strataOf(const StudyProtocol& protocol);

/// The stratum of somebody who answered this to the demographics, by keys; 0 where the protocol does not stratify.
/// @throws InvalidParameter for an answer that is missing or that the item does not allow.
[[nodiscard]] std::size_t stratumOf(const StudyProtocol& protocol, const std::map<std::string, std::string>& answers);

/// "sex female; age 30 to < 50"; empty where the protocol does not stratify.
[[nodiscard]] std::string stratumText(const StudyProtocol& protocol, std::size_t stratum);

/// The group in a place of a stratum's sequence, of the protocol's groups. Of every `block_size` places each group has
/// its share exactly (of the sum of all shares where groups take turns); the order within these follows from the
/// study's seed.
/// @param place  counted from 0.
[[nodiscard]] std::size_t groupAt(const StudyProtocol& protocol, std::uint64_t study_seed, std::size_t stratum,
                                  std::size_t place);

/// @throws InvalidParameter when the protocol has no group of that name.
[[nodiscard]] const ParticipantGroup& groupNamed(const StudyProtocol& protocol, std::string_view name);

}  // namespace haptolith

#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Returns the parts into which an item divides participants: its choices, "yes" and "no", or "< 30", "30 to < 50",
/// ">= 50". Empty for an item that makes no strata.
[[nodiscard]] std::vector<std::string> stratumParts(const FormItem& item);

/// Returns the number of strata of a protocol; 1 without stratification.
[[nodiscard]] std::size_t strataOf(const StudyProtocol& protocol);

/// Returns the stratum for answers to the demographics, by keys; 0 without stratification.
/// @throws InvalidParameter for an answer that is missing or that the item does not allow.
[[nodiscard]] std::size_t stratumOf(const StudyProtocol& protocol, const std::map<std::string, std::string>& answers);

/// Returns the name of a stratum: "sex female; age 30 to < 50"; empty without stratification.
[[nodiscard]] std::string stratumText(const StudyProtocol& protocol, std::size_t stratum);

/// Returns the index of the protocol's group at a place of a stratum's sequence. Each group has exactly its share of
/// every `block_size` places (alternating groups: of as many places as the sum of all shares). The order within these
/// places follows from the study's seed.
/// @param place  counted from 0.
[[nodiscard]] std::size_t groupAt(const StudyProtocol& protocol, std::uint64_t study_seed, std::size_t stratum,
                                  std::size_t place);

/// @throws InvalidParameter if the protocol has no group of that name.
[[nodiscard]] const ParticipantGroup& groupNamed(const StudyProtocol& protocol, std::string_view name);

}  // namespace haptolith

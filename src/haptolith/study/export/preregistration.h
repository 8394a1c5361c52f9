#pragma once

#include <string>
#include <string_view>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// What a preregistration asks for beside what the protocol says.
struct PreregistrationFacts {
  std::string_view protocol_text;  ///< from which the hash is made
  std::string_view version;        ///< of the program
};

/// The text of a preregistration in Markdown, in the order that registries ask for it (hypotheses, design,
/// participants, procedure, measures, analysis, exclusion, what is left open), written from the protocol and from what
/// the program does with the answers. What the protocol does not say stands there in [BRACKETS].
[[nodiscard]] std::string preregistrationText(const StudyProtocol& protocol, const PreregistrationFacts& facts);

}  // namespace haptolith

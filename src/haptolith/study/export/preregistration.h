#pragma once

#include <string>
#include <string_view>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Facts that a preregistration needs in addition to the protocol.
struct PreregistrationFacts {
  std::string_view protocol_text;  ///< source of the hash
  std::string_view version;        ///< the program's version
};

/// Returns the text of a preregistration in Markdown, in the order of the registries' forms: hypotheses, design,
/// participants, procedure, measures, analysis, exclusion, open points. It is derived from the protocol and from the
/// program's analysis. Gaps in the protocol appear in [BRACKETS].
[[nodiscard]] std::string preregistrationText(const StudyProtocol& protocol, const PreregistrationFacts& facts);

}  // namespace haptolith

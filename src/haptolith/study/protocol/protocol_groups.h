#pragma once

#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Reads the tables [[groups]] into a protocol whose blocks, demographics and [assignment] have been read, and checks
/// how people come into them.
/// @throws InvalidParameter for what is not valid in these, with file, line, key, value and what would be valid.
void readGroups(const TomlReader& reader, StudyProtocol& protocol);

}  // namespace haptolith

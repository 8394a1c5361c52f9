#pragma once

#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Reads the tables [[groups]] into a protocol whose blocks, demographics and [assignment] have been read, and checks
/// the assignment.
/// @throws InvalidParameter for an invalid table, with file, line, key, value and valid values.
void readGroups(const TomlReader& reader, StudyProtocol& protocol);

}  // namespace haptolith

#pragma once

#include <vector>

#include "haptolith/lab/catalogue/lab_option.h"

namespace haptolith::library {

/// Reads `text`, lines "key = value" of TOML, into options. @throws InvalidParameter, with the keys that there are.
void readOptions(const char* text, const std::vector<LabOption>& options);

}  // namespace haptolith::library

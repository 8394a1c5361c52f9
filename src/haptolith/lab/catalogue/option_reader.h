#pragma once

#include <toml++/toml.h>

#include <string_view>
#include <vector>

#include "haptolith/lab/catalogue/lab_option.h"

namespace haptolith {

/// Sets an option from a TOML value. @throws InvalidParameter with the key, the value and the valid range.
void setOption(const LabOption& option, const toml::node& node);

/// Sets the options of a table. @throws InvalidParameter as setOption(), and for an unknown key, with the valid keys.
void setOptions(const toml::table& table, const std::vector<LabOption>& options);

/// Reads `text`, TOML lines "key = value". @throws InvalidParameter as setOptions().
void readOptions(std::string_view text, const std::vector<LabOption>& options);

}  // namespace haptolith

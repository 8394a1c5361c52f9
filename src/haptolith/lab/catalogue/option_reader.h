#pragma once

#include <toml++/toml.h>

#include <string_view>
#include <vector>

#include "haptolith/lab/catalogue/lab_option.h"

namespace haptolith {

/// Sets an option from a value of TOML. @throws InvalidParameter with the key, the value and what is valid.
void setOption(const LabOption& option, const toml::node& node);

/// Sets those that a table names. @throws InvalidParameter as setOption(), and for a key that is none, with those there
/// are.
void setOptions(const toml::table& table, const std::vector<LabOption>& options);

/// Reads `text`, lines "key = value" of TOML. @throws InvalidParameter as setOptions().
void readOptions(std::string_view text, const std::vector<LabOption>& options);

}  // namespace haptolith

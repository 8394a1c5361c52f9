#pragma once

#include <filesystem>

namespace haptolith {

/// The checkout that the tests were built from. Only source_dir.cpp knows it: the compiler's cache serves all other
/// tests in every checkout.
const std::filesystem::path& sourceDir();

}  // namespace haptolith

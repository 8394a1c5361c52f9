#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "haptolith/bed/bed_parameters.h"

namespace haptolith {

/// Reads where grains are: a table (core/files/table.h) with the columns x_m, y_m, z_m and radius_m, in the scene's
/// frame, in any order and among others. Grains with 1, yes, or any number but 0 in a column `held` never move.
/// `haptolith import` and `export --format particles-csv` write such files.
/// @param radius_m  of the soil's grains: sizes are kept as differences from it.
/// @throws Failure when the file cannot be read; InvalidParameter as Table, with file, line, column and value.
[[nodiscard]] GivenGrains readGrains(const std::filesystem::path& path, double radius_m);

/// Encodes them in one word for a scene's text, bit-exact, and decodes them; empty: none.
[[nodiscard]] std::string grainsData(const GivenGrains& given);
/// @throws InvalidParameter for text that is no such word.
void readGrainsData(GivenGrains& given, std::string_view data);

}  // namespace haptolith

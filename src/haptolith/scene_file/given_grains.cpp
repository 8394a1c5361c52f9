#include "haptolith/scene_file/given_grains.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/table.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

using Grain = std::array<float, 4>;

constexpr TextLimits kLimits{.bytes = 4ULL << 30U, .line_bytes = 4000, .rows = kMostParticles};
constexpr std::array<std::string_view, 5> kColumns{"x_m", "y_m", "z_m", "radius_m", "held"};

/// Whether the row's grain is held: yes, or any number but 0.
bool isHeld(Table& table, Table::Column column) {
  const std::string& cell = table.cell(column);
  const bool is_number = !cell.empty() && cell.find_first_not_of("+-.0123456789") == std::string::npos;
  const std::optional<bool> held = is_number ? table.number(column) != 0 : table.flag(column);
  if (!held) {
    table.refuse(column, "1 for a grain that is held, or 0");
  }
  return *held;
}

GivenGrains readTable(const std::filesystem::path& path, double radius_m) {
  Table table(path, {.columns = kColumns, .limits = kLimits});
  const std::vector<Table::Column> columns = table.columns(std::span(kColumns).first<4>());
  const std::optional<Table::Column> held_column = table.find("held");
  std::vector<Grain> grains, held;
  while (table.next()) {
    (held_column && isHeld(table, *held_column) ? held : grains)
        .push_back({static_cast<float>(table.number(columns[0])), static_cast<float>(table.number(columns[1])),
                    static_cast<float>(table.number(columns[2])),
                    static_cast<float>(table.number(columns[3]) - radius_m)});
  }
  GivenGrains given{.grains = nullptr, .held = held.size(), .name = path.filename().string()};
  grains.insert(grains.end(), held.begin(), held.end());
  given.grains = std::make_shared<const std::vector<Grain>>(std::move(grains));
  return given;
}

}  // namespace

GivenGrains readGrains(const std::filesystem::path& path, double radius_m) {
  try {
    return readTable(path, radius_m);
  } catch (const InvalidParameter& error) {  // the reader of a scene adds the scene's line
    throw InvalidParameter("grains", inQuotes(path.string()), fmt::format("a table of grains: {}", error.what()));
  }
}

std::string grainsData(const GivenGrains& given) {
  if (given.count() == 0) {
    return "";
  }
  const std::string_view bytes(reinterpret_cast<const char*>(given.grains->data()), given.count() * sizeof(Grain));
  return fmt::format("{}:{}", given.held, base64(bytes));
}

void readGrainsData(GivenGrains& given, std::string_view data) {
  const std::size_t colon = data.find(':');
  const std::optional<std::string> bytes =
      colon == std::string_view::npos ? std::nullopt : fromBase64(data.substr(colon + 1));
  const bool counted =
      std::from_chars(data.data(), data.data() + std::min(colon, data.size()), given.held).ec == std::errc();
  if (!bytes || !counted || bytes->empty() || bytes->size() % sizeof(Grain) != 0) {
    throw InvalidParameter("grains_data", inQuotes(data.substr(0, 40)),
                           "the number of held particles, a colon, and the numbers of all particles in base64");
  }
  std::vector<Grain> grains(bytes->size() / sizeof(Grain));
  std::memcpy(grains.data(), bytes->data(), bytes->size());
  given.grains = std::make_shared<const std::vector<Grain>>(std::move(grains));
}

}  // namespace haptolith

#include "haptolith/scenario/given_grains.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/core/number_rows.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

using Grain = std::array<float, 4>;

constexpr TextLimits kLimits{.bytes = 4ULL << 30U, .line_bytes = 1000, .rows = kMostParticles};
constexpr std::string_view kColumns = "x_m,y_m,z_m,radius_m";

/// Whether a file's heading names a column.
bool hasColumn(const std::filesystem::path& path, std::string_view column) {
  std::ifstream file = openInput(path, kLimits.bytes);
  LineReader lines(file, path.string(), kLimits);
  std::string line;
  while (lines.next(line)) {
    if (!line.empty() && line.front() != '#') {
      return fmt::format(",{},", line).find(fmt::format(",{},", column)) != std::string::npos;
    }
  }
  return false;
}

}  // namespace

namespace {

GivenGrains readTable(const std::filesystem::path& path, double radius_m) {
  const bool tells_held = hasColumn(path, "held");
  NumberRows rows(path, tells_held ? fmt::format("{},held", kColumns) : std::string(kColumns), kLimits,
                  OtherColumns::kPassedOver);
  std::vector<Grain> grains, held;
  std::array<double, 5> numbers{};
  const std::span<double> read(numbers.data(), tells_held ? 5 : 4);
  while (rows.next(read)) {
    (numbers[4] != 0 ? held : grains)
        .push_back({static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2]),
                    static_cast<float>(numbers[3] - radius_m)});
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
  } catch (const InvalidParameter& error) {  // whoever reads a scene tells the scene's line, too
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
                           "how many grains are held, a colon, and the numbers of all of them in base64");
  }
  std::vector<Grain> grains(bytes->size() / sizeof(Grain));
  std::memcpy(grains.data(), bytes->data(), bytes->size());
  given.grains = std::make_shared<const std::vector<Grain>>(std::move(grains));
}

}  // namespace haptolith

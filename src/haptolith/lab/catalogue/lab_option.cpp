#include "haptolith/lab/catalogue/lab_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "haptolith/lab/catalogue/entries.h"

namespace haptolith {

namespace {

/// Returns an option for a number that is stored in SI and given in another unit.
LabOption inUnit(std::string key, double& value, double unit, std::string usual, std::string help) {
  return {.key = std::move(key),
          .help = std::move(help),
          .usual = std::move(usual),
          .set = LabOption::Number([&value, unit](double number) { value = number * unit; })};
}

}  // namespace

LabOption numberOption(std::string key, double& value, std::string help) {
  return inUnit(std::move(key), value, 1, fmt::format("{:g}", value), std::move(help));
}

LabOption millimetresOption(std::string key, double& length_m, std::string help) {
  return inUnit(std::move(key), length_m, kMm, fmt::format("{:g}", length_m / kMm), std::move(help));
}

LabOption degreesOption(std::string key, double& angle_rad, std::string help) {
  return {.key = std::move(key),
          .help = std::move(help),
          .usual = fmt::format("{:.3g}", degrees(angle_rad)),
          .set = LabOption::Number([&angle_rad](double deg) { angle_rad = radians(deg); })};
}

LabOption countOption(std::string key, int& value, const Range& valid, std::string help) {
  return {.key = std::move(key),
          .help = std::move(help),
          .usual = fmt::format("{}", value),
          .set = LabOption::Count{valid, [&value](std::int64_t count) { value = static_cast<int>(count); }}};
}

LabOption listOption(std::string key, std::vector<double>& values, double unit, std::string help) {
  std::vector<double> usual = values;
  std::ranges::transform(usual, usual.begin(), [unit](double value) { return value / unit; });
  return {.key = std::move(key),
          .help = std::move(help),
          .usual = fmt::format("{:g}", fmt::join(usual, ",")),
          .set = LabOption::List([&values, unit](const std::vector<double>& given) {
            values = given;
            std::ranges::transform(values, values.begin(), [unit](double value) { return value * unit; });
          })};
}

LabOption seedOption(std::string key, std::uint64_t& seed, const Range& valid, std::string help) {
  return {.key = std::move(key),
          .help = std::move(help),
          .usual = fmt::format("{}", seed),
          .set = LabOption::Count{valid, [&seed](std::int64_t given) { seed = static_cast<std::uint64_t>(given); }}};
}

LabOption textOption(std::string key, std::string& text, std::string help) {
  return wordOption(
      std::move(key), {}, text, [&text](std::string_view given) { text = given; }, std::move(help));
}

LabOption wordOption(std::string key, std::vector<std::string> words, std::string usual,
                     std::function<void(std::string_view)> set, std::string help) {
  return {.key = std::move(key),
          .help = std::move(help),
          .usual = std::move(usual),
          .set = LabOption::Word{std::move(words), std::move(set)}};
}

LabOption preparationOption(Preparation& preparation) {
  const auto set = [&preparation](std::string_view word) {
    preparation = word == "loose" ? Preparation::kLoose : word == "medium" ? Preparation::kMedium : Preparation::kDense;
  };
  return wordOption("preparation", {"dense", "medium", "loose"}, std::string(preparationWord(preparation)), set,
                    "Preparation of the soil: dense, as if shaken; loose, as if poured; or medium, as if tapped then");
}

std::string_view preparationWord(Preparation preparation) {
  switch (preparation) {
    case Preparation::kDense: return "dense";
    case Preparation::kMedium: return "medium";
    case Preparation::kLoose: return "loose";
  }
  return "";
}

LabOption depthFromOption(DepthFrom& from) {
  const auto set = [&from](std::string_view word) {
    from = word == "surface" ? DepthFrom::kSurface : DepthFrom::kTips;
  };
  return wordOption(
      "depth_from", {"tips", "surface"}, from == DepthFrom::kSurface ? "surface" : "tips", set,
      "Origin of the depth: the tops of the highest particles, or the surface of soil of uniform density");
}

}  // namespace haptolith

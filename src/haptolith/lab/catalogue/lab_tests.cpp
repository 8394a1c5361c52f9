#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "haptolith/core/nearest_word.h"
#include "haptolith/lab/catalogue/entries.h"

namespace haptolith {

namespace {

/// An option for a number that is kept in SI and given in another unit.
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

LabOption preparationOption(Preparation& preparation) {
  return {.key = "preparation",
          .help = "of the soil: dense, as if shaken, or loose, as if poured",
          .usual = preparation == Preparation::kLoose ? "loose" : "dense",
          .set = LabOption::Word{{"dense", "loose"}, [&preparation](std::string_view word) {
                                   preparation = word == "loose" ? Preparation::kLoose : Preparation::kDense;
                                 }}};
}

std::vector<LabTest> labTests() {
  return {settleEntry(), shearEntry(),  reposeEntry(), cutEntry(),  plateEntry(), coneEntry(),
          bladeEntry(),  funnelEntry(), carryEntry(),  fallEntry(), grainEntry()};
}

LabTest labTest(std::string_view name) {
  std::vector<LabTest> tests = labTests();
  const auto found = std::ranges::find(tests, name, &LabTest::name);
  if (found != tests.end()) {
    return std::move(*found);
  }
  std::vector<std::string_view> names;
  names.reserve(tests.size());
  for (const LabTest& test : tests) {
    names.push_back(test.name);
  }
  const std::string_view nearest = nearestWord(name, names);
  throw InvalidParameter("test", fmt::format("'{}'", name),
                         fmt::format("one of {}{}", fmt::join(names, ", "),
                                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
}

}  // namespace haptolith

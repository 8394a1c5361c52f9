#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "haptolith/core/former_names.h"
#include "haptolith/core/nearest_word.h"
#include "haptolith/lab/catalogue/entries.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {

SoilParameters soilForTest(SoilParameters soil, double radius_mm, const SoilChanges& changes) {
  constexpr Range kRadius_mm{0.1, 100};
  if (changes.radius_mm || radius_mm > 0) {
    const double wanted_mm = changes.radius_mm.value_or(radius_mm);
    soil = rescaled(soil, requireInRange("radius_mm", wanted_mm, kRadius_mm) * kMm);
  }
  if (changes.stiffness_n_m) {
    soil = withStiffness(soil, *changes.stiffness_n_m);
  }
  soil.friction = changes.friction.value_or(soil.friction);
  return soil;
}

namespace {

/// Removes the unit: "depth" from "depth_mm".
std::string_view withoutUnit(std::string_view name) {
  return name.substr(0, name.rfind('_'));
}

/// Converts an error of a test to the key and unit of the option: rake_rad to rake_deg, diameter_m to
/// plate_diameter_mm.
InvalidParameter inUnitOfOption(const InvalidParameter& error, const std::vector<LabOption>& options) {
  const std::string_view wanted = withoutUnit(error.key());
  for (const LabOption& option : options) {
    const std::string_view offered = withoutUnit(option.key);
    if (offered == wanted || offered.ends_with(fmt::format("_{}", wanted))) {
      return inUnitOfKey(error, option.key);
    }
  }
  return error;
}

/// Returns the test with errors in the units of its options.
LabTest inUnitsOfOptions(LabTest test) {
  test.run = [run = std::move(test.run), options = test.options](const LabSoil& soil, const LabConditions& conditions) {
    try {
      return run(soil, conditions);
    } catch (const InvalidParameter& error) {
      throw inUnitOfOption(error, options);
    }
  };
  return test;
}

}  // namespace

std::vector<LabTest> labTests() {
  std::vector<LabTest> tests{settleEntry(),    shearEntry(), reposeEntry(), verticalCutEntry(), plateEntry(),
                             coneEntry(),      bladeEntry(), hopperEntry(), payloadEntry(),     freeFallEntry(),
                             grainSizeEntry(), rftEntry(),   wheelEntry()};
  for (LabTest& test : tests) {
    test = inUnitsOfOptions(std::move(test));
  }
  return tests;
}

LabTest labTest(std::string_view name) {
  std::vector<LabTest> tests = labTests();
  const auto found = std::ranges::find(tests, currentNameReported(NameKind::kLabTest, name), &LabTest::name);
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

#pragma once

#include <array>
#include <string_view>

/// One of the two experiments of icra2021 (section III).
struct Experiment {
  std::string_view name;
  double reference;
  double w;
  std::array<double, 5> levels;
};
constexpr std::array<Experiment, 2> kExperiments{{{"friction", 0.835, 0.29, {0.600, 0.648, 0.735, 1.00, 1.21}},
                                                  {"gravity", 1.625, 3.31, {0.270, 0.625, 1.314, 3.721, 9.807}}}};

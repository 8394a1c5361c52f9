#include "haptolith/soil/bodies.h"

#include <array>

#include "haptolith/soil/find_by_name.h"

namespace haptolith {

namespace {
constexpr std::array kBodies{
    Body{"Ceres", 0.270}, Body{"Pluto", 0.625}, Body{"Europa", 1.314},
    Body{"Moon", 1.625},  Body{"Mars", 3.721},  Body{"Earth", 9.807},
};
}  // namespace

std::span<const Body> bodies() {
  return kBodies;
}

const Body& findBody(std::string_view name) {
  return findByName(kBodies, "body", name);
}

}  // namespace haptolith

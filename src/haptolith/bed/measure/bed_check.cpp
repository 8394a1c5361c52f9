#include "haptolith/bed/measure/bed_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace haptolith {

namespace {

bool isFinite(const Float4& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

bool areOpposite(const Slip& a, const Slip& b) {
  return a.x == -b.x && a.y == -b.y && a.z == -b.z;
}

/// Index of i in j's list; count(j) if it is absent.
std::uint32_t placeIn(const ContactLists& lists, std::size_t j, std::size_t i) {
  std::uint32_t s = 0;
  while (s < lists.count(j) && static_cast<std::size_t>(lists.neighbour(j, s)) != i) {
    ++s;
  }
  return s;
}

std::string wrongInRecords(const BedState& state) {
  const std::size_t particles = state.particles();
  for (std::size_t i = 0; i < particles; ++i) {
    if (!isFinite(state.position[i]) || !isFinite(state.velocity[i])) {
      return fmt::format("particle {} is not finite", i);
    }
  }
  if (state.position.size() != paddedCount(particles) || state.velocity.size() != state.position.size() ||
      state.rested.size() != state.position.size() / kGroup) {
    return fmt::format("{} particles have {} positions, {} velocities and {} groups", particles, state.position.size(),
                       state.velocity.size(), state.rested.size());
  }
  for (std::size_t i = 0; i < particles; ++i) {
    const Float4& v = state.velocity[i];
    if (state.asleep(i / kGroup) && (v.x != 0 || v.y != 0 || v.z != 0)) {
      return fmt::format("particle {} moves in group {}, which sleeps", i, i / kGroup);
    }
  }
  return {};
}

std::string wrongInList(const BedState& state, std::size_t i) {
  const ContactLists& lists = state.contacts;
  std::array<std::int32_t, ContactLists::kMostNeighbours> named;  // allocates nothing: debug builds check in the tick
  for (std::uint32_t s = 0; s < lists.count(i); ++s) {
    const std::int32_t j = lists.neighbour(i, s);
    if (j < 0 || static_cast<std::size_t>(j) >= state.particles() || static_cast<std::size_t>(j) == i) {
      return fmt::format("particle {} lists {}", i, j);
    }
    named[s] = j;
    const auto other = static_cast<std::size_t>(j);
    const std::uint32_t back = placeIn(lists, other, i);
    if (back == lists.count(other)) {
      return fmt::format("particle {} lists {}, which does not list it", i, j);
    }
    const bool both_awake = !state.asleep(i / kGroup) && !state.asleep(other / kGroup);
    if (lists.remembers() && both_awake && !areOpposite(lists.slip(i, s), lists.slip(other, back))) {
      return fmt::format("particles {} and {} remember different slips", i, j);
    }
  }
  const auto end = named.begin() + lists.count(i);
  std::sort(named.begin(), end);
  if (const auto twice = std::adjacent_find(named.begin(), end); twice != end) {
    return fmt::format("particle {} lists {} twice", i, *twice);
  }
  return {};
}

std::string wrongInRows(const BedState& state, std::size_t group) {
  const ContactLists& lists = state.contacts;
  const std::size_t first = group * kGroup;
  const std::size_t last = std::min(first + kGroup, state.particles());
  std::uint32_t longest = 0;
  for (std::size_t i = first; i < last; ++i) {
    longest = std::max(longest, lists.count(i));
  }
  if (lists.rowCounts()[group] != longest) {
    return fmt::format("group {} has {} rows and a list of {}", group, lists.rowCounts()[group], longest);
  }
  for (std::size_t i = first; i < first + kGroup; ++i) {
    for (std::uint32_t s = i < last ? lists.count(i) : 0; s < longest; ++s) {
      if (static_cast<std::size_t>(lists.neighbour(i, s)) != state.particles()) {
        return fmt::format("entry {} behind the list of {} is {}, not the ghost", s, i, lists.neighbour(i, s));
      }
    }
  }
  return {};
}

}  // namespace

std::string inconsistency(const BedState& state) {
  std::string wrong = wrongInRecords(state);
  for (std::size_t i = 0; i < state.particles() && wrong.empty(); ++i) {
    wrong = wrongInList(state, i);
  }
  for (std::size_t group = 0; group < state.contacts.groups() && wrong.empty(); ++group) {
    wrong = wrongInRows(state, group);
  }
  return wrong;
}

}  // namespace haptolith

#include "haptolith/bed/contact_lists.h"

#include <algorithm>
#include <bit>

#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

constexpr std::size_t kSlipRow = 3 * kGroup;

/// Rows for every group to begin with, to outgrow that once, and for a small bed to collapse into one point.
std::size_t reservedRows(std::size_t groups) {
  constexpr std::size_t kUsualRows = 24 + 32 + 16;
  constexpr std::size_t kCollapsing = 64;
  constexpr std::size_t kCrowded = 96;  // neighbours
  return groups * kUsualRows + std::min(groups, kCollapsing) * 2 * kCrowded;
}

}  // namespace

ContactLists::ContactLists(std::size_t particles, bool remembers)
    : remembers_(remembers),
      ghost_(offsetOf(static_cast<std::int32_t>(particles))),
      first_row_(paddedCount(particles) / kGroup),
      rows_(first_row_.size()),
      touched_(first_row_.size()),
      near_(first_row_.size()),
      room_(first_row_.size()),
      count_(particles) {
  const std::size_t rows = reservedRows(first_row_.size());
  other_.reserve(rows * kGroup);
  slip_.reserve(remembers ? rows * kSlipRow : 0);
  for (std::uint32_t& row : first_row_) {
    row = takeRows(0);
  }
  first_row_.push_back(0);  // the kernel looks one group ahead
}

Slip ContactLists::slip(std::size_t i, std::uint32_t s) const noexcept {
  HAPTO_ASSERT(remembers_);
  HAPTO_ASSERT(s < kRooms[room_[i / kGroup]]);
  const float* x = slip_.data() + (first_row_[i / kGroup] + s) * kSlipRow + i % kGroup;
  return {x[0], x[kGroup], x[2 * kGroup]};
}

void ContactLists::setSlip(std::size_t i, std::uint32_t s, const Slip& slip) noexcept {
  HAPTO_ASSERT(remembers_);
  HAPTO_ASSERT(s < kRooms[room_[i / kGroup]]);
  float* x = slipAt(i, s);
  x[0] = slip.x;
  x[kGroup] = slip.y;
  x[2 * kGroup] = slip.z;
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  if ((bits(slip.x) | bits(slip.y) | bits(slip.z)) != 0) {  // a negative zero counts: it must also be cleared
    std::uint16_t& touched = touched_[i / kGroup][i % kGroup / 4];
    touched = std::max(touched, static_cast<std::uint16_t>(s + 1));
  }
}

bool ContactLists::add(std::size_t i, std::int32_t j) noexcept {
  HAPTO_ASSERT(i < particles());
  HAPTO_ASSERT(j >= 0);
  HAPTO_ASSERT(count_[i] <= kRooms[room_[i / kGroup]]);
  const std::size_t group = i / kGroup;
  const std::uint16_t s = count_[i];
  if (s == kRooms[room_[group]] && !grow(group)) {
    return false;
  }
  set(i, s, j);
  ++count_[i];
  rows_[group] = std::max(rows_[group], count_[i]);
  return true;
}

void ContactLists::remove(std::size_t i, std::uint32_t s) noexcept {
  HAPTO_ASSERT(i < particles());
  HAPTO_ASSERT(s < count_[i]);
  const std::size_t group = i / kGroup;
  const auto last = static_cast<std::uint16_t>(count_[i] - 1);
  other_[slot(i, s)] = other_[slot(i, last)];
  other_[slot(i, last)] = ghost_;
  near_[group].pruning_pass = 0;
  if (remembers_) {
    setSlip(i, s, slip(i, last));
    setSlip(i, last, {});
  }
  count_[i] = last;
  if (rows_[group] == last + 1) {
    const auto first = count_.begin() + static_cast<std::ptrdiff_t>(group * kGroup);
    const auto in_group = static_cast<std::ptrdiff_t>(std::min(kGroup, count_.size() - group * kGroup));
    rows_[group] = *std::max_element(first, first + in_group);
  }
}

std::uint32_t ContactLists::find(std::size_t i, std::int32_t j) const noexcept {
  HAPTO_ASSERT(i < particles());
  const std::uint32_t count = count_[i];
  std::uint32_t s = 0;
  while (s < count && neighbour(i, s) != j) {
    ++s;
  }
  HAPTO_ASSERT(s < count);  // lists are symmetric
  return s;
}

void ContactLists::removeNeighbour(std::size_t i, std::int32_t j) noexcept {
  HAPTO_ASSERT(i < particles());
  if (const std::uint32_t s = find(i, j); s < count_[i]) {
    remove(i, s);
  }
}

void ContactLists::clear() noexcept {
  for (std::size_t group = 0; group < groups(); ++group) {
    for (std::size_t row = 0; row < rows_[group]; ++row) {
      emptyRow(first_row_[group] + row);
    }
    rows_[group] = 0;
    touched_[group] = {};
    near_[group] = {};
  }
  std::ranges::fill(count_, std::uint16_t{0});
}

void ContactLists::takeOver(const ContactLists& other) noexcept {
  HAPTO_ASSERT(other.particles() == particles());
  HAPTO_ASSERT(other.remembers() == remembers_);
  clear();
  for (std::size_t i = 0; i < particles(); ++i) {
    for (std::uint32_t s = 0; s < other.count(i); ++s) {
      if (add(i, other.neighbour(i, s)) && remembers_) {
        setSlip(i, s, other.slip(i, s));
      }
    }
  }
}

std::size_t ContactLists::bytes() const noexcept {
  return other_.size() * sizeof(other_[0]) + slip_.size() * sizeof(slip_[0]) +
         first_row_.size() * sizeof(first_row_[0]) +
         rows_.size() * (sizeof(rows_[0]) + sizeof(touched_[0]) + sizeof(near_[0]) + sizeof(room_[0])) +
         count_.size() * sizeof(count_[0]);
}

std::uint32_t ContactLists::takeRows(std::size_t room_class) noexcept {
  HAPTO_ASSERT(room_class < kRooms.size());
  const std::uint32_t left = free_[room_class];
  const std::size_t room = kRooms[room_class];
  if (left != kNone) {
    free_[room_class] = other_[left * kGroup];
    for (std::size_t row = 0; row < room; ++row) {
      emptyRow(left + row);
    }
    return left;
  }
  const std::size_t first = other_.size() / kGroup;
  if ((first + room) * kGroup > other_.capacity()) {
    return kNone;
  }
  other_.resize((first + room) * kGroup, ghost_);
  if (remembers_) {
    slip_.resize((first + room) * kSlipRow);
  }
  return static_cast<std::uint32_t>(first);
}

bool ContactLists::grow(std::size_t group) noexcept {
  HAPTO_ASSERT(group < groups());
  HAPTO_ASSERT(room_[group] < kRooms.size());
  std::size_t room_class = room_[group];
  std::uint32_t to = kNone;
  while (to == kNone && ++room_class < kRooms.size()) {
    to = takeRows(room_class);
  }
  if (to == kNone) {
    return false;
  }
  const std::size_t from = first_row_[group];
  std::copy_n(other_.begin() + static_cast<std::ptrdiff_t>(from * kGroup), rows_[group] * kGroup,
              other_.begin() + static_cast<std::ptrdiff_t>(to * kGroup));
  if (remembers_) {
    std::copy_n(slip_.begin() + static_cast<std::ptrdiff_t>(from * kSlipRow), rows_[group] * kSlipRow,
                slip_.begin() + static_cast<std::ptrdiff_t>(to * kSlipRow));
  }
  other_[from * kGroup] = free_[room_[group]];
  free_[room_[group]] = static_cast<std::uint32_t>(from);
  first_row_[group] = to;
  room_[group] = static_cast<std::uint8_t>(room_class);
  return true;
}

void ContactLists::emptyRow(std::size_t row) noexcept {
  HAPTO_ASSERT((row + 1) * kGroup <= other_.size());
  std::fill_n(other_.begin() + static_cast<std::ptrdiff_t>(row * kGroup), kGroup, ghost_);
  if (remembers_) {
    std::fill_n(slip_.begin() + static_cast<std::ptrdiff_t>(row * kSlipRow), kSlipRow, 0.0F);
  }
}

}  // namespace haptolith

#include "haptolith/bed/bed_state.h"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

static_assert(std::endian::native == std::endian::little, "saved states are little-endian");

constexpr char kBedMagic[8] = {'H', 'A', 'P', 'B', 'E', 'D', '0', '6'};
constexpr char kMagicOfWide[8] = {'H', 'A', 'P', 'B', 'E', 'D', '0', '7'};  // with remainders

constexpr std::string_view kStonesFollow = "HAPSTNS:";  // no bed begins with it

struct Header {
  char magic[8];
  std::uint64_t step;
  std::uint64_t particles;
  std::uint64_t contacts;    ///< entries of the neighbour lists
  std::uint64_t remembered;  ///< particles whose friction remembers: all, or 0 with ICRA 2021 friction
};

bool isWide(const Header& header) {
  return std::memcmp(header.magic, kMagicOfWide, sizeof kMagicOfWide) == 0;
}

/// Length of what follows the header.
std::uint64_t bytesAfter(const Header& header) {
  const bool remembers = header.remembered > 0;
  const std::uint64_t groups = paddedCount(header.particles) / kGroup;
  const std::uint64_t records = isWide(header) ? 5 : 4;
  return header.particles * (records * sizeof(Float4) + sizeof(std::uint16_t)) + groups * sizeof(std::uint16_t) +
         header.contacts * (sizeof(std::int32_t) + (remembers ? sizeof(Slip) : 0)) +
         (remembers ? groups * sizeof(WallSlips) : 0);
}

template <class Record>
void append(std::string& bytes, const Record* records, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(records), count * sizeof(Record));
}

template <class Record>
void take(std::string_view& bytes, std::vector<Record>& records, std::size_t count) {
  records.resize(count);
  if (count > 0) {
    std::memcpy(records.data(), bytes.data(), count * sizeof(Record));
  }
  bytes.remove_prefix(count * sizeof(Record));
}

/// Neighbours and, with contact friction, what is remembered of them, list by list.
void append(std::string& bytes, const ContactLists& contacts) {
  for (std::size_t i = 0; i < contacts.particles(); ++i) {
    const auto count = static_cast<std::uint16_t>(contacts.count(i));
    append(bytes, &count, 1);
  }
  for (std::size_t i = 0; i < contacts.particles(); ++i) {
    for (std::uint32_t s = 0; s < contacts.count(i); ++s) {
      const std::int32_t other = contacts.neighbour(i, s);
      append(bytes, &other, 1);
      if (contacts.remembers()) {
        const Slip slip = contacts.slip(i, s);
        append(bytes, &slip, 1);
      }
    }
  }
}

ContactLists takeContacts(std::string_view& bytes, const Header& header) {
  std::vector<std::uint16_t> counts;
  take(bytes, counts, header.particles);
  ContactLists contacts(header.particles, header.remembered > 0);
  std::uint64_t left = header.contacts;
  for (std::size_t i = 0; i < header.particles; ++i) {
    for (std::uint16_t s = 0; s < counts[i]; ++s) {
      std::vector<std::int32_t> other;
      std::vector<Slip> slip;
      const bool there = left-- > 0;
      if (there) {
        take(bytes, other, 1);
        take(bytes, slip, contacts.remembers() ? 1 : 0);
      }
      if (!there || other[0] < 0 || static_cast<std::uint64_t>(other[0]) >= header.particles ||
          static_cast<std::size_t>(other[0]) == i || !contacts.add(i, other[0])) {
        throw Failure("this saved bed is damaged: its neighbour lists are malformed");
      }
      if (contacts.remembers()) {
        contacts.setSlip(i, s, slip[0]);
      }
    }
  }
  if (left != 0) {
    throw Failure("this saved bed is damaged: its neighbour lists are truncated");
  }
  return contacts;
}

}  // namespace

std::uint64_t stateHash(const BedState& state, std::span<const ToolTrace> tools, std::size_t part,
                        std::size_t parts) noexcept {
  const std::size_t groups = (state.particles() + kGroup - 1) / kGroup;
  const std::size_t first = groups * part / parts;
  const std::size_t last = groups * (part + 1) / parts;
  std::uint64_t hash = state.step;
  const auto add = [&](const auto& values, std::size_t per_group, std::size_t count) {
    const std::size_t from = std::min(first * per_group, count);
    const std::size_t to = std::min(last * per_group, count);
    hash = from < to ? XXH3_64bits_withSeed(values.data() + from, (to - from) * sizeof values[0], hash) : hash;
  };
  add(state.position, kGroup, state.particles());
  add(state.velocity, kGroup, state.particles());
  for (const ToolTrace& tool : tools) {
    add(tool.side, kGroup, tool.side.size());
  }
  add(state.remainder, kGroup, state.remainder.empty() ? 0 : state.particles());
  const ContactLists& contacts = state.contacts;
  for (std::size_t group = first; contacts.remembers() && group < std::min(last, contacts.groups()); ++group) {
    const std::size_t row = 3 * kGroup;
    hash = XXH3_64bits_withSeed(contacts.slips() + contacts.firstRows()[group] * row,
                                contacts.rowCounts()[group] * row * sizeof(float), hash);
  }
  add(state.wall_slip, 1, state.wall_slip.size());
  for (const ToolTrace& tool : tools) {
    add(tool.slip, kGroup, tool.slip.size());
  }
  return hash;
}

std::string serialise(const BedState& state) {
  const std::size_t n = state.particles();
  Header header{{}, state.step, n, 0, state.contacts.remembers() ? n : 0};
  for (std::size_t i = 0; i < n; ++i) {
    header.contacts += state.contacts.count(i);
  }
  const bool wide = !state.remainder.empty();
  std::memcpy(header.magic, wide ? kMagicOfWide : kBedMagic, sizeof kBedMagic);
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  append(bytes, state.position.data(), n);
  append(bytes, state.velocity.data(), n);
  append(bytes, state.reference_position.data(), n);
  append(bytes, state.rested.data(), state.rested.size());
  append(bytes, state.rested_at.data(), n);
  append(bytes, state.contacts);
  append(bytes, state.wall_slip.data(), state.wall_slip.size());
  append(bytes, state.remainder.data(), wide ? n : 0);
  return bytes;
}

BedState deserialiseBedState(std::string_view bytes) {
  Header header{};
  if (bytes.size() < sizeof header) {
    throw Failure("not a saved bed: shorter than the header");
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.magic, kBedMagic, sizeof kBedMagic) != 0 && !isWide(header)) {
    throw Failure("not a saved bed, or saved by another version");
  }
  bytes.remove_prefix(sizeof header);
  const std::uint64_t n = header.particles;
  constexpr std::uint64_t kMost = 100'000'000'000;  // no sum of lengths overflows
  const bool possible = header.particles <= kMost && header.contacts <= kMost &&
                        (header.remembered == 0 || header.remembered == header.particles);
  if (!possible || bytes.size() != bytesAfter(header)) {
    throw Failure("this saved bed is damaged: its length does not match its number of particles");
  }
  BedState state;
  state.step = header.step;
  state.particle_count = n;
  take(bytes, state.position, n);
  take(bytes, state.velocity, n);
  take(bytes, state.reference_position, n);
  take(bytes, state.rested, paddedCount(n) / kGroup);
  take(bytes, state.rested_at, n);
  state.contacts = takeContacts(bytes, header);
  take(bytes, state.wall_slip, header.remembered > 0 ? paddedCount(n) / kGroup : 0);
  if (isWide(header)) {
    take(bytes, state.remainder, n);
    state.remainder.resize(paddedCount(n));
  }
  state.position.resize(paddedCount(n), kGhost);
  state.velocity.resize(paddedCount(n), kGhostVelocity);
  state.reference_position.resize(paddedCount(n), kGhost);
  state.rested_at.resize(paddedCount(n), kGhost);
  return state;
}

std::string serialise(const SavedBed& saved) {
  std::string bytes;
  append(bytes, &saved.grid_height_m, 1);
  if (!saved.stones.stones.empty()) {  // a bed without is saved as it was before there were stones
    const std::string stones = serialise(saved.stones);
    const std::uint64_t length = stones.size();
    append(bytes, kStonesFollow.data(), kStonesFollow.size());
    append(bytes, &length, 1);
    bytes += stones;
  }
  return bytes + serialise(saved.state);
}

SavedBed deserialiseSavedBed(std::string_view bytes) {
  SavedBed saved;
  if (bytes.size() >= sizeof saved.grid_height_m) {
    std::memcpy(&saved.grid_height_m, bytes.data(), sizeof saved.grid_height_m);
    bytes.remove_prefix(sizeof saved.grid_height_m);
  }
  if (bytes.starts_with(kStonesFollow)) {
    bytes.remove_prefix(kStonesFollow.size());
    std::vector<std::uint64_t> length(1, bytes.size() + 1);
    if (bytes.size() >= sizeof length[0]) {
      take(bytes, length, 1);
    }
    if (length[0] > bytes.size()) {
      throw Failure("this saved bed is damaged: its stones are truncated");
    }
    saved.stones = deserialiseStones(bytes.substr(0, length[0]));
    bytes.remove_prefix(length[0]);
  }
  saved.state = deserialiseBedState(bytes);
  return saved;
}

}  // namespace haptolith

#include "haptolith/bed/bed_state.h"

#include <xxhash.h>

#include <bit>
#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

static_assert(std::endian::native == std::endian::little, "saved states are little-endian");

constexpr char kMagic[8] = {'H', 'A', 'P', 'B', 'E', 'D', '0', '2'};

struct Header {
  char magic[8];
  std::uint64_t step;
  std::uint64_t particles;
  std::uint64_t slips;       ///< entries of the contact memory
  std::uint64_t remembered;  ///< particles whose friction remembers: all, or 0 with the paper's friction
};

/// Length of what follows the header.
std::uint64_t bytesAfter(const Header& header) {
  return 3 * (header.particles + 1) * sizeof(Float4) + header.particles + 3 * header.slips * sizeof(float) +
         header.remembered * (sizeof(WallSlip) + sizeof(Float4));
}

template <class Records>
std::uint64_t hashed(const Records& records, std::uint64_t seed) noexcept {
  return records.empty() ? seed : XXH3_64bits_withSeed(records.data(), records.size() * sizeof(records[0]), seed);
}

template <class Records>
void append(std::string& bytes, const Records& records) {
  bytes.append(reinterpret_cast<const char*>(records.data()), records.size() * sizeof(records[0]));
}

template <class Records>
void take(std::string_view& bytes, Records& records, std::size_t count) {
  const std::size_t size = count * sizeof(records[0]);
  records.resize(count);
  if (size > 0) {
    std::memcpy(records.data(), bytes.data(), size);
  }
  bytes.remove_prefix(size);
}

}  // namespace

std::uint64_t stateHash(const BedState& state) noexcept {
  const std::size_t bytes = state.particles() * sizeof(Float4);
  std::uint64_t hash = XXH3_64bits_withSeed(state.position.data(), bytes, state.step);
  hash = XXH3_64bits_withSeed(state.velocity.data(), bytes, hash);
  hash = hashed(state.tool_side, hash);
  hash = hashed(state.slip_x, hash);
  hash = hashed(state.slip_y, hash);
  hash = hashed(state.slip_z, hash);
  hash = hashed(state.wall_slip, hash);
  return hashed(state.tool_slip, hash);
}

std::string serialise(const BedState& state) {
  Header header{{}, state.step, state.particles(), state.slip_x.size(), state.wall_slip.size()};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  append(bytes, state.position);
  append(bytes, state.velocity);
  append(bytes, state.listed_at);
  append(bytes, state.tool_side);
  append(bytes, state.slip_x);
  append(bytes, state.slip_y);
  append(bytes, state.slip_z);
  append(bytes, state.wall_slip);
  append(bytes, state.tool_slip);
  return bytes;
}

BedState deserialiseBedState(std::string_view bytes) {
  Header header{};
  if (bytes.size() < sizeof header) {
    throw Failure("this is no saved bed: it is shorter than the header");
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) {
    throw Failure("this is no saved bed, or one of another version");
  }
  bytes.remove_prefix(sizeof header);
  const std::uint64_t records = header.particles + 1;
  constexpr std::uint64_t kMost = 100'000'000'000;  // no sum of lengths overflows
  const bool possible = header.particles <= kMost && header.slips <= kMost &&
                        (header.remembered == 0 || header.remembered == header.particles);
  if (!possible || bytes.size() != bytesAfter(header)) {
    throw Failure("this saved bed is damaged: its length does not fit its number of particles");
  }
  BedState state;
  state.step = header.step;
  take(bytes, state.position, records);
  take(bytes, state.velocity, records);
  take(bytes, state.listed_at, records);
  take(bytes, state.tool_side, header.particles);
  take(bytes, state.slip_x, header.slips);
  take(bytes, state.slip_y, header.slips);
  take(bytes, state.slip_z, header.slips);
  take(bytes, state.wall_slip, header.remembered);
  take(bytes, state.tool_slip, header.remembered);
  return state;
}

}  // namespace haptolith

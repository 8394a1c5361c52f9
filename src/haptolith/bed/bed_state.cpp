#include "haptolith/bed/bed_state.h"

#include <xxhash.h>

#include <bit>
#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

static_assert(std::endian::native == std::endian::little, "saved states are little-endian");

constexpr char kMagic[8] = {'H', 'A', 'P', 'B', 'E', 'D', '0', '1'};

struct Header {
  char magic[8];
  std::uint64_t step;
  std::uint64_t particles;
};

template <class Record>
void append(std::string& bytes, const std::vector<Record>& records) {
  bytes.append(reinterpret_cast<const char*>(records.data()), records.size() * sizeof(Record));
}

template <class Record>
void take(std::string_view& bytes, std::vector<Record>& records, std::size_t count) {
  records.resize(count);
  std::memcpy(records.data(), bytes.data(), count * sizeof(Record));
  bytes.remove_prefix(count * sizeof(Record));
}

}  // namespace

std::uint64_t stateHash(const BedState& state) noexcept {
  const std::size_t bytes = state.particles() * sizeof(Float4);
  std::uint64_t hash = XXH3_64bits_withSeed(state.position.data(), bytes, state.step);
  hash = XXH3_64bits_withSeed(state.velocity.data(), bytes, hash);
  return XXH3_64bits_withSeed(state.tool_side.data(), state.tool_side.size(), hash);
}

std::string serialise(const BedState& state) {
  Header header{{}, state.step, state.particles()};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  append(bytes, state.position);
  append(bytes, state.velocity);
  append(bytes, state.listed_at);
  append(bytes, state.tool_side);
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
  if (header.particles > 1'000'000'000 || bytes.size() != 3 * records * sizeof(Float4) + header.particles) {
    throw Failure("this saved bed is damaged: its length does not fit its number of particles");
  }
  BedState state;
  state.step = header.step;
  take(bytes, state.position, records);
  take(bytes, state.velocity, records);
  take(bytes, state.listed_at, records);
  take(bytes, state.tool_side, header.particles);
  return state;
}

}  // namespace haptolith

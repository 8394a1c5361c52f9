#include "haptolith/bed/stones_state.h"

#include <xxhash.h>

#include <array>
#include <cstring>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr std::array<char, 8> kStonesMagic{'H', 'A', 'P', 'S', 'T', 'N', '0', '2'};

/// A stone as numbers only, so that its bytes are its value.
struct Record {
  std::array<double, 7> pose, rested_at;  ///< x y z in m, w x y z
  std::array<double, 3> velocity_m_s, angular_momentum_nms;
  std::uint64_t rested;
};

std::array<double, 7> numbersOf(const Pose& pose) noexcept {
  const Vec3& p = pose.position_m;
  const Quat& q = pose.orientation;
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

Pose poseOf(const std::array<double, 7>& n) {
  return {Vec3(n[0], n[1], n[2]), Quat(n[3], n[4], n[5], n[6])};
}

Record recordOf(const StoneState& stone) noexcept {
  const Vec3& v = stone.velocity_m_s;
  const Vec3& l = stone.angular_momentum_nms;
  return {.pose = numbersOf(stone.scene_T_stone),
          .rested_at = numbersOf(stone.rested_at),
          .velocity_m_s = {v.x(), v.y(), v.z()},
          .angular_momentum_nms = {l.x(), l.y(), l.z()},
          .rested = stone.rested};
}

template <class Value>
Value take(std::string_view& bytes) {
  if (bytes.size() < sizeof(Value)) {
    throw Failure("these saved stones are truncated");
  }
  Value value;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return value;
}

template <class Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::uint64_t stonesHash(const StonesState& state, std::uint64_t hash) noexcept {
  for (const StoneState& stone : state.stones) {
    const Record record = recordOf(stone);
    hash = XXH3_64bits_withSeed(&record, sizeof record, hash);
  }
  return hash;
}

std::string serialise(const StonesState& state) {
  std::string bytes(kStonesMagic.data(), kStonesMagic.size());
  append(bytes, std::uint64_t{state.stones.size()});
  append(bytes, std::uint64_t{state.slips.size()});
  for (const StoneState& stone : state.stones) {
    append(bytes, recordOf(stone));
  }
  for (const StoneSlip& slip : state.slips) {
    append(bytes, slip);
  }
  return bytes;
}

StonesState deserialiseStones(std::string_view bytes) {
  if (take<std::array<char, 8>>(bytes) != kStonesMagic) {
    throw Failure("not saved stones, or saved by another version");
  }
  const auto stones = take<std::uint64_t>(bytes);
  const auto slips = take<std::uint64_t>(bytes);
  if (stones > bytes.size() / sizeof(Record) || slips != (bytes.size() - stones * sizeof(Record)) / sizeof(StoneSlip) ||
      bytes.size() != stones * sizeof(Record) + slips * sizeof(StoneSlip)) {
    throw Failure("these saved stones are damaged: their length does not match their number");
  }
  StonesState state;
  for (std::uint64_t i = 0; i < stones; ++i) {
    const auto record = take<Record>(bytes);
    state.stones.push_back({.scene_T_stone = poseOf(record.pose),
                            .velocity_m_s = Vec3::Map(record.velocity_m_s.data()),
                            .angular_momentum_nms = Vec3::Map(record.angular_momentum_nms.data()),
                            .rested_at = poseOf(record.rested_at),
                            .rested = static_cast<std::uint16_t>(record.rested)});
  }
  for (std::uint64_t i = 0; i < slips; ++i) {
    state.slips.push_back(take<StoneSlip>(bytes));
  }
  return state;
}

}  // namespace haptolith

#include "haptolith/bed/wakefulness.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/assert.h"

namespace haptolith {

namespace {

constexpr std::size_t kBits = 64;  // bits per word

/// Calls `each(i, s, j)` for all entries of a group's lists, as long as it returns true.
template <class Each>
bool forEachEntry(std::size_t group, const ContactLists& lists, Each each) {
  const std::size_t last = std::min((group + 1) * kGroup, lists.particles());
  for (std::size_t i = group * kGroup; i < last; ++i) {
    for (std::uint32_t s = 0; s < lists.count(i); ++s) {
      if (!each(i, s, static_cast<std::size_t>(lists.neighbour(i, s)))) {
        return false;
      }
    }
  }
  return true;
}

Slip opposite(const Slip& slip) noexcept {
  return {0 - slip.x, 0 - slip.y, 0 - slip.z};  // zero keeps a positive sign
}

/// Approximate time at rest before sleep: counted in steps of the bed alone, which a tool may shorten.
constexpr double kRest_s = 0.1;
/// Time that defines the default distance of rest: a particle that moves further than the speed of rest times this time
/// has moved, however slowly.
constexpr double kCreep_s = 0.02;

}  // namespace

RestRule restRule(const BedParameters& bed) {
  const double dt_s = std::min(bed.tick_s, 1 / stepsPerSecond(bed, 0));
  const auto speed = static_cast<float>(bed.sleep_speed_m_s);
  return {.sleep = bed.sleep,
          .speed_m_s = speed,
          .distance_m = bed.sleep_distance_m > 0 ? static_cast<float>(bed.sleep_distance_m)
                                                 : speed * static_cast<float>(kCreep_s),
          .steps = static_cast<std::uint16_t>(std::clamp(kRest_s / dt_s, double{Wakefulness::kTurn}, 60'000.0))};
}

Wakefulness::Wakefulness(std::size_t groups, const RestRule& rule)
    : rule_(rule),
      awake_(groups + 1),
      awake_count_(groups),
      order_(groups),
      place_in_order_(groups),
      awake_bits_(groups / kBits + 1),
      moving_(groups),
      disturbed_(groups),
      ready_to_sleep_(groups) {
  std::iota(awake_.begin(), awake_.end(), 0U);
  std::iota(order_.begin(), order_.end(), 0U);
  place_in_order_ = order_;
  for (std::size_t group = 0; group < groups; ++group) {
    noteAwake(group, true);
  }
}

void Wakefulness::setOrder(const std::vector<std::uint32_t>& order) noexcept {
  HAPTO_ASSERT(order.size() <= order_.size());  // a last group of ghosts alone keeps its place
  for (std::size_t place = 0; place < order.size(); ++place) {
    order_[place] = order[place];
    place_in_order_[order[place]] = static_cast<std::uint32_t>(place);
  }
  changed_ = true;
}

void Wakefulness::noteAwake(std::size_t group, bool awake) noexcept {
  HAPTO_ASSERT(group < place_in_order_.size());
  const std::size_t place = place_in_order_[group];
  const std::uint64_t bit = std::uint64_t{1} << (place % kBits);
  std::uint64_t& word = awake_bits_[place / kBits];
  word = awake ? word | bit : word & ~bit;
  changed_ = true;
}

Wakefulness::Transitions Wakefulness::updateRest(std::size_t first, std::size_t last,
                                                 const std::vector<Float4>& position, BedState& state) noexcept {
  Transitions changes{disturbed_.data() + first, ready_to_sleep_.data() + first};
  if (!rule_.sleep) {
    return changes;
  }
  for (std::size_t k = first; k < last; ++k) {
    const std::uint32_t group = awake_[k];
    const bool its_turn = (group + state.step) % kTurn == 0;
    std::uint16_t& rested = state.rested[group];
    const bool moving = moving_[group] != 0;
    const bool crept = (moving || its_turn) && hasCrept(group, position, state);
    const bool at_rest = rested >= rule_.steps;
    if (crept || (moving && (!at_rest || rule_.speed_m_s == 0))) {
      if (at_rest) {
        changes.disturbed[changes.disturbed_count++] = group;
      }
      rested = 0;
    } else if (moving) {  // it trembles where it is: its neighbours feel no difference
      rested = rule_.steps;
    } else if (rested < readyToSleep()) {
      ++rested;
    } else if (its_turn) {
      changes.ready_to_sleep[changes.ready_to_sleep_count++] = group;
    }
  }
  return changes;
}

Wakefulness::Transitions Wakefulness::mergeTransitions(std::span<const Transitions> of_parts) noexcept {
  Transitions all{disturbed_.data(), ready_to_sleep_.data()};
  for (const Transitions& changes : of_parts) {
    std::copy_n(changes.disturbed, changes.disturbed_count, all.disturbed + all.disturbed_count);
    std::copy_n(changes.ready_to_sleep, changes.ready_to_sleep_count, all.ready_to_sleep + all.ready_to_sleep_count);
    all.disturbed_count += changes.disturbed_count;
    all.ready_to_sleep_count += changes.ready_to_sleep_count;
  }
  std::sort(all.disturbed, all.disturbed + all.disturbed_count);
  std::sort(all.ready_to_sleep, all.ready_to_sleep + all.ready_to_sleep_count);
  return all;
}

bool Wakefulness::hasCrept(std::size_t group, const std::vector<Float4>& position, BedState& state) const noexcept {
  const auto first = static_cast<std::ptrdiff_t>(group * kGroup);
  const auto here = position.begin() + first;
  const auto there = state.rested_at.begin() + first;
  const float limit = rule_.distance_m * rule_.distance_m;
  const auto far = [limit](const Float4& a, const Float4& b) {
    const float x = a.x - b.x;
    const float y = a.y - b.y;
    const float z = a.z - b.z;
    return x * x + y * y + z * z > limit;
  };
  bool crept = false;
  for (std::ptrdiff_t lane = 0; lane < static_cast<std::ptrdiff_t>(kGroup); ++lane) {
    crept = crept || far(here[lane], there[lane]);
  }
  if (crept) {
    std::copy_n(here, kGroup, there);
  }
  return crept;
}

void Wakefulness::wakeBeside(std::span<const std::uint32_t> disturbed, BedState& state) noexcept {
  for (const std::uint32_t group : disturbed) {
    forEachEntry(group, state.contacts, [&](std::size_t, std::uint32_t, std::size_t j) {
      wake(j / kGroup, state);
      return true;
    });
  }
}

void Wakefulness::wakeAround(std::size_t particle, BedState& state) noexcept {
  HAPTO_ASSERT(particle < state.particles());
  wake(particle / kGroup, state);
  for (std::uint32_t s = 0; s < state.contacts.count(particle); ++s) {
    wake(static_cast<std::size_t>(state.contacts.neighbour(particle, s)) / kGroup, state);
  }
}

void Wakefulness::wake(std::size_t group, BedState& state) noexcept {
  HAPTO_ASSERT(group < moving_.size());
  if (state.rested[group] != BedState::kAsleep) {
    return;
  }
  state.rested[group] = rule_.steps;  // at rest, but it has a turn's time to begin to move
  noteAwake(group, true);
  ContactLists& lists = state.contacts;
  if (lists.remembers()) {
    forEachEntry(group, lists, [&](std::size_t i, std::uint32_t s, std::size_t j) {
      if (j / kGroup != group && !state.asleep(j / kGroup)) {
        if (const std::uint32_t back = lists.find(j, static_cast<std::int32_t>(i)); back < lists.count(j)) {
          lists.setSlip(i, s, opposite(lists.slip(j, back)));
        }
      }
      return true;
    });
  }
}

void Wakefulness::wakeAll(BedState& state) noexcept {
  for (std::size_t group = 0; group < moving_.size(); ++group) {
    wake(group, state);
  }
}

void Wakefulness::putToSleep(std::span<const std::uint32_t> ready_to_sleep,
                             const std::vector<std::uint64_t>& keep_awake, const StepState& step) noexcept {
  for (const std::uint32_t group : ready_to_sleep) {
    const bool kept = (keep_awake[group / kBits] >> (group % kBits) & 1) != 0;
    if (!kept && maySleep(group, step.state)) {
      sleep(group, step);
    }
  }
}

bool Wakefulness::maySleep(std::size_t group, const BedState& state) const noexcept {
  HAPTO_ASSERT(group < moving_.size());
  const std::size_t last = std::min((group + 1) * kGroup, state.particles());
  for (std::size_t i = group * kGroup; i < last; ++i) {
    const Float4& v = state.velocity[i];
    if (v.w != 0 && (v.x != 0 || v.y != 0 || v.z != 0)) {
      return false;  // driven, however slowly
    }
  }
  return state.rested[group] >= rule_.steps &&
         forEachEntry(group, state.contacts, [&](std::size_t, std::uint32_t, std::size_t j) {
           return state.rested[j / kGroup] >= rule_.steps;
         });
}

void Wakefulness::sleep(std::size_t group, const StepState& step) noexcept {
  HAPTO_ASSERT(rule_.sleep);
  HAPTO_ASSERT(!step.state.asleep(group));
  BedState& state = step.state;
  for (std::size_t i = group * kGroup; i < (group + 1) * kGroup; ++i) {
    const Float4& v = state.velocity[i];
    state.velocity[i] = {v.x * 0, v.y * 0, v.z * 0, v.w};  // the sign of a zero stays
    step.next_velocity[i] = state.velocity[i];
    step.next_position[i] = state.position[i];
  }
  ContactLists& lists = state.contacts;
  if (lists.remembers()) {
    forEachEntry(group, lists, [&](std::size_t i, std::uint32_t s, std::size_t j) {
      if (state.asleep(j / kGroup)) {
        if (const std::uint32_t back = lists.find(j, static_cast<std::int32_t>(i)); back < lists.count(j)) {
          lists.setSlip(j, back, opposite(lists.slip(i, s)));
        }
      }
      return true;
    });
  }
  state.rested[group] = BedState::kAsleep;
  noteAwake(group, false);
}

void Wakefulness::listAwake() noexcept {
  if (!changed_) {
    return;
  }
  changed_ = false;
  awake_count_ = 0;
  for (std::size_t word = 0; word < awake_bits_.size(); ++word) {
    for (std::uint64_t bits = awake_bits_[word]; bits != 0; bits &= bits - 1) {
      awake_[awake_count_++] = order_[word * kBits + static_cast<std::size_t>(std::countr_zero(bits))];
    }
  }
  awake_[awake_count_] = static_cast<std::uint32_t>(moving_.size());
}

void Wakefulness::takeOver(BedState& state) noexcept {
  // It may come from a bed in which rest takes another time: no group sleeps next to one that is not at rest here.
  for (std::size_t group = 0; group < moving_.size(); ++group) {
    std::uint16_t& rested = state.rested[group];
    rested = state.asleep(group) ? rested : std::min<std::uint16_t>(rested, readyToSleep());
    const bool beside_unrest = state.asleep(group) && !forEachEntry(group, state.contacts, [&](auto, auto, auto j) {
                                 return state.rested[j / kGroup] >= rule_.steps;
                               });
    if (!rule_.sleep || beside_unrest) {
      wake(group, state);
    }
  }
  for (std::size_t group = 0; group < moving_.size(); ++group) {
    noteAwake(group, !state.asleep(group));
  }
}

std::size_t Wakefulness::bytes() const noexcept {
  return (awake_.size() + order_.size() + place_in_order_.size() + disturbed_.size() + ready_to_sleep_.size()) *
             sizeof(awake_[0]) +
         awake_bits_.size() * sizeof(awake_bits_[0]) + moving_.size();
}

}  // namespace haptolith

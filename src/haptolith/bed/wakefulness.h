#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/bed/bed_state.h"

namespace haptolith {

/// When soil counts as at rest.
struct RestRule {
  bool sleep = true;        ///< whether groups at rest sleep at all
  float speed_m_s = 0;      ///< a faster particle is not at rest,
  float distance_m = 0;     ///< nor one further from the position where it came to rest,
  std::uint16_t steps = 0;  ///< and rest must have lasted this many steps
};

/// The rule of a bed: `sleep`, `sleep_speed_m_s` and `sleep_distance_m`, for a tenth of a second.
[[nodiscard]] RestRule restRule(const BedParameters& bed);

/// Which groups of particles are worked on.
///
/// A group may sleep when nothing in it and nothing next to it, that is in its neighbour lists, has moved for a
/// while. Its particles are then frozen, and bodies in contact with them get the same forces. It wakes when
/// a neighbour moves, or on request. So between moving and sleeping soil there is always a layer of
/// groups at rest that are still computed, and notice.
///
/// The two sides of a contact each store their slip, exact opposites. A sleeping side is not updated, so it copies the
/// slip of the other when it wakes.
class Wakefulness {
 public:
  /// Steps between two checks of a group's creep. Groups take turns.
  static constexpr std::uint32_t kTurn = 64;

  Wakefulness(std::size_t groups, const RestRule& rule);

  /// Sets the order of processing: the first groups, each number once; later ones keep their places. Affects speed
  /// only.
  void setOrder(const std::vector<std::uint32_t>& order) noexcept;

  /// Awake groups, in that order. One further number after the last is not a group.
  [[nodiscard]] std::span<const std::uint32_t> awake() const noexcept { return {awake_.data(), awake_count_}; }
  [[nodiscard]] const RestRule& rule() const noexcept { return rule_; }
  /// Sets another rule. Sleeping groups stay asleep.
  void setRule(const RestRule& rule) noexcept { rule_ = rule; }

  /// For each group whether something in it moved faster than the rule allows: the step writes it.
  [[nodiscard]] std::uint8_t* moving() noexcept { return moving_.data(); }

  /// Groups whose state changes after a step; the arrays belong to this object.
  struct Transitions {
    std::uint32_t* disturbed = nullptr;       ///< groups that rested and move again
    std::uint32_t* ready_to_sleep = nullptr;  ///< groups that have rested long enough, and whose turn it is
    std::size_t disturbed_count = 0, ready_to_sleep_count = 0;
  };

  /// Updates how long the awake groups first..last-1 have been at rest, from `position` after the step. Several threads
  /// may update different groups at once.
  [[nodiscard]] Transitions updateRest(std::size_t first, std::size_t last, const std::vector<Float4>& position,
                                       BedState& state) noexcept;

  /// Transitions of all parts in ascending order of groups, independent of how the work was divided. Overwrites the
  /// parts' arrays.
  [[nodiscard]] Transitions mergeTransitions(std::span<const Transitions> of_parts) noexcept;

  /// A bed's state, and the arrays that its next step writes: sleeping particles are stored in both.
  struct StepState {
    BedState& state;
    std::vector<Float4>&next_position, &next_velocity;
  };

  /// Wakes the soil next to what moves.
  void wakeBeside(std::span<const std::uint32_t> disturbed, BedState& state) noexcept;
  /// Wakes what is next to one particle, and its own group.
  void wakeAround(std::size_t particle, BedState& state) noexcept;
  void wake(std::size_t group, BedState& state) noexcept;
  void wakeAll(BedState& state) noexcept;

  /// Lets those of the `ready_to_sleep` groups sleep that may, but none that `keep_awake` has a bit for.
  void putToSleep(std::span<const std::uint32_t> ready_to_sleep, const std::vector<std::uint64_t>& keep_awake,
                  const StepState& step) noexcept;

  /// Lists again who is awake, after groups have woken or fallen asleep.
  void listAwake() noexcept;

  /// Continues with another state.
  void takeOver(BedState& state) noexcept;

  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  /// Steps of rest after which a group may sleep: a turn more than makes it one that rests, so that what has just been
  /// woken, or has lost its hold, has the time to begin to move.
  [[nodiscard]] std::uint16_t readyToSleep() const noexcept { return static_cast<std::uint16_t>(rule_.steps + kTurn); }
  [[nodiscard]] bool hasCrept(std::size_t group, const std::vector<Float4>& position, BedState& state) const noexcept;
  [[nodiscard]] bool maySleep(std::size_t group, const BedState& state) const noexcept;
  void sleep(std::size_t group, const StepState& step) noexcept;
  void noteAwake(std::size_t group, bool awake) noexcept;

  RestRule rule_;
  std::vector<std::uint32_t> awake_;
  std::size_t awake_count_;
  std::vector<std::uint32_t> order_, place_in_order_;
  std::vector<std::uint64_t> awake_bits_;  // in that order
  bool changed_ = false;
  std::vector<std::uint8_t> moving_;
  std::vector<std::uint32_t> disturbed_, ready_to_sleep_;
};

}  // namespace haptolith

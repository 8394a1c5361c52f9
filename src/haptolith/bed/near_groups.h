#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "haptolith/bed/neighbourhood.h"

namespace haptolith {

/// Groups of particles near a tool, and those that were near it before: what Bed::groupsNear() knows of one tool.
class NearGroups {
 public:
  NearGroups() = default;
  explicit NearGroups(std::size_t groups) : now_(groups / kBits + 1), before_(now_) { listed_.reserve(groups); }

  /// Those near and those near before, in ascending order.
  [[nodiscard]] const std::vector<std::uint32_t>& listed() const noexcept { return listed_; }
  /// A bit for each group that is near.
  [[nodiscard]] const std::vector<std::uint64_t>& bits() const noexcept { return before_; }

  /// Finds the groups of particles in a place, unless it is the one of the call before.
  void find(const Neighbourhood::Place& place, const Neighbourhood& neighbourhood) noexcept {
    if (place_ != place) {
      std::ranges::fill(now_, std::uint64_t{0});
      neighbourhood.forEachIn(place,
                              [&](std::int32_t particle) { note(now_, static_cast<std::size_t>(particle) / kGroup); });
      list();
      now_.swap(before_);
      place_ = place;
      now_is_before_ = false;
    } else if (!now_is_before_) {  // as most often, in several substeps of a tick
      now_ = before_;
      list();
      now_is_before_ = true;
    }
  }

  /// Those that are near, to be saved.
  [[nodiscard]] std::vector<std::uint32_t> save() const {
    std::vector<std::uint32_t> groups;
    forEach(before_, [&](std::uint32_t group) { groups.push_back(group); });
    return groups;
  }
  /// Continues with saved groups, each below the number of groups.
  void restore(const std::vector<std::uint32_t>& groups) noexcept {
    place_.reset();
    std::ranges::fill(before_, std::uint64_t{0});
    for (const std::uint32_t group : groups) {
      note(before_, group);
    }
  }

 private:
  static constexpr std::size_t kBits = 64;  ///< bits per word

  static void note(std::vector<std::uint64_t>& bits, std::size_t group) noexcept {
    bits[group / kBits] |= std::uint64_t{1} << (group % kBits);
  }
  template <class Each>
  static void forEach(const std::vector<std::uint64_t>& words, const Each& each) {
    for (std::size_t word = 0; word < words.size(); ++word) {
      for (std::uint64_t bits = words[word]; bits != 0; bits &= bits - 1) {
        each(static_cast<std::uint32_t>(word * kBits + static_cast<std::size_t>(std::countr_zero(bits))));
      }
    }
  }
  void list() noexcept {
    listed_.clear();
    for (std::size_t word = 0; word < now_.size(); ++word) {
      for (std::uint64_t bits = now_[word] | before_[word]; bits != 0; bits &= bits - 1) {
        listed_.push_back(static_cast<std::uint32_t>(word * kBits + static_cast<std::size_t>(std::countr_zero(bits))));
      }
    }
  }

  std::vector<std::uint64_t> now_, before_;
  std::vector<std::uint32_t> listed_;
  std::optional<Neighbourhood::Place> place_;  ///< whose groups before_ has; none: what was restored
  bool now_is_before_ = false;
};

}  // namespace haptolith

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "haptolith/core/platform/cache_aligned.h"

namespace haptolith {

/// Particles go through the kernel in groups of this many, side by side: one AVX-512 vector, two of AVX2, four of SSE4
/// or NEON.
constexpr std::size_t kGroup = 16;

/// Records of particles come in whole groups; at least one more than there are particles, so that index n is a ghost.
[[nodiscard]] constexpr std::size_t paddedCount(std::size_t particles) noexcept {
  return (particles / kGroup + 1) * kGroup;
}

/// Slip of a particle against a neighbour since contact began, in m, scene frame.
struct Slip {
  float x = 0, y = 0, z = 0;
};

/// Numbers of rows for each quarter of a group: vectors of 4, 8 and 16 particles cover one, two and four of them.
using QuarterRows = std::array<std::uint16_t, kGroup / 4>;

/// Inner list of a group (dynamic pruning): the rows that can come into contact before the next pruning pass, and the
/// pass that found them. See Bed.
struct InnerRows {
  std::uint64_t pruning_pass = 0;  ///< 0: out of date, the lists of the group have changed
  QuarterRows rows{};
};

/// Neighbour (Verlet) lists of all particles, and the slip of each contact.
///
/// The lists of a group's 16 particles stand side by side in rows: row s holds the s-th neighbour of each, so that the
/// kernel works on 16 pairs at once and adds up without turning registers. Shorter lists are filled up with the ghost
/// (index n), which no force reaches. Rows lie in one pool, a group's in one piece with room to grow; a group that
/// outgrows its room moves. Within what the constructor reserved nothing allocates.
class ContactLists {
 public:
  /// A particle with more neighbours has been collapsed onto. Particles of one size have fewer than 96; a particle has
  /// room for about 240 neighbours of a quarter of its radius.
  static constexpr std::uint32_t kMostNeighbours = 320;

  ContactLists() = default;
  /// Empty lists. @param remembers  whether there is a slip with each entry (contact friction).
  ContactLists(std::size_t particles, bool remembers);

  [[nodiscard]] std::size_t particles() const noexcept { return count_.size(); }
  [[nodiscard]] bool remembers() const noexcept { return remembers_; }
  [[nodiscard]] std::uint32_t count(std::size_t i) const noexcept { return count_[i]; }
  [[nodiscard]] std::int32_t neighbour(std::size_t i, std::uint32_t s) const noexcept {
    return static_cast<std::int32_t>(other_[slot(i, s)] / kRecordBytes);
  }
  [[nodiscard]] Slip slip(std::size_t i, std::uint32_t s) const noexcept;
  /// Entry s of i's list becomes j; what is remembered there stays.
  void set(std::size_t i, std::uint32_t s, std::int32_t j) noexcept {
    other_[slot(i, s)] = offsetOf(j);
    near_[i / kGroup].pruning_pass = 0;
  }
  void setSlip(std::size_t i, std::uint32_t s, const Slip& slip) noexcept;

  /// Adds j to i's list, with nothing to remember. False when it does not fit.
  [[nodiscard]] bool add(std::size_t i, std::int32_t j) noexcept;
  /// Takes entry s from i's list; the last takes its place.
  void remove(std::size_t i, std::uint32_t s) noexcept;
  /// The entry of i's list that is j; count(i) if j is not there, which an assert catches: lists are symmetric.
  [[nodiscard]] std::uint32_t find(std::size_t i, std::int32_t j) const noexcept;
  /// Removes j from i's list, where it must be; an assert catches that it is not.
  void removeNeighbour(std::size_t i, std::int32_t j) noexcept;
  /// Takes everything from all lists.
  void clear() noexcept;

  /// Becomes what another one of as many particles is, entry by entry, within its own storage.
  void takeOver(const ContactLists& other) noexcept;

  // Layout of the kernel: group g has the rows firstRow(g) to firstRow(g) + rows(g) - 1 of 16 entries each.
  // An entry is the offset of its neighbour's record, in bytes: the kernel adds it to an address.
  [[nodiscard]] const std::uint32_t* others() const noexcept { return other_.data(); }
  [[nodiscard]] float* slips() noexcept { return slip_.data(); }  ///< per row 16 x, 16 y, 16 z
  [[nodiscard]] const float* slips() const noexcept { return slip_.data(); }
  [[nodiscard]] const std::uint32_t* firstRows() const noexcept { return first_row_.data(); }
  [[nodiscard]] const std::uint16_t* rowCounts() const noexcept { return rows_.data(); }
  /// Number of rows of each group that may hold slip; rows after them are zero. Code that writes slips() maintains it.
  [[nodiscard]] QuarterRows* touchedRows() noexcept { return touched_.data(); }
  /// Inner rows of each group; not part of the saved state. The step maintains it.
  [[nodiscard]] InnerRows* innerRows() noexcept { return near_.data(); }
  [[nodiscard]] std::size_t groups() const noexcept { return rows_.size(); }

  /// Bytes in use.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  static constexpr std::array<std::uint16_t, 5> kRooms{24, 32, 48, 96, kMostNeighbours};
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::uint32_t kRecordBytes = 16;  // sizeof(Float4)
  [[nodiscard]] static std::uint32_t offsetOf(std::int32_t particle) noexcept {
    return static_cast<std::uint32_t>(particle) * kRecordBytes;
  }

  [[nodiscard]] std::size_t slot(std::size_t i, std::uint32_t s) const noexcept {
    return (first_row_[i / kGroup] + s) * kGroup + i % kGroup;
  }
  [[nodiscard]] float* slipAt(std::size_t i, std::uint32_t s) noexcept {
    return slip_.data() + (first_row_[i / kGroup] + s) * std::size_t{3 * kGroup} + i % kGroup;
  }
  [[nodiscard]] std::uint32_t takeRows(std::size_t room_class) noexcept;
  [[nodiscard]] bool grow(std::size_t group) noexcept;
  void emptyRow(std::size_t row) noexcept;

  bool remembers_ = false;
  std::uint32_t ghost_ = 0;
  std::vector<std::uint32_t, CacheAligned<std::uint32_t>> other_;
  FloatArray slip_;
  std::vector<std::uint32_t> first_row_;  // one for each group
  std::vector<std::uint16_t> rows_;       // length of the group's longest list
  std::vector<QuarterRows> touched_;
  std::vector<InnerRows> near_;
  std::vector<std::uint8_t> room_;    // which of kRooms it has
  std::vector<std::uint16_t> count_;  // one for each particle
  std::array<std::uint32_t, kRooms.size()> free_{kNone, kNone, kNone, kNone,
                                                 kNone};  // left rooms, each linked to the next
};

}  // namespace haptolith

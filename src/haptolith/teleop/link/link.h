#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "haptolith/teleop/link/link_parameters.h"

namespace haptolith {

using Packet = std::vector<std::uint8_t>;

/// Counts of packets by result.
struct LinkCounts {
  std::uint64_t sent = 0, arrived = 0;
  std::uint64_t lost = 0;        ///< by chance
  std::uint64_t cut_off = 0;     ///< in outages
  std::uint64_t dropped = 0;     ///< by a full queue
  std::uint64_t duplicated = 0;  ///< arrive once more
  std::uint64_t overtaken = 0;   ///< arrived after one that was sent later

  [[nodiscard]] std::uint64_t onTheWay() const noexcept {
    return sent + duplicated - arrived - lost - cut_off - dropped;
  }
  [[nodiscard]] bool operator==(const LinkCounts&) const = default;
};

/// One direction of a link, in the caller's time: seconds of delay take no time to compute. A packet waits for
/// those before it to be sent at the link's rate, may be lost, and arrives a delay later. Equal calls give equal
/// bits, with one C library. Allocates; not for the tick.
class Link {
 public:
  /// @throws InvalidParameter as validate().
  explicit Link(const LinkParameters& parameters);

  /// Gives it a packet. @param time_s  no earlier than that of any call before: otherwise taken for that.
  void send(double time_s, Packet packet);

  struct Arrival {
    double time_s;
    Packet packet;
  };
  /// The next packet that has arrived by `time_s`; none: no other has.
  [[nodiscard]] std::optional<Arrival> receive(double time_s);
  /// When the next packet arrives, of those that have been sent; none: none is on its way.
  [[nodiscard]] std::optional<double> nextArrival() const noexcept;

  [[nodiscard]] const LinkCounts& counts() const noexcept { return counts_; }
  /// Memory of packets under way, about 100 bytes for each in addition to its own.
  [[nodiscard]] std::size_t bytesOnTheWay() const noexcept { return bytes_on_the_way_; }
  [[nodiscard]] const LinkParameters& parameters() const noexcept { return parameters_; }

 private:
  struct OnItsWay {
    double arrives_s;
    std::uint64_t number;  ///< in the order of sending; of a duplicate the same
    Packet packet;
  };
  /// Orders packets by arrival, and packets that arrive together by sending.
  static bool arrivesLater(const OnItsWay& one, const OnItsWay& other) noexcept;

  [[nodiscard]] double uniform() noexcept;
  [[nodiscard]] double normal() noexcept;
  [[nodiscard]] bool happens(double share) noexcept { return share > 0 && uniform() < share; }
  [[nodiscard]] bool isCutOff(double time_s) const noexcept;
  [[nodiscard]] bool isLost() noexcept;
  [[nodiscard]] double delayAt(double time_s) const noexcept;
  [[nodiscard]] double jitter() noexcept;
  void dispatch(double time_s, double jitter_s, Packet packet);

  LinkParameters parameters_;
  std::mt19937_64 random_;
  double now_s_ = 0;
  std::deque<double> queued_until_s_;  ///< when each of those that wait has been sent, oldest first
  double busy_until_s_ = 0;
  bool bad_ = false;
  double deviate_ = 0;
  bool has_deviate_ = false;
  double last_arrival_s_ = 0;
  std::uint64_t number_ = 0, newest_arrived_ = 0;
  std::size_t bytes_on_the_way_ = 0;
  std::vector<OnItsWay> on_its_way_;  ///< a heap, the next to arrive at its top
  LinkCounts counts_;
};

}  // namespace haptolith

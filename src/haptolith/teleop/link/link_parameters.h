#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"

namespace haptolith {

/// Variation of delays about their mean.
enum class JitterShape {
  kNormal,   ///< jitter_s is the standard deviation
  kUniform,  ///< jitter_s is half the width
  kPareto,   ///< a long tail upwards, of index 3; jitter_s is the standard deviation
};

/// From `start_s` on nothing passes for this duration.
struct Outage {
  double start_s = 0, duration_s = 0;

  [[nodiscard]] bool operator==(const Outage&) const = default;
};

/// From `time_s` on packets take `delay_s`.
struct DelayAt {
  double time_s = 0, delay_s = 0;

  [[nodiscard]] bool operator==(const DelayAt&) const = default;
};

/// One direction of a link, in the words of Linux's netem (tc-netem(8)).
struct LinkParameters {
  double delay_s = 0;                ///< that every packet takes
  std::vector<DelayAt> delays = {};  ///< instead, as it was measured: each until the next, the last for ever
  double jitter_s = 0;
  JitterShape jitter_shape = JitterShape::kNormal;
  /// Correlation of a packet's jitter with that of the one before. Unlike netem's it preserves the distribution: the
  /// deviates are z' = rho z + sqrt(1 - rho^2) n, and their ranks are the jitter's.
  double jitter_correlation = 0;
  bool in_order = true;  ///< one path: what is late holds up what comes behind it; else packets overtake each other

  double loss = 0;  ///< fraction of packets, independent; in addition to bursts
  /// Bursts of loss: the model of Gilbert (1960, Bell Syst. Tech. J. 39:1253) and Elliott (1963, 42:1977). Before each
  /// packet the link turns bad with one probability and good with the other; while bad it loses this share.
  double turns_bad = 0, turns_good = 1, loss_while_bad = 1;
  double duplicate = 0;  ///< share of packets that arrive twice

  double rate_bit_s = 0;     ///< 0: no limit
  int queue_packets = 1000;  ///< that wait to be sent; what comes on top is dropped. Only with a rate
  int overhead_bytes = 28;   ///< that each packet takes on top: IPv4 and UDP
  std::vector<Outage> outages = {};
  std::uint64_t seed = 1;

  [[nodiscard]] bool operator==(const LinkParameters&) const = default;

  /// Share of packets that are lost in the long run, outages and a full queue left out.
  [[nodiscard]] double meanLoss() const noexcept;
};

struct LinkRanges {
  static constexpr Range delay_s{0, 600};  ///< ten minutes: Mars and back
  static constexpr Range jitter_s{0, 60};
  static constexpr Range correlation{0, 0.999};
  static constexpr Range share{0, 1};
  static constexpr Range rate_bit_s{0, 1e12};
  static constexpr Range queue_packets{1, 1e6};
  static constexpr Range overhead_bytes{0, 1000};
  static constexpr Range time_s{0, 1e9};
};

/// @throws InvalidParameter with the key, the value and the valid range: also for times of delays or outages that do
/// not grow, and for a link that turns bad and never good again.
void validate(const LinkParameters& link);

/// Reads measured delays: a table (core/files/table.h) with the columns t_s and delay_s, times growing.
/// Times from 0 to 1e8 s are the link's own; if the first one is outside (seconds since 1970, a clock's
/// milliseconds or nanoseconds), all count from it.
/// @throws InvalidParameter, Failure: as Table and TimeColumn; for delays outside LinkRanges, and for an empty table.
[[nodiscard]] std::vector<DelayAt> readDelays(const std::filesystem::path& path);

}  // namespace haptolith

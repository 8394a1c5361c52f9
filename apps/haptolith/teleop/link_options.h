#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/teleop/link/link_profiles.h"

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// Which link, as the command line says it.
struct LinkOptions {
  std::string profile = "lan";
  std::optional<double> round_trip_s, jitter_ms, loss, burst_loss, rate_kbit_s;
  std::optional<std::uint64_t> seed;
  std::vector<std::string> outage;
  std::string delays_up, delays_down;

  /// All but the round trip and the profile, which commands ask for in their own ways.
  void addTo(CLI::App& command);

  /// @throws InvalidParameter, Failure: as findLinkProfile() and readDelays().
  [[nodiscard]] LinkProfile link() const;
};

}  // namespace haptolith

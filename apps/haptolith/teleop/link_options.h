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

/// Options for the link.
struct LinkOptions {
  std::string profile = "lan";
  std::optional<double> round_trip_s, jitter_ms, loss, burst_loss, rate_kbit_s;
  std::optional<std::uint64_t> seed;
  std::vector<std::string> outage;
  std::string delays_up, delays_down;

  /// Adds all options except the round trip and the profile, which depend on the command.
  void addTo(CLI::App& command);

  /// Returns the link of the options. @throws InvalidParameter, Failure as findLinkProfile() and readDelays().
  [[nodiscard]] LinkProfile link() const;
};

}  // namespace haptolith

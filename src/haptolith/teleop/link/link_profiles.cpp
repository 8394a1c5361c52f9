#include "haptolith/teleop/link/link_profiles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

constexpr double kMbit = 1e6;

/// Both directions equal except for their seeds, half of the round trip each.
LinkProfile alike(std::string name, std::string what, double round_trip_s, LinkParameters direction) {
  direction.delay_s = round_trip_s / 2;
  LinkProfile profile{std::move(name), std::move(what), direction, direction};
  profile.down.seed = direction.seed + 1;
  return profile;
}

/// Round trips and losses of missions: docs/how-to/teleoperate.md has the sources.
std::vector<LinkProfile> makeProfiles() {
  std::vector<LinkProfile> profiles;
  profiles.push_back(alike("lan", "a network in one building", 0.4e-3,
                           {.jitter_s = 0.05e-3, .jitter_shape = JitterShape::kPareto, .rate_bit_s = 100 * kMbit}));
  profiles.push_back(alike("iss-s-band", "direct link to the space station during a pass, as in ROKVISS and KONTUR-2",
                           0.03,
                           {.jitter_s = 5e-3, .jitter_correlation = 0.25, .loss = 0.005, .rate_bit_s = 0.256 * kMbit}));
  profiles.push_back(alike("gateway", "Earth-Moon point L2 or the Gateway to the lunar surface", 0.4,
                           {.jitter_s = 2e-3, .loss = 0.001, .rate_bit_s = 10 * kMbit}));
  profiles.push_back(alike("iss-relay", "relay satellites to the space station, as in ANALOG-1", 0.85,
                           {.jitter_s = 15e-3, .jitter_correlation = 0.5, .loss = 0.01, .rate_bit_s = 4 * kMbit}));
  profiles.push_back(alike("earth-moon", "Earth to the Moon; light needs 2.56 s for the round trip", 2.6,
                           {.jitter_s = 20e-3, .jitter_correlation = 0.5, .loss = 0.002, .rate_bit_s = 1 * kMbit}));
  // Bursts of 20 packets on average, 3 % of all packets.
  const LinkParameters bursty{.jitter_s = 100e-3,
                              .jitter_correlation = 0.9,
                              .turns_bad = 0.05 * 0.03 / 0.97,
                              .turns_good = 0.05,
                              .rate_bit_s = 1 * kMbit};
  profiles.push_back(
      alike("earth-moon-relay", "Earth to the Moon over relays and ground networks, with bursts of loss", 5, bursty));
  LinkParameters broken = bursty;
  broken.outages = {{.start_s = 20, .duration_s = 10}};
  profiles.push_back(
      alike("outage", "earth-moon-relay with an outage of ten seconds, 20 s after its start", 5, broken));
  return profiles;
}

}  // namespace

std::span<const LinkProfile> linkProfiles() {
  static const std::vector<LinkProfile> kProfiles = makeProfiles();
  return kProfiles;
}

const LinkProfile& findLinkProfile(std::string_view name) {
  const std::span<const LinkProfile> profiles = linkProfiles();
  const auto found = std::ranges::find(profiles, name, &LinkProfile::name);
  if (found == profiles.end()) {
    std::vector<std::string> names;
    for (const LinkProfile& profile : profiles) {
      names.push_back(profile.name);
    }
    throw InvalidParameter("profile", inQuotes(name), fmt::format("{}", fmt::join(names, ", ")));
  }
  return *found;
}

}  // namespace haptolith

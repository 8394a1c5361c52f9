#include "teleop/link_options.h"

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

#include "haptolith/core/error.h"

#include "shared/common_options.h"
#include "shared/option_checks.h"

namespace haptolith {

namespace {

constexpr double kMs = 1e-3;
constexpr double kKbit = 1e3;
constexpr double kBurst_packets = 25;  // burst length of --burst-loss

Outage outageFrom(const std::string& text) {
  Outage outage;
  const char* const end = text.data() + text.size();
  const auto start = std::from_chars(text.data(), end, outage.start_s);
  if (start.ec == std::errc() && start.ptr != end && *start.ptr == ',') {
    const auto duration = std::from_chars(start.ptr + 1, end, outage.duration_s);
    if (duration.ec == std::errc() && duration.ptr == end && LinkRanges::time_s.contains(outage.start_s) &&
        LinkRanges::time_s.contains(outage.duration_s)) {
      return outage;
    }
  }
  throw InvalidParameter("--outage", fmt::format("'{}'", text),
                         fmt::format("START_S,DURATION_S, two numbers of 0 to {:g}", LinkRanges::time_s.highest));
}

}  // namespace

void LinkOptions::addTo(CLI::App& command) {
  const auto number = [&](const char* name, std::optional<double>& value, const Range& range, const char* unit,
                          const char* what) {
    command.add_option(name, value, what)->option_text(unit)->check(numberIn(range));
  };
  number("--jitter-ms", jitter_ms, LinkRanges::jitter_s.in(kMs), "MS",
         "Standard deviation of the delay each way [the profile's]");
  number("--loss", loss, LinkRanges::share, "SHARE", "Fraction of packets lost at random, 0 to 1 [the profile's]");
  number("--burst-loss", burst_loss, {0, 0.9}, "SHARE",
         "Fraction of packets lost in bursts of 25 on average, 0 to 0.9 [the profile's]");
  number("--rate-kbit-s", rate_kbit_s, LinkRanges::rate_bit_s.in(kKbit), "KBIT/S",
         "Rate each way; 0: no limit [the profile's]");
  command.add_option("--outage", outage, "Outage of the link; can be repeated")
      ->option_text("START_S,DURATION_S")
      ->allow_extra_args(false);
  command.add_option("--delays-up", delays_up, "Measured delays from operator to robot: t_s,delay_s")
      ->option_text("FILE.csv");
  command.add_option("--delays-down", delays_down, "Measured delays from robot to operator: t_s,delay_s")
      ->option_text("FILE.csv");
  command.add_option("--seed", seed, kSeedHelp)->option_text("N")->check(wholeNumberIn({0, 9e15}));
}

LinkProfile LinkOptions::link() const {
  LinkProfile link = findLinkProfile(profile);
  for (LinkParameters* way : {&link.up, &link.down}) {
    way->delay_s = round_trip_s ? *round_trip_s / 2 : way->delay_s;
    way->jitter_s = jitter_ms ? *jitter_ms * kMs : way->jitter_s;
    way->loss = loss.value_or(way->loss);
    if (burst_loss) {
      way->turns_good = 1 / kBurst_packets;
      way->turns_bad = way->turns_good * *burst_loss / (1 - *burst_loss);
    }
    way->rate_bit_s = rate_kbit_s ? *rate_kbit_s * kKbit : way->rate_bit_s;
    std::ranges::transform(outage, std::back_inserter(way->outages), outageFrom);
    std::ranges::sort(way->outages, {}, &Outage::start_s);
  }
  link.up.seed = seed.value_or(link.up.seed);
  link.down.seed = seed ? *seed + 1 : link.down.seed;
  if (!delays_up.empty()) {
    link.up.delays = readDelays(delays_up);
  }
  if (!delays_down.empty()) {
    link.down.delays = readDelays(delays_down);
  }
  return link;
}

}  // namespace haptolith

#include "haptolith/teleop/link_parameters.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

#include "haptolith/core/number_rows.h"

namespace haptolith {

namespace {

constexpr std::string_view kHeading = "t_s,delay_s";
constexpr TextLimits kLimits{.bytes = std::uintmax_t{64} << 20, .line_bytes = 200, .rows = 2'000'000};

void requireGrowing(const char* key, double before_s, double time_s) {
  if (time_s <= before_s) {
    throw InvalidParameter(key, fmt::format("{:g} s after {:g} s", time_s, before_s), "times that grow");
  }
}

}  // namespace

double LinkParameters::meanLoss() const noexcept {
  const double bad = turns_bad > 0 ? turns_bad / (turns_bad + turns_good) : 0;
  return 1 - (1 - loss) * (1 - bad * loss_while_bad);
}

void validate(const LinkParameters& link) {
  requireInRange("delay_s", link.delay_s, LinkRanges::delay_s);
  double before_s = -1;
  for (const DelayAt& at : link.delays) {
    requireInRange("delays: time_s", at.time_s, LinkRanges::time_s);
    requireInRange("delays: delay_s", at.delay_s, LinkRanges::delay_s);
    requireGrowing("delays: time_s", before_s, at.time_s);
    before_s = at.time_s;
  }
  requireInRange("jitter_s", link.jitter_s, LinkRanges::jitter_s);
  requireInRange("jitter_correlation", link.jitter_correlation, LinkRanges::correlation);
  requireInRange("loss", link.loss, LinkRanges::share);
  requireInRange("turns_bad", link.turns_bad, LinkRanges::share);
  requireInRange("turns_good", link.turns_good, LinkRanges::share);
  requireInRange("loss_while_bad", link.loss_while_bad, LinkRanges::share);
  requireInRange("duplicate", link.duplicate, LinkRanges::share);
  if (link.turns_bad > 0 && link.turns_good == 0) {
    throw InvalidParameter("turns_good", "0", "> 0: else the link is bad for ever once it is");
  }
  requireInRange("rate_bit_s", link.rate_bit_s, LinkRanges::rate_bit_s);
  requireInRange("queue_packets", link.queue_packets, LinkRanges::queue_packets);
  requireInRange("overhead_bytes", link.overhead_bytes, LinkRanges::overhead_bytes);
  double free_s = -1;
  for (const Outage& outage : link.outages) {
    requireInRange("outages: start_s", outage.start_s, LinkRanges::time_s);
    requireInRange("outages: duration_s", outage.duration_s, LinkRanges::time_s);
    requireGrowing("outages: start_s", free_s, outage.start_s);
    free_s = outage.start_s + outage.duration_s;
  }
}

std::vector<DelayAt> readDelays(const std::filesystem::path& path) {
  NumberRows rows(path, kHeading, kLimits);
  std::vector<DelayAt> delays;
  std::array<double, 2> numbers{};
  while (rows.next(numbers)) {
    const auto [time_s, delay_s] = numbers;
    requireInRange(rows.key("t_s"), time_s, LinkRanges::time_s);
    requireInRange(rows.key("delay_s"), delay_s, LinkRanges::delay_s);
    if (!delays.empty() && time_s <= delays.back().time_s) {
      throw InvalidParameter(rows.key("t_s"), fmt::format("{:g}", time_s), "later than the line before");
    }
    delays.push_back({time_s, delay_s});
  }
  if (delays.empty()) {
    throw InvalidParameter(path.string(), "without a delay", "a table of delays");
  }
  return delays;
}

}  // namespace haptolith

#include "haptolith/teleop/link/link_parameters.h"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "haptolith/core/files/table.h"

namespace haptolith {

namespace {

constexpr std::array<std::string_view, 2> kColumns{"t_s", "delay_s"};
constexpr TextLimits kLimits{.bytes = std::uintmax_t{256} << 20, .line_bytes = 4000, .rows = 2'000'000};

/// Three years: times beyond are of a calendar's clock, as those below 0 are of another one than the link's.
constexpr double kLongest_s = 1e8;

void requireGrowing(const char* key, double before_s, double time_s) {
  if (time_s <= before_s) {
    throw InvalidParameter(key, fmt::format("{:g} s after {:g} s", time_s, before_s), "increasing times");
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
    throw InvalidParameter("turns_good", "0", "> 0: otherwise the link never recovers");
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
  Table table(path, {.columns = kColumns, .limits = kLimits});
  const std::vector<Table::Column> columns = table.columns(kColumns);
  TimeColumn time(table, columns[0]);
  std::vector<DelayAt> delays;
  double zero_s = 0;
  while (table.next()) {
    const double time_s = time.read();
    if (delays.empty() && (time_s < 0 || time_s > kLongest_s)) {
      zero_s = time_s;
    }
    if (!LinkRanges::time_s.contains(time_s - zero_s)) {
      throw InvalidParameter(table.key(columns[0]), time_s - zero_s, LinkRanges::time_s);
    }
    delays.push_back({time_s - zero_s, table.number(columns[1], LinkRanges::delay_s)});
  }
  if (delays.empty()) {
    throw InvalidParameter(path.string(), "without delays", "a table of delays");
  }
  return delays;
}

}  // namespace haptolith

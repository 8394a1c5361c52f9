#include "haptolith/teleop/link_parameters.h"

#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "haptolith/core/input_file.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

constexpr std::string_view kHeading = "t_s,delay_s";
constexpr TextLimits kLimits{.bytes = std::uintmax_t{64} << 20, .line_bytes = 200, .rows = 2'000'000};

void requireGrowing(const char* key, double before_s, double time_s) {
  if (time_s <= before_s) {
    throw InvalidParameter(key, fmt::format("{:g} s after {:g} s", time_s, before_s), "times that grow");
  }
}

/// The two numbers of a line; none: it is no such line.
std::optional<DelayAt> delayOf(std::string_view line) {
  DelayAt delay;
  const char* const end = line.data() + line.size();
  const auto [comma, wrong] = std::from_chars(line.data(), end, delay.time_s);
  if (wrong != std::errc{} || comma == end || *comma != ',') {
    return std::nullopt;
  }
  const auto [rest, also_wrong] = std::from_chars(comma + 1, end, delay.delay_s);
  return also_wrong == std::errc{} && rest == end ? std::optional(delay) : std::nullopt;
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
  std::ifstream file = openInput(path, kLimits.bytes);
  LineReader lines(file, path.string(), kLimits);
  std::vector<DelayAt> delays;
  std::string line;
  while (lines.next(line)) {
    if (line.ends_with('\r')) {
      line.pop_back();
    }
    const auto refuse = [&](std::string_view valid) {
      return InvalidParameter(fmt::format("{}:{}", path.string(), lines.number()), inQuotes(line), std::string(valid));
    };
    if (lines.number() == 1) {
      if (line != kHeading) {
        throw refuse(fmt::format("the heading {}", kHeading));
      }
      continue;
    }
    const std::optional<DelayAt> delay = delayOf(line);
    if (!delay || !LinkRanges::time_s.contains(delay->time_s) || !LinkRanges::delay_s.contains(delay->delay_s)) {
      throw refuse(fmt::format("a time, {} s, a comma, and a delay, {} s", LinkRanges::time_s.text(),
                               LinkRanges::delay_s.text()));
    }
    if (!delays.empty() && delay->time_s <= delays.back().time_s) {
      throw refuse("later than the line before");
    }
    delays.push_back(*delay);
    if (delays.size() > static_cast<std::size_t>(kLimits.rows)) {
      throw refuse(fmt::format("one of {} rows at most", kLimits.rows));
    }
  }
  if (delays.empty()) {
    throw InvalidParameter(path.string(), "without a delay", "a table of delays");
  }
  return delays;
}

}  // namespace haptolith

#include "haptolith/machine/machine_summary.h"

#include <gmock/gmock.h>

#include "haptolith/machine/real_time_checks.h"

namespace haptolith {
namespace {

using testing::StartsWith;

WakeUps measuredWith(int in_time, int missed) {
  WakeUps measured;
  measured.real_time = {.scheduler = "SCHED_FIFO", .memory_locked = true};
  for (int i = 0; i < in_time; ++i) {
    measured.late_us.add(20);
  }
  for (int i = 0; i < missed; ++i) {
    measured.late_us.add(2000);
  }
  measured.missed = static_cast<std::uint64_t>(missed);
  return measured;
}

constexpr FinestSoil kSoil{.radius_m = 4.5e-3, .particles = 1098, .threads = 2, .tick_us_p99 = 520};

std::string changeFor(const std::vector<Check>& checks, const FinestSoil& soil = kSoil) {
  return machineSummary(checks, measuredWith(1000, 0), soil).back().text;
}

TEST(MachineSummary, IsFiveLines) {
  const std::vector<Check> checks{{.name = kCpuCheck, .found = "2 for this process"}};
  const std::vector<SummaryLine> lines = machineSummary(checks, measuredWith(993, 7), kSoil);
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0].name, "finest soil");
  EXPECT_EQ(lines[0].text, "R = 4.5 mm (about 1098 particles, 2 threads): 99 % of ticks within 520 us");
  EXPECT_EQ(lines[1].text, "2 for this process");
  EXPECT_EQ(lines[2].text, "SCHED_FIFO, memory locked");
  EXPECT_THAT(lines[3].text, StartsWith("0.7 % a tick late or more, and no loop here misses fewer ticks; 99.9 % "));
  EXPECT_EQ(lines[4].text, "nothing");
}

TEST(MachineSummary, NamesTheWorstThatCanBeChanged) {
  const Check better{.name = "kernel", .verdict = Fitness::kImprovable, .remedy = "another kernel"};
  const Check other{.name = "CPU governor", .verdict = Fitness::kImprovable, .remedy = "performance"};
  const Check lacking{.name = "scheduler", .verdict = Fitness::kInsufficient, .remedy = "a priority"};
  const Check wake_up{.name = kWakeUpCheck, .verdict = Fitness::kInsufficient, .remedy = "fix the points above"};
  EXPECT_EQ(changeFor({better, other}), "kernel: another kernel");
  EXPECT_EQ(changeFor({better, lacking, wake_up}), "scheduler: a priority");
  EXPECT_EQ(changeFor({better, wake_up}), "kernel: another kernel") << "late wake-ups follow from the others";
  EXPECT_EQ(changeFor({wake_up}), "wake-up: fix the points above");
  FinestSoil slow = kSoil;
  slow.in_time = false;
  EXPECT_EQ(changeFor({}, slow), "a smaller box, or a machine with more or faster cores");
}

TEST(MachineSummary, SaysWhatIsNotKnown) {
  EXPECT_EQ(machineSummary({}, {}, std::nullopt)[0].text, "not measured: interrupted");
  EXPECT_EQ(machineSummary({}, {}, std::nullopt)[3].text, "not measured: interrupted");
  FinestSoil slow = kSoil;
  slow.in_time = false;
  EXPECT_EQ(machineSummary({}, {}, slow)[0].text,
            "none; even R = 4.5 mm (about 1098 particles, 2 threads) is too slow");
}

}  // namespace
}  // namespace haptolith

#include "haptolith/haptics/loop/loop_statistics.h"

#include <algorithm>

namespace haptolith {

void LoopStatistics::add(double tick_us, Miss miss, const Wrench& felt) noexcept {
  missed_lately_[ticks() % kWindow] = miss != Miss::kNone;
  ++by_cause_[static_cast<std::size_t>(miss)];
  tick_us_.add(tick_us);
  force_n_.add(felt.force_n.norm());
  torque_nm_.add(felt.torque_nm.norm());
}

double LoopStatistics::successRate() const noexcept {
  const auto window = static_cast<double>(std::min<std::uint64_t>(ticks(), kWindow));
  return window == 0 ? 1 : 1 - static_cast<double>(missed_lately_.count()) / window;
}

}  // namespace haptolith

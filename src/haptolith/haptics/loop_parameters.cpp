#include "haptolith/haptics/loop_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const LoopParameters& loop) {
  requireInRange("tick_s", loop.tick_s, LoopRanges::tick_s);
  requireInRange("duration_s", loop.duration_s, LoopRanges::duration_s);
  requireInRange("filter_cutoff_hz", loop.filter_cutoff_hz, {LoopRanges::filter_cutoff_hz.lowest, 0.5 / loop.tick_s});
  requireInRange("cpu", loop.cpu, LoopRanges::cpu);
}

}  // namespace haptolith

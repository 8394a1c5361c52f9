#include "haptolith/haptics/loop_parameters.h"

#include "haptolith/core/error.h"

namespace haptolith {

void validate(const LoopParameters& loop) {
  requireInRange("tick_s", loop.tick_s, {1e-4, 0.1});
  requireInRange("duration_s", loop.duration_s, {0, 1e7});
  requireInRange("filter_cutoff_hz", loop.filter_cutoff_hz, {0.1, 0.5 / loop.tick_s});
  requireInRange("cpu", loop.cpu, {kAnyCpu, 1023});  // whether there is such a one: requireUsableCpu()
}

}  // namespace haptolith

#pragma once

#include <haptolith/haptolith.h>

#include "haptolith/haptics/tick_record.h"

namespace haptolith::library {

/// A tick as the C interface tells it, and back: every number stays as it is.
[[nodiscard]] hapto_tick tickOf(const TickRecord& record) noexcept;
[[nodiscard]] TickRecord recordOf(const hapto_tick& tick) noexcept;

}  // namespace haptolith::library

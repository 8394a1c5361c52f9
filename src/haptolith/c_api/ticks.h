#pragma once

#include <haptolith/haptolith.h>

#include "haptolith/haptics/tick_record.h"

namespace haptolith::library {

/// Converts a tick to the C interface, and back, without changing a number.
[[nodiscard]] hapto_tick tickOf(const TickRecord& record) noexcept;
[[nodiscard]] TickRecord recordOf(const hapto_tick& tick) noexcept;

}  // namespace haptolith::library

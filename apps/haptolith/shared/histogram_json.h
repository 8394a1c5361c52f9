#pragma once

#include <nlohmann/json_fwd.hpp>

#include "haptolith/core/histogram.h"

namespace haptolith {

/// Mean, percentiles and maximum, for --json.
[[nodiscard]] nlohmann::ordered_json histogramJson(const Histogram& histogram);

/// The same and how the values are spread, for drawing: count[i] of them lie up to upper_end[i], above the one before.
/// Four buckets to an octave.
[[nodiscard]] nlohmann::ordered_json histogramJsonWithBuckets(const Histogram& histogram);

}  // namespace haptolith

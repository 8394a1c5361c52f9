#pragma once

#include <nlohmann/json_fwd.hpp>

#include "haptolith/core/histogram.h"

namespace haptolith {

/// Returns mean, percentiles and maximum, for --json.
[[nodiscard]] nlohmann::ordered_json histogramJson(const Histogram& histogram);

/// As above with buckets for drawing: count[i] is the number of values up to upper_end[i] and above upper_end[i - 1].
/// Four buckets per octave.
[[nodiscard]] nlohmann::ordered_json histogramJsonWithBuckets(const Histogram& histogram);

}  // namespace haptolith

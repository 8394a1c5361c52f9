#include "shared/histogram_json.h"

#include <nlohmann/json.hpp>

namespace haptolith {

namespace {
using Json = nlohmann::ordered_json;
}

Json histogramJson(const Histogram& h) {
  return {{"mean", h.mean()},
          {"p50", h.percentile(0.5)},
          {"p99", h.percentile(0.99)},
          {"p99_9", h.percentile(0.999)},
          {"max", h.max()}};
}

Json histogramJsonWithBuckets(const Histogram& h) {
  constexpr std::size_t kMerged = 16;  // buckets merged into one, out of 64 per octave
  Json upper_end = Json::array();
  Json count = Json::array();
  std::uint64_t seen = 0;
  for (std::size_t first = 0; first < Histogram::kBuckets && seen < h.count(); first += kMerged) {
    std::uint64_t here = 0;
    for (std::size_t bucket = first; bucket < first + kMerged; ++bucket) {
      here += h.inBucket(bucket);
    }
    if (here > 0 || seen > 0) {
      upper_end.push_back(h.upperEnd(first + kMerged - 1));
      count.push_back(here);
    }
    seen += here;
  }
  Json json = histogramJson(h);
  json["buckets"] = {{"upper_end", upper_end}, {"count", count}};
  return json;
}

}  // namespace haptolith

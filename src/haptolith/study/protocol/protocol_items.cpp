#include "haptolith/study/protocol/protocol_items.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "haptolith/study/protocol/protocol_keys.h"

namespace haptolith {

namespace {

void requireCutPoints(const FormItem& item) {
  const std::vector<double>& cuts = item.cut_points;
  if (!cuts.empty() && item.kind != FormItem::Kind::kNumber && item.kind != FormItem::Kind::kScale) {
    throw InvalidParameter("cut_points", "", "left out: only numbers and scales have them");
  }
  if (std::ranges::adjacent_find(cuts, std::greater_equal()) != cuts.end()) {
    throw InvalidParameter("cut_points", "", "numbers in ascending order, each once");
  }
  if (!cuts.empty() && item.low < item.high && (cuts.front() <= item.low || cuts.back() > item.high)) {
    throw InvalidParameter("cut_points", "", fmt::format("> low, {}, and <= high, {}", item.low, item.high));
  }
}

void requireWholeItem(const FormItem& item) {
  const bool is_scale = item.kind == FormItem::Kind::kScale;
  if (item.kind == FormItem::Kind::kChoice && item.choices.size() < 2) {
    throw InvalidParameter("choices", "", "at least two texts");
  }
  if (item.kind != FormItem::Kind::kChoice && !item.choices.empty()) {
    throw InvalidParameter("choices", "", "left out: only `kind = \"choice\"` has them");
  }
  if (item.low > item.high || (is_scale && item.low == item.high)) {
    throw InvalidParameter("high", fmt::format("{}", item.high), fmt::format("> low, {}", item.low));
  }
  requireCutPoints(item);
}

}  // namespace

std::vector<FormItem> readItems(const TomlReader& reader, std::string_view name) {
  std::vector<FormItem> items;
  for (const TomlReader& part : reader.parts(name)) {
    part.refuseUnknownKeys(keyNames(itemKeys()));
    FormItem item;
    for (const ItemKey& key : itemKeys()) {
      part.apply(key, item);
    }
    part.require("", "key");
    part.require("", "label");
    part.check(itemKeys(), "", [&] { requireWholeItem(item); });
    if (std::ranges::find(items, item.key, &FormItem::key) != items.end()) {
      part.refuseKey({"", "key"}, "another one: an item above has it");
    }
    items.push_back(std::move(item));
  }
  return items;
}

std::vector<FormItem> withTaskLoadIndex(bool wanted, std::vector<FormItem> items) {
  if (wanted) {
    const std::span<const FormItem> index = nasaTaskLoadIndex();
    items.insert(items.begin(), index.begin(), index.end());
  }
  return items;
}

std::span<const FormItem> nasaTaskLoadIndex() {
  const auto scale = [](const char* key, const char* label, const char* low, const char* high) {
    return FormItem{.key = key,
                    .label = label,
                    .kind = FormItem::Kind::kScale,
                    .low = 0,
                    .high = 100,
                    .low_label = low,
                    .high_label = high,
                    .required = true};
  };
  static const std::vector<FormItem> kScales{
      scale("tlx_mental_demand", "Mental demand: how much thinking, deciding and remembering did it take?", "very low",
            "very high"),
      scale("tlx_physical_demand", "Physical demand: how much bodily effort did it take?", "very low", "very high"),
      scale("tlx_temporal_demand", "Temporal demand: how hurried did you feel?", "very low", "very high"),
      scale("tlx_performance", "Performance: how well do you think you did?", "perfect", "failure"),
      scale("tlx_effort", "Effort: how hard did you have to work to do that well?", "very low", "very high"),
      scale("tlx_frustration", "Frustration: how annoyed, stressed or discouraged were you?", "very low", "very high"),
  };
  return kScales;
}

}  // namespace haptolith

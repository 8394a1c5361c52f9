#include "haptolith/study/protocol/form.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/toml/file_keys.h"

namespace haptolith {

namespace {

constexpr std::size_t kLongestText = 10000;  // characters; longer text is not a plausible answer

bool isNumberOf(const FormItem& item, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return false;
  }
  return item.low == item.high || (item.low <= value && value <= item.high);
}

bool allows(const FormItem& item, std::string_view text) {
  switch (item.kind) {
    case FormItem::Kind::kText: return text.size() <= kLongestText;
    case FormItem::Kind::kNumber:
    case FormItem::Kind::kScale: return isNumberOf(item, text);
    case FormItem::Kind::kChoice: return std::ranges::find(item.choices, text) != item.choices.end();
    case FormItem::Kind::kYesNo: return text == "yes" || text == "no";
  }
  return false;
}

}  // namespace

std::string validText(const FormItem& item) {
  switch (item.kind) {
    case FormItem::Kind::kText: return fmt::format("text of at most {} letters", kLongestText);
    case FormItem::Kind::kNumber:
    case FormItem::Kind::kScale:
      return item.low == item.high ? "a number" : fmt::format("a number, {} to {}", item.low, item.high);
    case FormItem::Kind::kChoice: return anyOf({item.choices.begin(), item.choices.end()});
    case FormItem::Kind::kYesNo: return "yes or no";
  }
  return "";
}

std::vector<Form> formsOf(const StudyProtocol& protocol) {
  std::vector<Form> forms;
  forms.push_back({std::string(kDemographicsForm), protocol.demographics});
  for (const StudyBlock& block : protocol.blocks) {
    forms.push_back({block.name, block.questionnaire});
  }
  forms.push_back({std::string(kQuestionnaireForm), protocol.questionnaire});
  std::erase_if(forms, [](const Form& form) { return form.items.empty(); });
  return forms;
}

void requireFormValues(const std::vector<FormItem>& items, const std::map<std::string, std::string>& values) {
  for (const auto& [key, value] : values) {
    const auto item = std::ranges::find(items, key, &FormItem::key);
    if (item == items.end()) {
      throw InvalidParameter(key, fmt::format("'{}'", value), "left out: the form does not have this item");
    }
    if (!value.empty() && !allows(*item, value)) {
      throw InvalidParameter(key, fmt::format("'{}'", value), validText(*item));
    }
  }
  for (const FormItem& item : items) {
    const auto value = values.find(item.key);
    if (item.required && (value == values.end() || value->second.empty())) {
      throw InvalidParameter(item.key, "''", validText(item));
    }
  }
}

}  // namespace haptolith

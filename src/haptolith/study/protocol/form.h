#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Checks the values of a form; an empty value is a missing one.
/// @throws InvalidParameter for an unknown item, a value that the item does not allow, and a missing required value.
void requireFormValues(const std::vector<FormItem>& items, const std::map<std::string, std::string>& values);

/// Form of a study: its name in the store, and its items.
struct Form {
  std::string name;
  std::vector<FormItem> items;
};

/// Returns the forms with items: "demographics"; the name of each block, for the questionnaire after it;
/// "questionnaire".
[[nodiscard]] std::vector<Form> formsOf(const StudyProtocol& protocol);

inline constexpr std::string_view kDemographicsForm = "demographics";
inline constexpr std::string_view kQuestionnaireForm = "questionnaire";

/// Describes the valid values of an item: "1 to 120", "left, right or both", "yes or no", "text".
[[nodiscard]] std::string validText(const FormItem& item);

}  // namespace haptolith

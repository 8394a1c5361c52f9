#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/protocol/protocol.h"

namespace haptolith {

/// Checks what somebody has filled in; an empty value is one that is left out.
/// @throws InvalidParameter for a value whose item does not exist or does not allow it, and for a missing one that is
/// required.
void requireFormValues(const std::vector<FormItem>& items, const std::map<std::string, std::string>& values);

/// A form of a study: what the store calls it, and its items.
struct Form {
  std::string name;
  std::vector<FormItem> items;
};

/// "demographics"; the name of each block, for the questionnaire after it; "questionnaire". Only those with items.
[[nodiscard]] std::vector<Form> formsOf(const StudyProtocol& protocol);

inline constexpr std::string_view kDemographicsForm = "demographics";
inline constexpr std::string_view kQuestionnaireForm = "questionnaire";

/// What an item allows: "1 to 120", "left, right or both", "yes or no", "text".
[[nodiscard]] std::string validText(const FormItem& item);

}  // namespace haptolith

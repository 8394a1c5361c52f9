#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/lab/apparatus/lab_bed.h"

namespace haptolith {

/// Option of a test, for the command line and the library. The test itself checks the values passed to set().
struct LabOption {
  using Number = std::function<void(double)>;
  using List = std::function<void(const std::vector<double>&)>;
  using Switch = std::function<void()>;  ///< a flag without value
  struct Count {
    Range valid;
    std::function<void(std::int64_t)> set;
  };
  struct Word {
    std::vector<std::string> words;  ///< permitted words; empty: any text
    std::function<void(std::string_view)> set;
  };

  std::string key;    ///< "depth_m"; on the command line --depth-m
  std::string help;   ///< help text without the default
  std::string usual;  ///< default as text; may be empty
  std::variant<Number, List, Switch, Count, Word> set;
};

// Options that set a value, which has to outlive them; its current content is the default.
[[nodiscard]] LabOption numberOption(std::string key, double& value, std::string help);
[[nodiscard]] LabOption millimetresOption(std::string key, double& length_m, std::string help);
[[nodiscard]] LabOption degreesOption(std::string key, double& angle_rad, std::string help);
[[nodiscard]] LabOption countOption(std::string key, int& value, const Range& valid, std::string help);
/// @param unit  unit in which the list is given.
[[nodiscard]] LabOption listOption(std::string key, std::vector<double>& values, double unit, std::string help);
[[nodiscard]] LabOption seedOption(std::string key, std::uint64_t& seed, const Range& valid, std::string help);
[[nodiscard]] LabOption textOption(std::string key, std::string& text, std::string help);
/// Returns an option with one of several words.
[[nodiscard]] LabOption wordOption(std::string key, std::vector<std::string> words, std::string usual,
                                   std::function<void(std::string_view)> set, std::string help);
[[nodiscard]] LabOption preparationOption(Preparation& preparation);
[[nodiscard]] std::string_view preparationWord(Preparation preparation);
[[nodiscard]] LabOption depthFromOption(DepthFrom& from);

}  // namespace haptolith

#include "lab/specimens.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/input_file.h"
#include "haptolith/core/former_names.h"
#include "haptolith/lab/archive/json_differences.h"
#include "haptolith/lab/archive/report_results.h"
#include "haptolith/lab/report/specimen_statistics.h"
#include "haptolith/scene_file/scene_words.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{16} << 20;
/// Members of a specimen's JSON that are conditions. All others except seed and findings are results.
constexpr std::array kConditions{"program",   "test",          "soil",      "friction", "body",   "gravity_m_s2",
                                 "radius_mm", "stiffness_n_m", "soil_keys", "target",   "options"};
/// Max. length of an array in a table; longer arrays are curves, which only the JSON contains.
constexpr std::size_t kMostInTable = 12;

// --- one specimen ----------------------------------------------------------------------------------------------------

[[noreturn]] void refuse(const std::string& path, std::string_view why) {
  throw Failure(fmt::format("{} {}", path, why));
}

/// Whether all members exist with the right type.
bool isWhole(const Json& json) {
  try {
    for (const char* condition : kConditions) {
      static_cast<void>(json.at(condition));
    }
    for (const Json& finding : json.at("findings")) {
      static_cast<void>(findingFrom(finding));
    }
    return json.at("seed").is_number_unsigned() && json.at("test").is_string() && json.at("soil").is_string() &&
           json.at("program").is_string() && json.at("friction").is_string() && json.at("body").is_string() &&
           json.at("radius_mm").is_number() && json.at("findings").is_array();
  } catch (const Json::exception&) {
    return false;
  }
}

// --- all of them -----------------------------------------------------------------------------------------------------

template <class Matches>
bool allOf(const std::vector<Json>& values, const Matches& matches) {
  return std::ranges::all_of(values, matches);
}

double numberOf(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> numbersOf(const std::vector<Json>& values) {
  std::vector<double> numbers;
  std::ranges::transform(values, std::back_inserter(numbers), numberOf);
  return numbers;
}

/// Whether all values are numbers or null, with at least one number.
bool areNumbers(const std::vector<Json>& values) {
  return allOf(values, [](const Json& value) { return value.is_number() || value.is_null(); }) &&
         !allOf(values, [](const Json& value) { return value.is_null(); });
}

bool areAlike(const std::vector<Json>& values, const auto& is_kind) {
  return allOf(values, [&](const Json& value) { return is_kind(value) && value.size() == values.front().size(); });
}

std::vector<Json> membersAt(const std::vector<Json>& values, const auto& place) {
  std::vector<Json> members;
  members.reserve(values.size());
  for (const Json& value : values) {
    members.push_back(value.contains(place) ? value.at(place) : Json(nullptr));
  }
  return members;
}

Json jsonOf(const Scatter& scatter) {
  return {{"mean", scatter.mean}, {"sd", scatter.sd}, {"specimens", scatter.specimens}};
}

/// Combines one member of all specimens: mean and SD of numbers, count of true for booleans, and the common value of
/// others. Null if they differ, for example for curves with different numbers of points.
Json overSpecimens(const std::vector<Json>& values) {
  if (areNumbers(values)) {
    return jsonOf(scatterOf(numbersOf(values)));
  }
  if (allOf(values, [](const Json& value) { return value.is_boolean(); })) {
    return {{"yes", std::ranges::count(values, Json(true))}, {"specimens", values.size()}};
  }
  if (areAlike(values, [](const Json& value) { return value.is_object(); })) {
    Json common = Json::object();
    for (const auto& [key, unused] : values.front().items()) {
      common[key] = overSpecimens(membersAt(values, key));
    }
    return common;
  }
  if (areAlike(values, [](const Json& value) { return value.is_array(); })) {
    Json common = Json::array();
    for (std::size_t i = 0; i < values.front().size(); ++i) {
      std::vector<Json> members;
      std::ranges::transform(values, std::back_inserter(members), [i](const Json& value) { return value.at(i); });
      common.push_back(overSpecimens(members));
    }
    return common;
  }
  return allOf(values, [&](const Json& value) { return value == values.front(); }) ? values.front() : Json(nullptr);
}

/// Column of a table: one number of all specimens.
struct Column {
  std::string name;
  std::vector<double> numbers;
};

/// Adds columns for `values` and their members, named by their paths: "points/0/peak_pa".
void addColumns(const std::vector<Json>& values, const std::string& name, std::vector<Column>& columns) {
  const auto below = [&](const std::string& part) { return name.empty() ? part : name + "/" + part; };
  if (areNumbers(values)) {
    columns.push_back({name, numbersOf(values)});
  } else if (allOf(values, [](const Json& value) { return value.is_boolean(); })) {
    std::vector<double> yes;
    std::ranges::transform(values, std::back_inserter(yes),
                           [](const Json& value) { return value.get<bool>() ? 1 : 0; });
    columns.push_back({name, yes});
  } else if (areAlike(values, [](const Json& value) { return value.is_object(); })) {
    for (const auto& [key, unused] : values.front().items()) {
      addColumns(membersAt(values, key), below(key), columns);
    }
  } else if (areAlike(values, [](const Json& value) { return value.is_array() && value.size() <= kMostInTable; })) {
    for (std::size_t i = 0; i < values.front().size(); ++i) {
      std::vector<Json> members;
      std::ranges::transform(values, std::back_inserter(members), [i](const Json& value) { return value.at(i); });
      addColumns(members, below(std::to_string(i)), columns);
    }
  }
}

/// Returns "1 to 40", or "1, 2, 5 to 9".
std::string seedsText(const std::vector<Specimen>& specimens) {
  std::vector<std::string> parts;
  for (std::size_t first = 0; first < specimens.size();) {
    std::size_t last = first;
    while (last + 1 < specimens.size() && specimens[last + 1].seed == specimens[last].seed + 1) {
      ++last;
    }
    parts.push_back(last > first + 1 ? fmt::format("{} to {}", specimens[first].seed, specimens[last].seed)
                    : last > first   ? fmt::format("{}, {}", specimens[first].seed, specimens[last].seed)
                                     : fmt::format("{}", specimens[first].seed));
    first = last + 1;
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

void requireSameConditions(const Specimen& first, const Specimen& other) {
  const auto different = differences(first.conditions(), other.conditions(), "{} is {} there and {} here");
  if (!different.empty()) {
    throw Failure(
        fmt::format("{} is not of the same test as {}: {}", other.file, first.file, fmt::join(different, "; ")));
  }
  const auto kinds = [](const Specimen& specimen) {
    std::vector<std::string> names;
    const Json results = specimen.results();
    for (const auto& [key, unused] : results.items()) {
      names.push_back(key);
    }
    for (const Finding& finding : specimen.findings()) {
      names.push_back(finding.measured);
    }
    std::ranges::sort(names);
    return names;
  };
  if (kinds(first) != kinds(other)) {
    throw Failure(fmt::format("{} has other results than {}: \"{}\" instead of \"{}\"", other.file, first.file,
                              fmt::join(kinds(other), "\", \""), fmt::join(kinds(first), "\", \"")));
  }
}

/// Returns, per finding, the values of all specimens.
std::vector<std::vector<Finding>> findingsOf(const std::vector<Specimen>& specimens) {
  std::vector<std::vector<Finding>> all(specimens.front().findings().size());
  for (const Specimen& specimen : specimens) {
    const std::vector<Finding> of_one = specimen.findings();
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].push_back(of_one[i]);
    }
  }
  return all;
}

/// Returns the command of a test: "lab shear".
std::string labCommand(const std::string& test) {
  return (test == "calibrate" ? "soil " : "lab ") + test;
}

Json summaryOf(const std::vector<Finding>& specimens) {
  std::vector<double> numbers;
  std::ranges::transform(specimens, std::back_inserter(numbers), &Finding::number);
  const Verdict verdict = overSeeds(specimens).verdict.value_or(Verdict::kInfo);
  Json json = jsonOf(specimens.front());
  json.erase("number");
  json.update(jsonOf(scatterOf(numbers)));
  json["passes"] = verdict == Verdict::kInfo ? Json(nullptr) : Json(verdict == Verdict::kPass);
  return json;
}

std::string textOf(const std::vector<std::vector<Finding>>& findings) {
  std::string text;
  for (const std::vector<Finding>& specimens : findings) {
    const Finding& first = specimens.front();
    const ReportValue value = overSeeds(specimens);
    text += fmt::format("  {:<40} {}", first.measured, value.text);
    if (!first.target.empty()) {
      text += fmt::format("; should be {}", first.target);
    }
    text += value.verdict == Verdict::kFail ? ": is not\n" : value.verdict == Verdict::kPass ? ": is\n" : "\n";
  }
  return text.empty() ? text : text + "\n";
}

std::string textOf(const std::vector<Column>& columns) {
  std::size_t width = 0;
  for (const Column& column : columns) {
    width = std::max(width, column.name.size());
  }
  std::string text = fmt::format("  {:<{}}   {:>11}   {:>11}   specimens\n", "", width, "mean", "SD");
  for (const Column& column : columns) {
    const Scatter scatter = scatterOf(column.numbers);
    text += fmt::format("  {:<{}}   {:>11.5g}   {:>11}   {:>9}\n", column.name, width, scatter.mean,
                        scatter.specimens > 1 ? fmt::format("{:.3g}", scatter.sd) : "", scatter.specimens);
  }
  return text;
}

}  // namespace

Json specimenJson(const std::string& test, const LabOptions& options, const LabSoil& soil,
                  const LabConditions& conditions, const LabOutput& output,
                  const std::map<std::string, std::string>& given) {
  Json json{{"test", test}};
  json.update(circumstancesJson(options, soil, conditions));
  json.update(output.json);
  json["findings"] = Json::array();
  for (const Finding& finding : output.findings) {
    json["findings"].push_back(jsonOf(finding));
  }
  json["program"] = "haptolith " HAPTOLITH_VERSION;
  json["options"] = given;
  json["soil_keys"] = soilJson(conditions.soil);
  json["target"] = targetJson(soil.target);
  return Json::parse(json.dump(-1, ' ', false, Json::error_handler_t::replace));  // as after writing and reading
}

Json Specimen::conditions() const {
  Json conditions = Json::object();
  for (const char* name : kConditions) {
    conditions[name] = json.at(name);
  }
  return conditions;
}

Json Specimen::results() const {
  Json results = json;
  for (const char* name : kConditions) {
    results.erase(name);
  }
  results.erase("seed");
  results.erase("findings");
  return results;
}

std::vector<Finding> Specimen::findings() const {
  std::vector<Finding> all;
  for (const Json& finding : json.at("findings")) {
    all.push_back(findingFrom(finding));
  }
  return all;
}

Specimen readSpecimen(const std::string& path) {
  std::ifstream file = openInput(path, kMostBytes);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    refuse(path, "is empty: the test is still running, or it failed; see its standard error");
  }
  Specimen specimen{0, Json::parse(text, nullptr, false), path};
  if (specimen.json.is_discarded()) {
    refuse(path, "is truncated, or is not one result of `haptolith lab TEST --json`");
  }
  if (specimen.json.is_object() && specimen.json.contains("seeds")) {
    refuse(path, "is the result of several specimens: name the file of each specimen");
  }
  if (!isWhole(specimen.json)) {
    refuse(path, "is not a result of `haptolith lab TEST --json`");
  }
  specimen.seed = specimen.json.at("seed").get<std::uint64_t>();
  Json& test = specimen.json.at("test");
  test = std::string(currentName(NameKind::kLabTest, test.get<std::string>()));
  return specimen;
}

Collection collected(std::vector<Specimen> specimens) {
  if (specimens.empty()) {
    throw Failure("no specimen is given");
  }
  for (const Specimen& specimen :
       specimens) {  // compared with the first one in the order of the command line, which the message names first
    requireSameConditions(specimens.front(), specimen);
  }
  std::ranges::stable_sort(specimens, {}, &Specimen::seed);
  if (const auto twice = std::ranges::adjacent_find(specimens, {}, &Specimen::seed); twice != specimens.end()) {
    throw Failure(fmt::format("{} and {} have the same seed {}: use each specimen once", twice->file,
                              std::next(twice)->file, twice->seed));
  }
  std::vector<Json> results;
  Json seeds = Json::array();
  for (const Specimen& specimen : specimens) {
    results.push_back(specimen.results());
    seeds.push_back(specimen.seed);
  }
  const Json& first = specimens.front().json;
  const std::vector<std::vector<Finding>> findings = findingsOf(specimens);
  std::vector<Column> columns;
  addColumns(results, "", columns);

  Collection collection;
  collection.json = specimens.front().conditions();
  collection.json["seeds"] = seeds;
  collection.json["specimens"] = specimens.size();
  collection.json["findings"] = Json::array();
  for (const std::vector<Finding>& finding : findings) {
    collection.json["findings"].push_back(summaryOf(finding));
  }
  collection.json["results"] = overSpecimens(results);
  collection.text =
      fmt::format("{}: {}, {} friction, {}, particles of R = {:.3g} mm; {} specimen{}, seed{} {}\n\n{}{}",
                  labCommand(first.at("test").get<std::string>()), first.at("soil").get<std::string>(),
                  first.at("friction").get<std::string>(), first.at("body").get<std::string>(),
                  first.at("radius_mm").get<double>(), specimens.size(), specimens.size() > 1 ? "s" : "",
                  specimens.size() > 1 ? "s" : "", seedsText(specimens), textOf(findings), textOf(columns));
  collection.columns = {"seed"};
  for (const Column& column : columns) {
    collection.columns.push_back(column.name);
  }
  for (std::size_t i = 0; i < specimens.size(); ++i) {
    collection.rows.push_back({static_cast<double>(specimens[i].seed)});
    for (const Column& column : columns) {
      collection.rows.back().push_back(column.numbers[i]);
    }
  }
  return collection;
}

}  // namespace haptolith

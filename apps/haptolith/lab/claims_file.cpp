#include "lab/claims_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/core/former_names.h"
#include "haptolith/lab/catalogue/lab_test.h"
#include "haptolith/lab/catalogue/option_reader.h"
#include "haptolith/scene_file/toml/file_keys.h"
#include "haptolith/scene_file/toml/toml_reader.h"
#include "haptolith/soil/bodies.h"

#include "lab/built_in_claims.h"

namespace haptolith {

namespace {

constexpr FileKind kClaims{.name = "file of claims",
                           .example_key = "claim",
                           .document = "docs/reference/claims-file.md",
                           .left_out = "left out, so the default"};

using ClaimKey = FileKey<MeasuredClaim>;

ClaimRun& overOf(MeasuredClaim& m) {
  return m.over ? *m.over : m.over.emplace(m.run);
}

ClaimKind claimKindOf(std::string_view word) {
  return word == "calibrated"    ? ClaimKind::kCalibrated
         : word == "consistency" ? ClaimKind::kConsistency
                                 : ClaimKind::kIndependent;
}

std::vector<ClaimKey> claimKeys() {
  using M = MeasuredClaim;
  using Text = ClaimKey::TextValue;
  using Number = ClaimKey::NumberValue;
  using Interval = ClaimKey::IntervalValue;
  constexpr Range kAny{-1e12, 1e12};
  constexpr Range kRadius_mm{0.1, 100};
  constexpr Range kTimes{0.01, 1000};
  return {
      {"", "id", "", Text{[](M& m, std::string_view v) { m.claim.id = v; }, kOnlyRead}, ""},
      {"", "group", "", Text{[](M& m, std::string_view v) { m.claim.group = v; }, kOnlyRead}, ""},
      {"", "kind", "",
       ClaimKey::WordValue{{"independent", "calibrated", "consistency"},
                           [](M& m, std::string_view v) { m.claim.kind = claimKindOf(v); },
                           kOnlyRead},
       ""},
      {"", "claim", "", Text{[](M& m, std::string_view v) { m.claim.claim = v; }, kOnlyRead}, ""},
      {"", "reference", "", Text{[](M& m, std::string_view v) { m.claim.reference = v; }, kOnlyRead, TextSize::kPage},
       ""},
      {"", "note", "", Text{[](M& m, std::string_view v) { m.claim.note = v; }, kOnlyRead, TextSize::kPage}, ""},
      {"", "unit", "", Text{[](M& m, std::string_view v) { m.claim.unit = v; }, kOnlyRead}, ""},
      {"", "ours", "", Text{[](M& m, std::string_view v) { m.ours = v; }, kOnlyRead}, ""},
      {"", "other", "", Text{[](M& m, std::string_view v) { m.other = v; }, kOnlyRead}, ""},
      {"", "expected", "", Number{kAny, [](M& m, double v) { m.claim.expected = v; }, kOnlyRead}, ""},
      {"", "scatter", "", Interval{kAny, [](M& m, const Range& v) { m.claim.scatter = v; }, kOnlyRead}, ""},
      {"", "factor", "factor", Number{{1, 100}, [](M& m, double v) { m.claim.factor = v; }, kOnlyRead}, ""},
      {"", "within", "within", Number{{0, 1}, [](M& m, double v) { m.claim.within = v; }, kOnlyRead}, ""},
      {"", "accepted", "accepted", Interval{kAny, [](M& m, const Range& v) { m.claim.accepted = v; }, kOnlyRead}, ""},
      {"", "any_soil", "", ClaimKey::SwitchValue{[](M& m, bool v) { m.any_soil = v; }, kOnlyRead}, ""},
      {"", "test", "",
       Text{[](M& m, std::string_view v) { m.run.test = currentNameReported(NameKind::kLabTest, v); }, kOnlyRead}, ""},
      {"", "soil", "", Text{[](M& m, std::string_view v) { m.run.soil = v; }, kOnlyRead, TextSize::kPath}, ""},
      {"", "body", "", Text{[](M& m, std::string_view v) { m.run.body = v; }, kOnlyRead}, ""},
      {"", "radius_mm", "", Number{kRadius_mm, [](M& m, double v) { m.run.radius_mm = v; }, kOnlyRead}, ""},
      {"", "stiffness_times", "", Number{kTimes, [](M& m, double v) { m.run.stiffness_times = v; }, kOnlyRead}, ""},
      {"over", "soil", "", Text{[](M& m, std::string_view v) { overOf(m).soil = v; }, kOnlyRead, TextSize::kPath}, ""},
      {"over", "body", "", Text{[](M& m, std::string_view v) { overOf(m).body = v; }, kOnlyRead}, ""},
      {"over", "radius_mm", "", Number{kRadius_mm, [](M& m, double v) { overOf(m).radius_mm = v; }, kOnlyRead}, ""},
      {"over", "stiffness_times", "", Number{kTimes, [](M& m, double v) { overOf(m).stiffness_times = v; }, kOnlyRead},
       ""},
  };
}

/// Reads the options of the claim's test from [claim.options], and the differing ones of the other run from
/// [claim.over_options].
void readRunOptions(const TomlReader& reader, MeasuredClaim& measured) {
  const LabTest test = labTest(measured.run.test);
  const auto read = [&](std::string_view table, const LabOption& option, toml::table& into) {
    if (const toml::node* node = reader.find(table, option.key)) {
      try {
        setOption(option, *node);
      } catch (const InvalidParameter& error) {
        reader.refuseKey({table, option.key}, error.valid());
      }
      into.insert_or_assign(option.key, *node);
    }
  };
  for (const LabOption& option : test.options) {
    read("options", option, measured.run.options);
  }
  if (reader.has("over_options")) {
    overOf(measured);
  }
  if (measured.over) {
    measured.over->options = measured.run.options;
    for (const LabOption& option : test.options) {
      read("over_options", option, measured.over->options);
    }
  }
}

MeasuredClaim claimIn(const TomlReader& reader) {
  const std::vector<ClaimKey> keys = claimKeys();
  MeasuredClaim measured;
  for (const char* needed : {"id", "group", "claim", "test", "soil", "ours"}) {
    reader.require("", needed);
  }
  for (const ClaimKey& key : keys) {
    reader.apply(key, measured);
  }
  std::vector<KeyName> known = keyNames(std::span<const ClaimKey>(keys));
  const LabTest test = labTest(measured.run.test);
  for (const LabOption& option : test.options) {
    known.push_back({"options", option.key});
    known.push_back({"over_options", option.key});
  }
  reader.refuseUnknownKeys(known);
  readRunOptions(reader, measured);
  static_cast<void>(findBody(measured.run.body));
  if (measured.over) {
    static_cast<void>(findBody(measured.over->body));
  }
  if (measured.other.empty() == !measured.claim.expected && !measured.claim.accepted) {
    reader.refuse(reader.line(), "a claim needs either expected, a number, or other, where the test's JSON has one");
  }
  for (const char* place : {"ours", "other"}) {
    const std::string& pointer = place == std::string_view("ours") ? measured.ours : measured.other;
    if (!pointer.empty() && !pointer.starts_with('/')) {
      reader.refuseKey({"", place}, "a place in the test's JSON that begins with /, such as /draft_n");
    }
  }
  try {
    validate(measured.claim);
  } catch (const InvalidParameter& error) {
    reader.refuse(reader.line(), error.what());
  }
  return measured;
}

std::vector<MeasuredClaim> claimsIn(const TomlReader& reader) {
  reader.refuseUnknownKeys(std::vector<KeyName>{{"", "claim"}});
  std::vector<MeasuredClaim> claims;
  std::set<std::string> ids;
  for (const TomlReader& part : reader.parts("claim")) {
    try {
      claims.push_back(claimIn(part));
    } catch (const TomlError&) {
      throw;
    } catch (const InvalidParameter& error) {
      part.refuse(part.line(), error.what());
    }
    if (!ids.insert(claims.back().claim.id).second) {
      part.refuse(part.line(), fmt::format("there is another claim with the id '{}'", claims.back().claim.id));
    }
  }
  if (claims.empty()) {
    reader.refuse(1, "there is no [[claim]] in it");
  }
  return claims;
}

}  // namespace

std::vector<MeasuredClaim> readClaims(const std::filesystem::path& path) {
  std::vector<MeasuredClaim> claims = claimsIn(TomlReader(path, kClaims));
  const auto beside = [&](std::string& soil) {
    if (soil.ends_with(".toml")) {
      soil = (path.parent_path() / soil).string();
    }
  };
  for (MeasuredClaim& measured : claims) {
    beside(measured.run.soil);
    if (measured.over) {
      beside(measured.over->soil);
    }
  }
  return claims;
}

std::vector<MeasuredClaim> shippedClaims() {
  std::vector<MeasuredClaim> claims;
  for (const BuiltInClaims& file : builtInClaims()) {
    std::ranges::move(claimsIn(TomlReader(fmt::format("validation/{}.toml", file.name), file.text, kClaims)),
                      std::back_inserter(claims));
  }
  return claims;
}

}  // namespace haptolith

#include "haptolith/scenario/tool_part_keys.h"

#include <array>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/scenario/scene_words.h"
#include "haptolith/scenario/toml/toml_writer.h"

namespace haptolith {

namespace {

constexpr double kPartMm = 1e-3;  // m
constexpr double kPartDegree = std::numbers::pi / 180;
constexpr KeyName kPart{"", "tool_part"};

template <double ToolPart::*kNumber>
ToolPartKey::NumberValue length() {
  return {ToolPartRanges::length_m.in(kPartMm), [](ToolPart& part, double value) { part.*kNumber = value * kPartMm; },
          [](const ToolPart& part) { return inUnits(part.*kNumber, kPartMm); }};
}

template <Vec3 ToolPart::*kVector>
ToolPartKey::VectorValue millimetres(const Range& valid_m) {
  return {valid_m.in(kPartMm), [](ToolPart& part, const Vec3& value) { part.*kVector = value * kPartMm; },
          [](const ToolPart& part) {
            return Vec3((part.*kVector).unaryExpr([](double edge_m) { return inUnits(edge_m, kPartMm); }));
          }};
}

std::vector<ToolPartKey> allPartKeys() {
  return {
      {"", "shape", "form",
       ToolPartKey::WordValue{namesOf(kToolPartWords),
                              [](ToolPart& part, std::string_view v) { part.form = valueOf(kToolPartWords, v); },
                              [](const ToolPart& part) { return wordFor(kToolPartWords, part.form); }},
       "A box, a ball or an upright cylinder."},
      {"", "size_mm", "size_m", millimetres<&ToolPart::size_m>(ToolPartRanges::length_m),
       "Edges of the `box` along its x, y and z."},
      {"", "diameter_mm", "diameter_m", length<&ToolPart::diameter_m>(), "Diameter of the `sphere` or `cylinder`."},
      {"", "length_mm", "length_m", length<&ToolPart::length_m>(), "Length of the `cylinder` along its z."},
      {"", "at_mm", "at_m", millimetres<&ToolPart::at_m>(ToolPartRanges::at_m),
       "Where its middle is, from the point that the hand holds."},
      {"", "turn_deg", "turn_rad",
       ToolPartKey::VectorValue{ToolPartRanges::turn_rad.in(kPartDegree),
                                [](ToolPart& part, const Vec3& v) { part.turn_rad = v * kPartDegree; },
                                [](const ToolPart& part) {
                                  return Vec3(part.turn_rad.unaryExpr(
                                      [](double angle) { return inUnits(angle, kPartDegree); }));
                                }},
       "How it is turned about its middle: about x first, then y, then z."},
  };
}

/// Sizes that a part of this shape has not.
void refuseOtherSizes(const TomlReader& part, ToolPartForm form) {
  struct Size {
    std::string_view key;
    bool is_its_own;
  };
  const std::array sizes{Size{"size_mm", form == ToolPartForm::kBox}, Size{"diameter_mm", form != ToolPartForm::kBox},
                         Size{"length_mm", form == ToolPartForm::kCylinder}};
  for (const Size& size : sizes) {
    if (!size.is_its_own && part.has("", size.key)) {
      part.refuseKey({"", size.key}, fmt::format("left out: a {} has none", wordFor(kToolPartWords, form)));
    }
  }
}

}  // namespace

std::span<const ToolPartKey> toolPartKeys() {
  static const std::vector<ToolPartKey> kKeys = allPartKeys();
  return kKeys;
}

void readToolParts(const TomlReader& reader, Scenario& scene) {
  if (!reader.has(kPart.table, kPart.name)) {
    return;
  }
  for (const std::string_view rival :
       {"name", "mesh", "mesh_data", "mesh_unit_mm", "mesh_sheet_mm", "mesh_origin_mm", "mesh_turn_deg"}) {
    if (reader.has("tool", rival)) {
      reader.refuseKey({"tool", rival}, "left out: the tool is put together of [[tool_part]]");
    }
  }
  if (reader.has("tool", "shape") && scene.tool.shape != ToolShape::kMesh) {
    reader.refuseKey({"tool", "shape"}, "left out or mesh: the tool is put together of [[tool_part]]");
  }
  std::vector<ToolPart> parts;
  const std::vector<TomlReader> tables = reader.parts(kPart.name);
  if (!ToolPartRanges::count.contains(static_cast<double>(tables.size()))) {
    reader.refuse(reader.lineOf(kPart.table, kPart.name),
                  fmt::format("{} [[tool_part]] are not valid: must be {:g} to {:g}", tables.size(),
                              ToolPartRanges::count.lowest, ToolPartRanges::count.highest));
  }
  for (const TomlReader& table : tables) {
    table.refuseUnknownKeys(keyNames(toolPartKeys()));
    ToolPart part;
    for (const ToolPartKey& key : toolPartKeys()) {
      table.apply(key, part);
    }
    refuseOtherSizes(table, part.form);
    table.check(toolPartKeys(), "", [&] { validate(part); });
    parts.push_back(part);
  }
  scene.mesh = {.name = "parts",
                .bytes = std::make_shared<const std::string>(drawn(parts)),
                .format = MeshFormat::kObj,
                .origin_m = Vec3::Zero()};
  scene.tool.shape = ToolShape::kMesh;
}

}  // namespace haptolith

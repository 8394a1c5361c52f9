#include "haptolith/scene_file/tool_part_keys.h"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/toml/member_keys.h"

namespace haptolith {

namespace {

constexpr KeyName kPart{"", "tool_part"};

std::vector<ToolPartKey> allPartKeys() {
  const auto part = memberKeys<ToolPart>("");
  std::vector<ToolPartKey> keys{
      part.word("shape", &ToolPart::form, kToolPartWords, "Box, sphere or upright cylinder."),
      part.vector("size_mm", &ToolPart::size_m, ToolPartRanges::length_m, kMillimetres,
                  "Edges of the `box` along its x, y and z."),
      part.number("diameter_mm", &ToolPart::diameter_m, ToolPartRanges::length_m, kMillimetres,
                  "Diameter of the `sphere` or `cylinder`."),
      part.number("length_mm", &ToolPart::length_m, ToolPartRanges::length_m, kMillimetres,
                  "Length of the `cylinder` along its z."),
      part.vector("at_mm", &ToolPart::at_m, ToolPartRanges::at_m, kMillimetres, "Centre from the tool's origin."),
      part.vector("turn_deg", &ToolPart::turn_rad, ToolPartRanges::turn_rad, kDegrees,
                  "Rotation about its centre: about x, then y, then z."),
      part.count("copies", &ToolPart::copies, ToolPartRanges::count,
                 "Number of such parts, evenly round the tool's z: the grousers of a wheel."),
  };
  keys.front().parameter = "form";
  return keys;
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

void readToolParts(const TomlReader& reader, SceneFile& scene) {
  if (!reader.has(kPart.table, kPart.name)) {
    return;
  }
  for (const std::string_view rival :
       {"model", "mesh", "mesh_data", "mesh_unit_mm", "mesh_sheet_mm", "mesh_origin_mm", "mesh_turn_deg"}) {
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

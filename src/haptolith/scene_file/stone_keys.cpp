#include "haptolith/scene_file/stone_keys.h"

#include <cmath>
#include <vector>

#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/toml/member_keys.h"
#include "haptolith/scene_file/toml/toml_writer.h"

namespace haptolith {

namespace {

constexpr KeyName kStone{"", "stone"};

void setSpheres(PlacedStone& stone, const std::vector<TextOrNumber>& items) {
  constexpr std::size_t kNumbers = 4;
  stone.spheres.clear();
  std::array<double, kNumbers> sphere{};
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!items[i].number) {
      throw InvalidParameter("spheres_mm", items[i].text, "numbers");
    }
    sphere[i % kNumbers] = *items[i].number * kMillimetres.in_si;
    if (i % kNumbers + 1 == kNumbers) {
      stone.spheres.push_back({Vec3(sphere[0], sphere[1], sphere[2]), sphere[3]});
    }
  }
  if (items.size() % kNumbers != 0) {
    throw InvalidParameter("spheres_mm", fmt::format("{} numbers", items.size()), "x, y, z and radius of each sphere");
  }
}

std::string spheresLine(const PlacedStone& stone) {
  std::string numbers;
  for (const StoneSphere& sphere : stone.spheres) {
    for (const double number_m : {sphere.centre_m.x(), sphere.centre_m.y(), sphere.centre_m.z(), sphere.radius_m}) {
      numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", tomlNumber(inUnits(number_m, kMillimetres.in_si)));
    }
  }
  return stone.spheres.empty() ? "" : fmt::format("spheres_mm = [{}]\n", numbers);
}

std::vector<StoneKey> allStoneKeys() {
  using Stone = PlacedStone;
  const auto stone = memberKeys<Stone>("");
  std::vector<StoneKey> keys{
      stone.word("shape", &Stone::form, kStoneFormWords, "An angular rock, a sphere, or the union of `spheres_mm`."),
      stone.number("size_mm", &Stone::size_m, kStoneSize_m, kMillimetres,
                   "Diameter of a sphere of equal volume; not for `spheres`."),
      stone.count("seed", &Stone::seed, StonesRanges::seed, "One seed, one rock."),
      {"", "spheres_mm", "spheres",
       StoneKey::ItemsValue{"x, y, z and radius of each sphere, one after the other", setSpheres},
       "Spheres of a custom stone; its centre is computed."},
      stone.number("x_mm", &Stone::x_m, StonesRanges::place_m, kMillimetres, "Where its middle is along x."),
      stone.number("y_mm", &Stone::y_m, StonesRanges::place_m, kMillimetres, "Where its middle is along y."),
      stone.number("depth_mm", &Stone::depth_m, StonesRanges::depth_m, kMillimetres,
                   "How deep its middle lies below the surface; below 0 it begins above it, and falls."),
      stone.vector("turn_deg", &Stone::turn_rad, StonesRanges::turn_rad, kDegrees,
                   "How it is turned: about x first, then y, then z."),
      stone.onOrOff("fixed", &Stone::fixed, "Whether it stays where it is, whatever pushes it, as bedrock does."),
  };
  keys.front().parameter = "form";
  return keys;
}

}  // namespace

std::span<const StoneKey> stoneKeys() {
  static const std::vector<StoneKey> kKeys = allStoneKeys();
  return kKeys;
}

void readPlacedStones(const TomlReader& reader, SceneFile& scene) {
  if (!reader.has(kStone.table, kStone.name)) {
    return;
  }
  scene.bed.stones.placed.clear();
  for (const TomlReader& part : reader.parts(kStone.name)) {
    part.refuseUnknownKeys(keyNames(stoneKeys()));
    PlacedStone stone;
    for (const StoneKey& key : stoneKeys()) {
      part.apply(key, stone);
    }
    if (stone.form == StoneForm::kSpheres) {
      part.require("", "spheres_mm");
      part.refuseBoth("", "spheres_mm", "size_mm");
    } else if (part.has("", "spheres_mm")) {
      part.refuseKey({"", "spheres_mm"}, "left out: they are for shape = spheres");
    }
    StonesParameters alone;
    alone.placed = {stone};
    part.check(stoneKeys(), "", [&] { validate(alone); });
    scene.bed.stones.placed.push_back(std::move(stone));
  }
}

std::string placedStonesText(const SceneFile& scene) {
  std::string text;
  for (const PlacedStone& stone : scene.bed.stones.placed) {
    text += "\n[[stone]]\n";
    for (const StoneKey& key : stoneKeys()) {
      const bool own_size = key.name != "size_mm" || stone.form != StoneForm::kSpheres;
      text += own_size ? tomlLine(key, stone) : "";
    }
    text += spheresLine(stone);
  }
  return text;
}

}  // namespace haptolith

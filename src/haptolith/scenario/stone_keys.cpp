#include "haptolith/scenario/stone_keys.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "haptolith/scenario/scene_words.h"
#include "haptolith/scenario/toml/toml_writer.h"

namespace haptolith {

namespace {

constexpr double kStoneMm = 1e-3;  // m
constexpr double kStoneDegree = std::numbers::pi / 180;
constexpr KeyName kStone{"", "stone"};

template <double PlacedStone::*kNumber>
StoneKey::NumberValue length(const Range& valid_m) {
  return {valid_m.in(kStoneMm), [](PlacedStone& stone, double value) { stone.*kNumber = value * kStoneMm; },
          [](const PlacedStone& stone) { return inUnits(stone.*kNumber, kStoneMm); }};
}

void setSpheres(PlacedStone& stone, const std::vector<TextOrNumber>& items) {
  constexpr std::size_t kNumbers = 4;
  stone.spheres.clear();
  std::array<double, kNumbers> sphere{};
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!items[i].number) {
      throw InvalidParameter("spheres_mm", items[i].text, "numbers");
    }
    sphere[i % kNumbers] = *items[i].number * kStoneMm;
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
      numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", tomlNumber(inUnits(number_m, kStoneMm)));
    }
  }
  return stone.spheres.empty() ? "" : fmt::format("spheres_mm = [{}]\n", numbers);
}

std::vector<StoneKey> allStoneKeys() {
  using S = PlacedStone;
  return {
      {"", "shape", "form",
       StoneKey::WordValue{namesOf(kStoneFormWords),
                           [](S& s, std::string_view v) { s.form = valueOf(kStoneFormWords, v); },
                           [](const S& s) { return wordFor(kStoneFormWords, s.form); }},
       "An angular rock, a ball, or the `spheres_mm` that it is made of."},
      {"", "size_mm", "size_m", length<&S::size_m>(kStoneSize_m),
       "Diameter of the ball of its volume; not for `spheres`."},
      {"", "seed", "seed",
       StoneKey::CountValue{StonesRanges::seed, [](S& s, std::int64_t v) { s.seed = static_cast<std::uint64_t>(v); },
                            [](const S& s) { return static_cast<std::int64_t>(s.seed); }},
       "One seed, one rock."},
      {"", "spheres_mm", "spheres",
       StoneKey::ItemsValue{"x, y, z and radius of each sphere, one after the other", setSpheres},
       "The spheres of a stone of your own, wherever its middle is."},
      {"", "x_mm", "x_m", length<&S::x_m>(StonesRanges::place_m), "Where its middle is along x."},
      {"", "y_mm", "y_m", length<&S::y_m>(StonesRanges::place_m), "Where its middle is along y."},
      {"", "depth_mm", "depth_m", length<&S::depth_m>(StonesRanges::depth_m),
       "How deep its middle lies below the surface; below 0 it begins above it, and falls."},
      {"", "turn_deg", "turn_rad",
       StoneKey::VectorValue{
           StonesRanges::turn_rad.in(kStoneDegree), [](S& s, const Vec3& v) { s.turn_rad = v * kStoneDegree; },
           [](const S& s) { return Vec3(s.turn_rad.unaryExpr([](double a) { return inUnits(a, kStoneDegree); })); }},
       "How it is turned: about x first, then y, then z."},
      {"", "fixed", "fixed",
       StoneKey::SwitchValue{[](S& s, bool v) { s.fixed = v; }, [](const S& s) { return s.fixed; }},
       "Whether it stays where it is, whatever pushes it, as bedrock does."},
  };
}

}  // namespace

std::span<const StoneKey> stoneKeys() {
  static const std::vector<StoneKey> kKeys = allStoneKeys();
  return kKeys;
}

void readPlacedStones(const TomlReader& reader, Scenario& scene) {
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

std::string placedStonesText(const Scenario& scene) {
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

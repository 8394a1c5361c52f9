#include "haptolith/scenario/scenario_keys.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

#include "haptolith/core/base64.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/scenario/built_in_soils.h"
#include "haptolith/scenario/built_in_tools.h"
#include "haptolith/scenario/given_grains.h"
#include "haptolith/scenario/scene_words.h"
#include "haptolith/scenario/soil_file.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"

namespace haptolith {

namespace {

constexpr double kMm = 1e-3;  // m
constexpr double kMs = 1e-3;  // s
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLeftOut = std::numeric_limits<double>::quiet_NaN();
constexpr Range kGravityAxis_m_s2{-BedRanges::gravity_m_s2.highest, BedRanges::gravity_m_s2.highest};

double millimetres(double length_m) {
  return inUnits(length_m, kMm);
}

Vec3 millimetres(const Vec3& lengths_m) {
  return lengths_m.unaryExpr([](double x) { return millimetres(x); });
}

/// A limit that may be left out.
double limitOrLeftOut(double limit) {
  return limit == DeviceLimits::kNone ? kLeftOut : limit;
}

/// A number of the soil, in the unit of its key.
template <double SoilParameters::*kNumber>
ScenarioKey::NumberValue soilNumber(const Range& valid) {
  return {valid, [](Scenario& scene, double value) { scene.bed.soil.*kNumber = value; },
          [](const Scenario& scene) { return scene.bed.soil.*kNumber; }};
}

/// One of the numbers that make a preset: the soil is then no longer that preset.
template <double SoilParameters::*kNumber>
ScenarioKey::NumberValue presetNumber(const Range& valid) {
  ScenarioKey::NumberValue value = soilNumber<kNumber>(valid);
  value.set = [](Scenario& scene, double number) {
    scene.preset.clear();
    scene.bed.soil.*kNumber = number;
  };
  return value;
}

/// A length of where grains are finer, in millimetres.
template <double Grading::*kNumber>
ScenarioKey::NumberValue gradingNumber(const Range& valid_m) {
  return {valid_m.in(kMm), [](Scenario& scene, double value) { scene.bed.grading.*kNumber = value * kMm; },
          [](const Scenario& scene) { return millimetres(scene.bed.grading.*kNumber); }};
}

/// A length of stones at random places, in millimetres.
template <double StonesParameters::*kNumber>
ScenarioKey::NumberValue stonesLength(const Range& valid_m) {
  return {valid_m.in(kMm), [](Scenario& scene, double value) { scene.bed.stones.*kNumber = value * kMm; },
          [](const Scenario& scene) { return millimetres(scene.bed.stones.*kNumber); }};
}

void setGravity(Scenario& scene, const Vec3& direction, double magnitude_m_s2) {
  scene.bed.gravity_m_s2 = direction.normalized() * magnitude_m_s2;
}

void setTool(Scenario& scene, std::string_view name) {
  const std::string_view text = std::ranges::find(builtInTools(), name, &BuiltInTool::name)->text;
  scene.mesh = {.name = std::string(name),
                .bytes = std::make_shared<const std::string>(text),
                .format = MeshFormat::kObj,
                .origin_m = Vec3::Zero()};
  scene.tool.shape = ToolShape::kMesh;
}

/// "stl:c29saWQ..."
std::string dataOf(const ToolMeshSource& mesh) {
  return mesh.bytes ? fmt::format("{}:{}", wordFor(kMeshFormatWords, mesh.format), base64(*mesh.bytes)) : "";
}

void readData(ToolMeshSource& mesh, std::string_view data) {
  const std::size_t colon = data.find(':');
  std::optional<std::string> bytes =
      colon == std::string_view::npos ? std::nullopt : fromBase64(data.substr(colon + 1));
  if (!bytes) {
    throw InvalidParameter("mesh_data", inQuotes(data), "stl, obj or gltf, a colon, and base64");
  }
  if (bytes->size() > kMostMeshBytes) {
    throw InvalidParameter("mesh_data", fmt::format("{} bytes", bytes->size()),
                           fmt::format("at most {} bytes", kMostMeshBytes));
  }
  mesh.format = valueOf(kMeshFormatWords, data.substr(0, colon));
  mesh.bytes = std::make_shared<const std::string>(*std::move(bytes));
}

std::vector<ScenarioKey> allKeys() {
  using S = Scenario;
  using NumberValue = ScenarioKey::NumberValue;
  using CountValue = ScenarioKey::CountValue;
  using VectorValue = ScenarioKey::VectorValue;
  using SwitchValue = ScenarioKey::SwitchValue;
  using WordValue = ScenarioKey::WordValue;
  using TextValue = ScenarioKey::TextValue;
  using DataValue = ScenarioKey::DataValue;
  using PathValue = ScenarioKey::PathValue;
  return {
      {"", "title", "",
       TextValue{[](S& s, std::string_view v) { s.title = v; }, [](const S& s) { return std::string_view(s.title); }},
       "What the scene shows, in a line."},

      // The radius rescales the preset or named soil; the numbers after it are taken as they are, for particles of that
      // radius.
      {"soil", "preset", "",
       WordValue{namesOf(presets()),
                 [](S& s, std::string_view v) {
                   s.preset = v;
                   s.bed.soil = findPreset(v).soil;
                 },
                 kOnlyRead},
       "Soil of the paper's Table II; not together with `gamma_nm`, `rho0_kg_m3`, `rho_max_kg_m3` or `mu_hat`."},
      {"soil", "name", "",
       WordValue{namesOf(builtInSoils()), [](S& s, std::string_view v) { setSoil(s, findSoil(v)); }, kOnlyRead},
       "A soil with a name; instead of a preset, and not together with the numbers that make a soil."},
      {"soil", "file", "",
       PathValue{[](S& s, const std::filesystem::path& v) { setSoil(s, loadSoilFile(v)); }, kOnlyRead},
       "A soil file (soils.md), beside the scene file; the same goes for it."},
      {"soil", "radius_mm", "radius_m",
       NumberValue{SoilRanges::radius_m.in(kMm), [](S& s, double v) { s.bed.soil = rescaled(s.bed.soil, v * kMm); },
                   [](const S& s) { return millimetres(s.bed.soil.radius_m); }},
       "Radius of a macroparticle; `gamma_nm`, `stiffness_n_m` and `contact_cohesion_n` follow unless they are given "
       "too."},
      {"soil", "gamma_nm", "gamma_nm", presetNumber<&SoilParameters::gamma_nm>(SoilRanges::gamma_nm),
       "Strength of the contact law (paper 7), N m."},
      {"soil", "rho0_kg_m3", "rho0_kg_m3", presetNumber<&SoilParameters::rho0_kg_m3>(SoilRanges::rho0_kg_m3),
       "Bulk density at the surface."},
      {"soil", "rho_max_kg_m3", "rho_max_kg_m3",
       presetNumber<&SoilParameters::rho_max_kg_m3>(SoilRanges::rho_max_kg_m3),
       "Bulk density that no load exceeds (paper 8); more than `rho0_kg_m3`."},
      {"soil", "stiffness_n_m", "stiffness_n_m", soilNumber<&SoilParameters::stiffness_n_m>(SoilRanges::stiffness_n_m),
       "Limiting stiffness k of a contact (paper 7)."},
      {"soil", "friction", "",
       WordValue{namesOf(kFrictionWords),
                 [](S& s, std::string_view v) { s.bed.soil.friction = valueOf(kFrictionWords, v); },
                 [](const S& s) { return wordFor(kFrictionWords, s.bed.soil.friction); }},
       "What friction acts against: absolute space, as in the paper (14), or the particles that a particle touches."},
      {"soil", "mu_hat", "mu_hat", presetNumber<&SoilParameters::mu_hat>(SoilRanges::mu_hat),
       "Model friction (paper 14); for `paper`."},
      {"soil", "attraction_ratio", "attraction_ratio",
       soilNumber<&SoilParameters::attraction_ratio>(SoilRanges::attraction_ratio),
       "Reach of attraction over radius (paper 19); 1 switches attraction off; for `paper`."},
      {"soil", "moving_friction_ratio", "moving_friction_ratio",
       soilNumber<&SoilParameters::moving_friction_ratio>(SoilRanges::moving_friction_ratio),
       "Moving over static friction (paper 14); for `paper`."},
      {"soil", "contact_friction", "contact_friction",
       soilNumber<&SoilParameters::contact_friction>(SoilRanges::contact_friction),
       "Coulomb friction of a contact; for `contact`."},
      {"soil", "contact_cohesion_n", "contact_cohesion_n",
       soilNumber<&SoilParameters::contact_cohesion_n>(SoilRanges::contact_cohesion_n),
       "Largest pull of a contact, and what it adds to the normal force; for `contact`."},
      {"soil", "cohesion_range_ratio", "cohesion_range_ratio",
       soilNumber<&SoilParameters::cohesion_range_ratio>(SoilRanges::cohesion_range_ratio),
       "How many radii apart two particles still cohere; for `contact`."},
      {"soil", "tangential_ratio", "tangential_ratio",
       soilNumber<&SoilParameters::tangential_ratio>(SoilRanges::tangential_ratio),
       "Tangential over normal stiffness of a contact; for `contact`."},
      {"soil", "damping_ratio", "damping_ratio", soilNumber<&SoilParameters::damping_ratio>(SoilRanges::damping_ratio),
       "Damping of a pair that bounces, over critical damping; for `contact`."},
      {"soil", "size_spread", "size_spread", soilNumber<&SoilParameters::size_spread>(SoilRanges::size_spread),
       "Radii lie evenly between (1 - spread) and (1 + spread) times the radius; for `contact`."},

      // A magnitude of 0 would forget the direction, so the direction comes first.
      {"gravity", "direction", "gravity_m_s2",
       VectorValue{kGravityAxis_m_s2,
                   [](S& s, const Vec3& v) {
                     if (v.isZero(1e-12)) {
                       throw InvalidParameter("direction", "the zero vector", "a direction, for example [0, 0, -1]");
                     }
                     setGravity(s, v, s.bed.gravity_m_s2.norm());
                   },
                   kOnlyRead},
       "Where things fall to, of any length but 0."},
      {"gravity", "body", "",
       WordValue{namesOf(bodies()),
                 [](S& s, std::string_view v) {
                   s.body = v;
                   setGravity(s, s.bed.gravity_m_s2, findBody(v).gravity_m_s2);
                 },
                 kOnlyRead},
       "Gravity of a celestial body; not together with `magnitude_m_s2`."},
      {"gravity", "magnitude_m_s2", "gravity_m_s2",
       NumberValue{BedRanges::gravity_m_s2,
                   [](S& s, double v) {
                     s.body.clear();
                     setGravity(s, s.bed.gravity_m_s2, v);
                   },
                   kOnlyRead},
       "Gravity by its number."},
      {"gravity", "vector_m_s2", "gravity_m_s2",
       VectorValue{kGravityAxis_m_s2,
                   [](S& s, const Vec3& v) {
                     s.body.clear();
                     s.bed.gravity_m_s2 = v;
                   },
                   [](const S& s) { return s.bed.gravity_m_s2; }},
       "Gravity by its three numbers; instead of all others."},

      // What the program writes beside the numbers it writes.
      {"names", "preset", "",
       TextValue{[](S& s, std::string_view v) { s.preset = v; }, [](const S& s) { return std::string_view(s.preset); }},
       "What the soil is called when it is a preset."},
      {"names", "soil", "",
       TextValue{[](S& s, std::string_view v) { s.soil_name = v; },
                 [](const S& s) { return std::string_view(s.soil_name); }},
       "What the soil is called when it has a name of its own."},
      {"names", "body", "",
       TextValue{[](S& s, std::string_view v) { s.body = v; }, [](const S& s) { return std::string_view(s.body); }},
       "What the world is called."},
      {"names", "mesh", "",
       TextValue{[](S& s, std::string_view v) { s.mesh.name = v; },
                 [](const S& s) { return s.mesh.bytes ? std::string_view(s.mesh.name) : std::string_view(); }},
       "What the file of the tool's mesh was called."},

      {"bed", "start", "",
       WordValue{namesOf(kBedStartWords), [](S& s, std::string_view v) { s.bed.start = valueOf(kBedStartWords, v); },
                 [](const S& s) { return wordFor(kBedStartWords, s.bed.start); }},
       "How the soil lies at first: `particles` in `layers`; closely packed up to `depth_mm`; dropped at random; "
       "settled and levelled at `depth_mm`, at rest, in pieces that repeat (below); or where `grains` has it."},
      {"bed", "grains", "",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   s.bed.given = readGrains(v, s.bed.soil.radius_m);
                   s.bed.start = BedStart::kGiven;
                 },
                 kOnlyRead},
       "Where each grain is: a .csv file beside the scene file (below), as `haptolith import` writes. Implies "
       "`start`."},
      {"bed", "grains_data", "",
       DataValue{[](S& s, std::string_view v) { readGrainsData(s.bed.given, v); },
                 [](const S& s) { return grainsData(s.bed.given); }},
       "What the program writes in place of `grains`: how many are held, a colon, and their numbers in base64."},
      {"bed", "particles", "particles",
       CountValue{BedRanges::particles, [](S& s, std::int64_t v) { s.bed.particles = static_cast<int>(v); },
                  [](const S& s) { return static_cast<std::int64_t>(s.bed.particles); }},
       "Number of macroparticles; for `count` and `rain`."},
      {"bed", "layers", "layers",
       CountValue{BedRanges::layers, [](S& s, std::int64_t v) { s.bed.layers = static_cast<int>(v); },
                  [](const S& s) { return static_cast<std::int64_t>(s.bed.layers); }},
       "Number of layers; for `count`."},
      {"bed", "width_mm", "width_m",
       NumberValue{BedRanges::length_m.in(kMm), [](S& s, double v) { s.bed.width_m = v * kMm; },
                   [](const S& s) { return millimetres(s.bed.width_m); }},
       "Inner size of the box along x; at least a particle."},
      {"bed", "length_mm", "length_m",
       NumberValue{BedRanges::length_m.in(kMm), [](S& s, double v) { s.bed.length_m = v * kMm; },
                   [](const S& s) { return millimetres(s.bed.length_m); }},
       "Inner size of the box along y; at least a particle."},
      {"bed", "depth_mm", "depth_m",
       NumberValue{BedRanges::length_m.in(kMm), [](S& s, double v) { s.bed.depth_m = v * kMm; },
                   [](const S& s) { return millimetres(s.bed.depth_m); }},
       "Height of the undisturbed soil; for `packed` and `settled`; at least a particle."},
      {"bed", "seed", "seed",
       CountValue{BedRanges::seed, [](S& s, std::int64_t v) { s.bed.seed = static_cast<std::uint64_t>(v); },
                  [](const S& s) { return static_cast<std::int64_t>(s.bed.seed); }},
       "Seed of the random numbers; for `rain`, `settled` and finer grains. One seed, one bed."},
      {"bed", "ready_made", "",
       SwitchValue{[](S& s, bool v) { s.bed.ready_made = v; }, [](const S& s) { return s.bed.ready_made; }},
       "Whether settled soil that ships with the program is taken, where there is some of this soil, radius, depth, "
       "gravity and seed, instead of letting it settle here; for `settled`."},
      {"bed", "fine_radius_mm", "fine_radius_m", gradingNumber<&Grading::fine_radius_m>(BedRanges::fine_radius_m),
       "Radius of finer grains where soil is felt: the soil's halved once, twice or three times, with shells of the "
       "sizes "
       "between around them; 0: grains are all alike."},
      {"bed", "fine_width_mm", "fine_width_m", gradingNumber<&Grading::fine_width_m>(BedRanges::fine_length_m),
       "Size of the soil with the finest grains along x."},
      {"bed", "fine_length_mm", "fine_length_m", gradingNumber<&Grading::fine_length_m>(BedRanges::fine_length_m),
       "Size of the soil with the finest grains along y."},
      {"bed", "fine_depth_mm", "fine_depth_m", gradingNumber<&Grading::fine_depth_m>(BedRanges::fine_length_m),
       "How deep the finest grains go below the surface."},
      {"bed", "fine_x_mm", "fine_x_m", gradingNumber<&Grading::fine_x_m>(BedRanges::fine_place_m),
       "Middle of the soil with the finest grains along x."},
      {"bed", "fine_y_mm", "fine_y_m", gradingNumber<&Grading::fine_y_m>(BedRanges::fine_place_m),
       "Middle of the soil with the finest grains along y."},
      {"bed", "sleep", "", SwitchValue{[](S& s, bool v) { s.bed.sleep = v; }, [](const S& s) { return s.bed.sleep; }},
       "Whether soil at rest is not computed until something near it moves."},
      {"bed", "sleep_speed_m_s", "sleep_speed_m_s",
       NumberValue{BedRanges::sleep_speed_m_s, [](S& s, double v) { s.bed.sleep_speed_m_s = v; },
                   [](const S& s) { return s.bed.sleep_speed_m_s; }},
       "What moves faster is not at rest. 0 changes no bit, the default next to nothing, and 0.01 with a "
       "sleep_distance_mm "
       "of a hundredth of a radius lets far more of a large bed sleep."},
      {"bed", "sleep_distance_mm", "sleep_distance_m",
       NumberValue{BedRanges::sleep_distance_m.in(kMm), [](S& s, double v) { s.bed.sleep_distance_m = v * kMm; },
                   [](const S& s) { return s.bed.sleep_distance_m / kMm; }},
       "Nor is at rest what has gone further from where it came to rest; 0: as far as it goes at sleep_speed_m_s in 20 "
       "ms."},
      {"bed", "threads", "threads",
       CountValue{BedRanges::threads, [](S& s, std::int64_t v) { s.bed.threads = static_cast<int>(v); },
                  [](const S& s) { return static_cast<std::int64_t>(s.bed.threads); }},
       "Threads that share a tick; the result is the same for any number."},
      {"bed", "max_substeps", "max_substeps",
       CountValue{BedRanges::max_substeps, [](S& s, std::int64_t v) { s.bed.max_substeps = static_cast<int>(v); },
                  [](const S& s) { return static_cast<std::int64_t>(s.bed.max_substeps); }},
       "A soil that would need more steps in a tick to be stable is refused."},

      {"stones", "count", "count",
       CountValue{StonesRanges::count, [](S& s, std::int64_t v) { s.bed.stones.count = static_cast<int>(v); },
                  [](const S& s) { return static_cast<std::int64_t>(s.bed.stones.count); }},
       "Stones at random places in the soil, besides each [[stone]]."},
      {"stones", "shape", "form",
       WordValue{{kStoneFormWords[0].name, kStoneFormWords[1].name},
                 [](S& s, std::string_view v) { s.bed.stones.form = valueOf(kStoneFormWords, v); },
                 [](const S& s) { return wordFor(kStoneFormWords, s.bed.stones.form); }},
       "Angular rocks, or balls."},
      {"stones", "smallest_mm", "smallest_m", stonesLength<&StonesParameters::smallest_m>(kStoneSize_m),
       "Diameter of the ball of the smallest one's volume."},
      {"stones", "largest_mm", "largest_m", stonesLength<&StonesParameters::largest_m>(kStoneSize_m),
       "Of the largest one's."},
      {"stones", "exponent", "exponent",
       NumberValue{StonesRanges::exponent, [](S& s, double v) { s.bed.stones.exponent = v; },
                   [](const S& s) { return s.bed.stones.exponent; }},
       "How many are larger than D goes as D to the minus this (below)."},
      {"stones", "shallowest_mm", "shallowest_m", stonesLength<&StonesParameters::shallowest_m>(StonesRanges::depth_m),
       "How deep the middle of the shallowest lies below the surface; below 0: above it."},
      {"stones", "deepest_mm", "deepest_m", stonesLength<&StonesParameters::deepest_m>(StonesRanges::depth_m),
       "How deep that of the deepest does."},
      {"stones", "seed", "seed",
       CountValue{StonesRanges::seed, [](S& s, std::int64_t v) { s.bed.stones.seed = static_cast<std::uint64_t>(v); },
                  [](const S& s) { return static_cast<std::int64_t>(s.bed.stones.seed); }},
       "Seed of their sizes, shapes and places."},
      {"stones", "fixed", "fixed",
       SwitchValue{[](S& s, bool v) { s.bed.stones.fixed = v; }, [](const S& s) { return s.bed.stones.fixed; }},
       "Whether they stay where they are, whatever pushes them."},
      {"stones", "density_kg_m3", "density_kg_m3",
       NumberValue{StonesRanges::density_kg_m3, [](S& s, double v) { s.bed.stones.density_kg_m3 = v; },
                   [](const S& s) { return s.bed.stones.density_kg_m3; }},
       "Of all stones, each [[stone]] too."},

      {"tool", "shape", "",
       WordValue{namesOf(kToolShapeWords), [](S& s, std::string_view v) { s.tool.shape = valueOf(kToolShapeWords, v); },
                 [](const S& s) { return wordFor(kToolShapeWords, s.tool.shape); }},
       "Shape of the tool: the shovel, a ball, a round plate that lies flat, an upright cylinder, two jaws that "
       "open along x, or a `mesh`."},
      {"tool", "name", "",
       WordValue{namesOf(builtInTools()), [](S& s, std::string_view v) { setTool(s, v); }, kOnlyRead},
       "A tool that the program brings along, drawn to size (below); instead of `shape` and `mesh`."},
      {"tool", "size_mm", "size_m",
       VectorValue{ToolRanges::length_m.in(kMm), [](S& s, const Vec3& v) { s.tool.size_m = v * kMm; },
                   [](const S& s) { return millimetres(s.tool.size_m); }},
       "Edges of the `box` along its x, y and z; of each of the `jaws` along z, y and x."},
      {"tool", "diameter_mm", "diameter_m",
       NumberValue{ToolRanges::length_m.in(kMm), [](S& s, double v) { s.tool.diameter_m = v * kMm; },
                   [](const S& s) { return millimetres(s.tool.diameter_m); }},
       "Diameter of the `sphere`, `plate` or `cylinder`."},
      {"tool", "thickness_mm", "thickness_m",
       NumberValue{ToolRanges::length_m.in(kMm), [](S& s, double v) { s.tool.thickness_m = v * kMm; },
                   [](const S& s) { return millimetres(s.tool.thickness_m); }},
       "Height of the `plate`."},
      {"tool", "opening_mm", "opening_m",
       NumberValue{ToolRanges::length_m.in(kMm), [](S& s, double v) { s.tool.opening_m = v * kMm; },
                   [](const S& s) { return millimetres(s.tool.opening_m); }},
       "How far apart the `jaws` are when they are wide open; bent ones at their ends."},
      {"tool", "jaw_bend_deg", "jaw_bend_rad",
       NumberValue{ToolRanges::jaw_bend_rad.in(kDegree), [](S& s, double v) { s.tool.jaw_bend_rad = v * kDegree; },
                   [](const S& s) { return inUnits(s.tool.jaw_bend_rad, kDegree); }},
       "By how much each of the `jaws` is bent to a shell that bulges outwards; 0: flat plates."},
      {"tool", "length_mm", "length_m",
       NumberValue{ToolRanges::length_m.in(kMm), [](S& s, double v) { s.tool.length_m = v * kMm; },
                   [](const S& s) { return millimetres(s.tool.length_m); }},
       "Length of the `cylinder` along its axis."},
      {"tool", "mesh_unit_mm", "mesh_unit_m",
       NumberValue{kMeshUnit_m.in(kMm), [](S& s, double v) { s.mesh.unit_m = v * kMm; },
                   [](const S& s) { return millimetres(s.mesh.unit_m); }},
       "What a 1 in an STL or OBJ file is: 1 of a file in millimetres, 25.4 of one in inches, 1000 of one in metres. "
       "glTF is in metres, whatever this says."},
      {"tool", "mesh_sheet_mm", "sheet_thickness_m",
       NumberValue{kSheetThickness_m.in(kMm), [](S& s, double v) { s.mesh.sheet_thickness_m = v * kMm; },
                   [](const S& s) { return millimetres(s.mesh.sheet_thickness_m); }},
       "How thick a surface is that is not closed; 0: it has to be closed."},
      {"tool", "mesh_origin_mm", "mesh_origin_m",
       VectorValue{
           ToolMeshRanges::origin_m.in(kMm), [](S& s, const Vec3& v) { s.mesh.origin_m = v * kMm; },
           [](const S& s) { return s.mesh.origin_m ? millimetres(*s.mesh.origin_m) : Vec3(Vec3::Constant(kLeftOut)); }},
       "Which point of the mesh the hand holds, in the file's coordinates times its unit; left out: the middle of the "
       "box around it."},
      {"tool", "mesh_turn_deg", "mesh_turn_rad",
       VectorValue{
           ToolMeshRanges::turn_rad.in(kDegree), [](S& s, const Vec3& v) { s.mesh.turn_rad = v * kDegree; },
           [](const S& s) { return Vec3(s.mesh.turn_rad.unaryExpr([](double x) { return inUnits(x, kDegree); })); }},
       "How the mesh is turned in the hand: about x, then y, then z."},
      {"tool", "mesh", "",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   readInto(s.mesh, v);
                   s.tool.shape = ToolShape::kMesh;
                 },
                 kOnlyRead},
       "A tool that somebody drew: an .stl, .obj, .glb or .gltf file, beside the scene file. Implies `shape`."},
      {"tool", "mesh_data", "",
       DataValue{[](S& s, std::string_view v) { readData(s.mesh, v); }, [](const S& s) { return dataOf(s.mesh); }},
       "What the program writes in place of `mesh`: the file's format, a colon, and the file in base64."},
      {"tool", "stiffness_n_m", "stiffness_n_m",
       NumberValue{ToolRanges::stiffness_n_m, [](S& s, double v) { s.tool.stiffness_n_m = v; },
                   [](const S& s) { return s.tool.stiffness_n_m; }},
       "Stiffness between tool and particle (paper 21)."},
      {"tool", "damping_factor", "damping_factor",
       NumberValue{ToolRanges::damping_factor, [](S& s, double v) { s.tool.damping_factor = v; },
                   [](const S& s) { return s.tool.damping_factor; }},
       "Damping between tool and particle, over half a tick times the stiffness (paper, II-E)."},
      {"tool", "adhesion_ratio", "adhesion_ratio",
       NumberValue{ToolRanges::adhesion_ratio, [](S& s, double v) { s.tool.adhesion_ratio = v; },
                   [](const S& s) { return s.tool.adhesion_ratio; }},
       "How many radii outside the tool a particle still sticks to it (paper 21); with `paper` friction of the soil."},
      {"tool", "friction", "friction",
       NumberValue{ToolRanges::friction, [](S& s, double v) { s.tool.friction = v; },
                   [](const S& s) { return s.tool.friction; }},
       "Friction between soil and tool, tan(delta); with `contact` friction of the soil."},
      {"tool", "adhesion_n", "adhesion_n",
       NumberValue{ToolRanges::adhesion_n, [](S& s, double v) { s.tool.adhesion_n = v; },
                   [](const S& s) { return s.tool.adhesion_n; }},
       "Largest pull of a contact with the tool, and what it adds to the normal force; with `contact` friction."},
      {"tool", "mass_kg", "mass_kg",
       NumberValue{ToolRanges::mass_kg, [](S& s, double v) { s.tool.mass_kg = v; },
                   [](const S& s) { return s.tool.mass_kg; }},
       "Mass of the tool that the hand feels as its weight, and with a virtual coupling as its inertia; 0: none."},
      {"tool", "centre_of_mass_mm", "centre_of_mass_m",
       VectorValue{ToolRanges::centre_of_mass_m.in(kMm), [](S& s, const Vec3& v) { s.tool.centre_of_mass_m = v * kMm; },
                   [](const S& s) { return millimetres(s.tool.centre_of_mass_m); }},
       "Where that mass has its centre, from the tool's origin, in the tool's frame."},

      {"hand", "manoeuvre", "",
       WordValue{namesOf(kManoeuvreWords),
                 [](S& s, std::string_view v) { s.hand.manoeuvre = valueOf(kManoeuvreWords, v); },
                 [](const S& s) { return wordFor(kManoeuvreWords, s.hand.manoeuvre); }},
       "What the hand does, over and over."},
      {"hand", "poses", "poses",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   s.hand.poses_file = v.string();
                   s.hand.manoeuvre = Manoeuvre::kPoses;
                 },
                 [](const S& s) {
                   return s.hand.manoeuvre == Manoeuvre::kPoses ? std::filesystem::absolute(s.hand.poses_file)
                                                                : std::filesystem::path();
                 }},
       "A recorded movement: CSV with `t_s,x_m,y_m,z_m,qw,qx,qy,qz`, beside the scene file. Implies `manoeuvre`."},
      {"hand", "compliance", "",
       WordValue{namesOf(kHandComplianceWords),
                 [](S& s, std::string_view v) { s.hand.compliance = valueOf(kHandComplianceWords, v); },
                 [](const S& s) { return wordFor(kHandComplianceWords, s.hand.compliance); }},
       "Whether the hand yields to force like an arm or follows the manoeuvre whatever it feels."},
      {"hand", "mass_kg", "mass_kg",
       NumberValue{HandRanges::mass_kg, [](S& s, double v) { s.hand.mass_kg = v; },
                   [](const S& s) { return s.hand.mass_kg; }},
       "Mass of the arm as the hand feels it."},
      {"hand", "damping_n_s_m", "damping_n_s_m",
       NumberValue{HandRanges::damping_n_s_m, [](S& s, double v) { s.hand.damping_n_s_m = v; },
                   [](const S& s) { return s.hand.damping_n_s_m; }},
       "Damping of the arm."},
      {"hand", "stiffness_n_m", "stiffness_n_m",
       NumberValue{HandRanges::stiffness_n_m, [](S& s, double v) { s.hand.stiffness_n_m = v; },
                   [](const S& s) { return s.hand.stiffness_n_m; }},
       "Stiffness of the arm."},
      {"hand", "lever_mm", "lever_m",
       NumberValue{HandRanges::lever_m.in(kMm), [](S& s, double v) { s.hand.lever_m = v * kMm; },
                   [](const S& s) { return millimetres(s.hand.lever_m); }},
       "Turns the arm's mass, damping and stiffness into those of its rotation: times lever squared."},
      {"hand", "period_s", "period_s",
       NumberValue{HandRanges::period_s, [](S& s, double v) { s.hand.period_s = v; },
                   [](const S& s) { return s.hand.period_s; }},
       "Duration of one manoeuvre."},
      {"hand", "active_s", "active_s",
       NumberValue{HandRanges::active_s, [](S& s, double v) { s.hand.active_s = v; },
                   [](const S& s) { return s.hand.active_s; }},
       "After this time the hand leaves the soil and waits above it."},
      {"hand", "home_mm", "home_m",
       VectorValue{HandRanges::home_m.in(kMm), [](S& s, const Vec3& v) { s.hand.home_m = v * kMm; },
                   [](const S& s) { return millimetres(s.hand.home_m); }},
       "Where the manoeuvre starts and ends: x and y in the scene, z above the surface."},
      {"hand", "depth_mm", "depth_m",
       NumberValue{HandRanges::depth_m.in(kMm), [](S& s, double v) { s.hand.depth_m = v * kMm; },
                   [](const S& s) { return millimetres(s.hand.depth_m); }},
       "How far below the surface the tool's centre goes."},
      {"hand", "surface_mm", "surface_m",
       NumberValue{HandRanges::surface_m.in(kMm), [](S& s, double v) { s.hand.surface_m = v * kMm; },
                   [](const S& s) { return millimetres(s.hand.surface_m.value_or(kLeftOut)); }},
       "Height of the soil's surface over the floor, as the hand takes it; left out, it is measured."},
      {"hand", "reach_mm", "reach_m",
       NumberValue{HandRanges::reach_m.in(kMm), [](S& s, double v) { s.hand.reach_m = v * kMm; },
                   [](const S& s) { return millimetres(s.hand.reach_m); }},
       "How far to the sides the tool's centre goes."},
      {"hand", "max_force_n", "max_force_n",
       NumberValue{HandRanges::max_force_n, [](S& s, double v) { s.hand.max_force_n = v; },
                   [](const S& s) { return s.hand.max_force_n; }},
       "Largest force the device shows."},
      {"hand", "max_torque_nm", "max_torque_nm",
       NumberValue{HandRanges::max_torque_nm, [](S& s, double v) { s.hand.max_torque_nm = v; },
                   [](const S& s) { return s.hand.max_torque_nm; }},
       "Largest torque the device shows, N m."},

      {"loop", "duration_s", "duration_s",
       NumberValue{LoopRanges::duration_s, [](S& s, double v) { s.loop.duration_s = v; },
                   [](const S& s) { return s.loop.duration_s; }},
       "Simulated time; 0 runs until stopped."},
      {"loop", "paced", "paced",
       SwitchValue{[](S& s, bool v) { s.loop.paced = v; }, [](const S& s) { return s.loop.paced; }},
       "Whether a simulated second takes a second, or as little as it can."},
      {"loop", "filter_cutoff_hz", "filter_cutoff_hz",
       NumberValue{LoopRanges::filter_cutoff_hz, [](S& s, double v) { s.loop.filter_cutoff_hz = v; },
                   [](const S& s) { return s.loop.filter_cutoff_hz; }},
       "Cutoff of the low-pass filter of force and torque (paper, II-E)."},
      {"loop", "cpu", "cpu",
       CountValue{LoopRanges::cpu, [](S& s, std::int64_t v) { s.loop.cpu = static_cast<int>(v); },
                  [](const S& s) -> std::int64_t { return s.loop.cpu; }},
       "The only CPU that the loop's thread runs on; -1 leaves it to the system."},

      {"device", "kind", "",
       WordValue{namesOf(kDeviceWords), [](S& s, std::string_view v) { s.device.kind = valueOf(kDeviceWords, v); },
                 [](const S& s) { return wordFor(kDeviceWords, s.device.kind); }},
       "What the hand holds (devices.md); [hand] moves the virtual hand, a person the others."},
      {"device", "id", "",
       TextValue{[](S& s, std::string_view v) { s.device.id = v; },
                 [](const S& s) -> std::string_view { return s.device.id; }},
       "Which one, where there are several: as `haptolith devices` names them."},
      {"device", "address", "",
       TextValue{[](S& s, std::string_view v) { s.device.address = v; },
                 [](const S& s) -> std::string_view { return s.device.address; }},
       "Where `network` listens [127.0.0.1:9050], or the service of `inverse3` is [ws://localhost:10001]."},

      {"device", "delay_ms", "delay_s",
       NumberValue{DeviceRanges::delay_s.in(kMs), [](S& s, double v) { s.device.delay_s = v * kMs; },
                   [](const S& s) { return inUnits(s.device.delay_s.value_or(kLeftOut), kMs); }},
       "How much later than the next millisecond a force acts on what the device reports, as measured; left out: what "
       "the "
       "driver assumes."},
      {"device", "resolution_mm", "resolution_m",
       NumberValue{DeviceRanges::resolution_m.in(kMm), [](S& s, double v) { s.device.resolution_m = v * kMm; },
                   [](const S& s) { return millimetres(s.device.resolution_m.value_or(kLeftOut)); }},
       "Steps or noise of the positions it reports, whichever is larger, as measured; left out: what the driver "
       "assumes."},

      {"mapping", "offset_mm", "offset_m",
       VectorValue{MappingRanges::offset_m.in(kMm), [](S& s, const Vec3& v) { s.handling.mapping.offset_m = v * kMm; },
                   [](const S& s) { return millimetres(s.handling.mapping.offset_m); }},
       "Where the middle of the device's workspace lies: x and y in the scene, z above the surface."},
      {"mapping", "turn_deg", "turn_rad",
       VectorValue{MappingRanges::turn_rad.in(kDegree),
                   [](S& s, const Vec3& v) { s.handling.mapping.turn_rad = v * kDegree; },
                   [](const S& s) -> Vec3 {
                     return s.handling.mapping.turn_rad.unaryExpr([](double x) { return inUnits(x, kDegree); });
                   }},
       "Turns what is right, away and up for a person at the device from the scene's x, y and z: about its x, then y, "
       "then z."},
      {"mapping", "scale", "scale",
       NumberValue{MappingRanges::scale, [](S& s, double v) { s.handling.mapping.scale = v; },
                   [](const S& s) { return s.handling.mapping.scale; }},
       "Metres in the scene for a metre at the device."},
      {"mapping", "force_scale", "force_scale",
       NumberValue{MappingRanges::force_scale, [](S& s, double v) { s.handling.mapping.force_scale = v; },
                   [](const S& s) { return s.handling.mapping.force_scale; }},
       "Newtons at the hand for a newton on the tool."},
      {"mapping", "clutch_button", "clutch_button",
       CountValue{MappingRanges::clutch_button,
                  [](S& s, std::int64_t v) { s.handling.mapping.clutch_button = static_cast<int>(v); },
                  [](const S& s) -> std::int64_t { return s.handling.mapping.clutch_button; }},
       "While this button is down the tool stays where it is and the hand feels nothing; -1: none."},
      {"mapping", "gripper", "",
       SwitchValue{[](S& s, bool v) { s.handling.mapping.gripper = v; },
                   [](const S& s) { return s.handling.mapping.gripper; }},
       "Whether the gripper opens and closes the tool's jaws, where both have some."},

      {"coupling", "kind", "",
       WordValue{namesOf(kCouplingWords),
                 [](S& s, std::string_view v) { s.handling.coupling.kind = valueOf(kCouplingWords, v); },
                 [](const S& s) { return wordFor(kCouplingWords, s.handling.coupling.kind); }},
       "The tool is where the hand is, as in the paper; or a spring and a damper pull it there; `auto`: direct where "
       "the device shows force at most 1 ms late and reports positions to 0.02 mm."},
      {"coupling", "stiffness_n_m", "stiffness_n_m",
       NumberValue{CouplingRanges::stiffness_n_m, [](S& s, double v) { s.handling.coupling.spring.stiffness_n_m = v; },
                   [](const S& s) { return s.handling.coupling.spring.stiffness_n_m; }},
       "Stiffness of the spring; this and the rest for `virtual`."},
      {"coupling", "damping_n_s_m", "damping_n_s_m",
       NumberValue{CouplingRanges::damping_n_s_m, [](S& s, double v) { s.handling.coupling.spring.damping_n_s_m = v; },
                   [](const S& s) { return s.handling.coupling.spring.damping_n_s_m; }},
       "Damping of the damper."},
      {"coupling", "mass_kg", "mass_kg",
       NumberValue{CouplingRanges::mass_kg, [](S& s, double v) { s.handling.coupling.spring.mass_kg = v; },
                   [](const S& s) { return s.handling.coupling.spring.mass_kg; }},
       "Mass that the tool has then; enough for a tick to follow spring and damper."},
      {"coupling", "lever_mm", "lever_m",
       NumberValue{CouplingRanges::lever_m.in(kMm),
                   [](S& s, double v) { s.handling.coupling.spring.lever_m = v * kMm; },
                   [](const S& s) { return millimetres(s.handling.coupling.spring.lever_m); }},
       "Turns mass, damping and stiffness into those of its rotation: times lever squared."},
      {"coupling", "max_force_n", "max_force_n",
       NumberValue{CouplingRanges::max_force_n, [](S& s, double v) { s.handling.coupling.max_force_n = v; },
                   [](const S& s) { return s.handling.coupling.max_force_n; }},
       "The spring pulls no harder, and turns no harder than this times the lever."},

      {"safety", "soft_start_s", "soft_start_s",
       NumberValue{SafetyRanges::soft_start_s, [](S& s, double v) { s.handling.safety.soft_start_s = v; },
                   [](const S& s) { return s.handling.safety.soft_start_s; }},
       "Forces grow from nothing in this time, at first and after every interruption; not at a simulated hand."},
      {"safety", "soft_stop_s", "soft_stop_s",
       NumberValue{SafetyRanges::soft_stop_s, [](S& s, double v) { s.handling.safety.soft_stop_s = v; },
                   [](const S& s) { return s.handling.safety.soft_stop_s; }},
       "Forces fall to nothing in this time when a run ends in good order; not at a simulated hand."},
      {"safety", "most_misses", "most_misses",
       CountValue{SafetyRanges::most_misses,
                  [](S& s, std::int64_t v) { s.handling.safety.most_misses = static_cast<int>(v); },
                  [](const S& s) -> std::int64_t { return s.handling.safety.most_misses; }},
       "Deadlines missed in a row that are borne before the hand is let go; not at a simulated hand."},
      {"safety", "heartbeat_ms", "heartbeat_s",
       NumberValue{SafetyRanges::heartbeat_s.in(kMs), [](S& s, double v) { s.handling.safety.heartbeat_s = v * kMs; },
                   [](const S& s) { return inUnits(s.handling.safety.heartbeat_s, kMs); }},
       "Without a tick for so long the hand is let go from outside the loop; not at a simulated hand."},
      {"safety", "calm_s", "calm_s",
       NumberValue{SafetyRanges::calm_s, [](S& s, double v) { s.handling.safety.calm_s = v; },
                   [](const S& s) { return s.handling.safety.calm_s; }},
       "All must have been well for so long before forces come back."},
      {"safety", "passivity", "",
       SwitchValue{[](S& s, bool v) { s.handling.safety.passivity = v; },
                   [](const S& s) { return s.handling.safety.passivity; }},
       "Whether energy that soil could not give is damped."},
      {"safety", "max_force_n", "max_force_n",
       NumberValue{SafetyRanges::max_force_n, [](S& s, double v) { s.handling.safety.max_force_n = v; },
                   [](const S& s) { return limitOrLeftOut(s.handling.safety.max_force_n); }},
       "Largest force at the hand; left out: what the device declares."},
      {"safety", "max_torque_nm", "max_torque_nm",
       NumberValue{SafetyRanges::max_torque_nm, [](S& s, double v) { s.handling.safety.max_torque_nm = v; },
                   [](const S& s) { return limitOrLeftOut(s.handling.safety.max_torque_nm); }},
       "Largest torque at the hand; left out: what the device declares, N m."},
  };
}

}  // namespace

std::span<const ScenarioKey> scenarioKeys() {
  static const std::vector<ScenarioKey> kKeys = allKeys();
  return kKeys;
}

}  // namespace haptolith

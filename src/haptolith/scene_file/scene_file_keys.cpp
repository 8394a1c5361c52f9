#include "haptolith/scene_file/scene_file_keys.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>

#include "haptolith/core/base64.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/scene_file/built_in_soils.h"
#include "haptolith/scene_file/built_in_tools.h"
#include "haptolith/scene_file/given_grains.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/scene_file/toml/member_keys.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/presets.h"

namespace haptolith {

namespace {

using S = SceneFile;
using Keys = std::vector<SceneFileKey>;
using NumberValue = SceneFileKey::NumberValue;
using VectorValue = SceneFileKey::VectorValue;
using WordValue = SceneFileKey::WordValue;
using TextValue = SceneFileKey::TextValue;
using DataValue = SceneFileKey::DataValue;
using PathValue = SceneFileKey::PathValue;

constexpr Range kGravityAxis_m_s2{-BedRanges::gravity_m_s2.highest, BedRanges::gravity_m_s2.highest};

/// A limit that may be left out.
double limitOrLeftOut(double limit) {
  return limit == DeviceLimits::kNone ? kLeftOut : limit;
}

void setGravity(SceneFile& scene, const Vec3& direction, double magnitude_m_s2) {
  scene.bed.gravity_m_s2 = direction.normalized() * magnitude_m_s2;
}

void setTool(SceneFile& scene, std::string_view name) {
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

/// The radius rescales the preset or named soil; the numbers after it are taken as they are, for particles of that
/// radius.
SceneFileKey soilNumber(const SoilNumber& number) {
  if (number.member == &SoilParameters::radius_m) {
    return {"soil", "radius_mm", std::string(number.key),
            NumberValue{number.valid.in(kMillimetres.in_si),
                        [](S& s, double v) { s.bed.soil = rescaled(s.bed.soil, v * kMillimetres.in_si); },
                        [](const S& s) { return inUnits(s.bed.soil.radius_m, kMillimetres.in_si); }},
            number.meaning};
  }
  return {"soil", number.key, std::string(number.key),
          NumberValue{number.valid,
                      [number](S& s, double v) {
                        if (number.makesPreset()) {
                          s.preset.clear();
                        }
                        s.bed.soil.*number.member = v;
                      },
                      [number](const S& s) { return s.bed.soil.*number.member; }},
          number.meaning};
}

/// The friction comes before the numbers that only one model of it uses.
Keys keysOfSoil() {
  const auto soil = memberKeys<S>("soil", &S::bed, &BedParameters::soil);
  Keys keys{
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
       "A soil file (soils.md), next to the scene file; instead of a preset, a name or the numbers of a soil."},
  };
  const auto* of_model = std::ranges::find_if(kSoilNumbers, [](const SoilNumber& n) { return n.model.has_value(); });
  std::transform(kSoilNumbers.begin(), of_model, std::back_inserter(keys), soilNumber);
  keys.push_back(soil.word(
      "friction", &SoilParameters::friction, kFrictionWords,
      "Friction model: friction against absolute space, as in the paper (14), or between particles in contact."));
  std::transform(of_model, kSoilNumbers.end(), std::back_inserter(keys), soilNumber);
  return keys;
}

Keys keysOfWorld() {
  const auto names = memberKeys<S>("names");
  return {
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
       "Direction of gravity, of any length except 0."},
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
      names.text("preset", &S::preset, "Name of the preset."),
      names.text("soil", &S::soil_name, "Name of the soil."),
      names.text("body", &S::body, "Name of the celestial body."),
      {"names", "mesh", "",
       TextValue{[](S& s, std::string_view v) { s.mesh.name = v; },
                 [](const S& s) { return s.mesh.bytes ? std::string_view(s.mesh.name) : std::string_view(); }},
       "Name of the tool's mesh file."},
  };
}

Keys keysOfBed() {
  const auto bed = memberKeys<S>("bed", &S::bed);
  const auto grading = memberKeys<S>("bed", &S::bed, &BedParameters::grading);
  return {
      bed.word(
          "start", &BedParameters::start, kBedStartWords,
          "Initial state of the soil: `particles` in `layers`; closely packed up to `depth_mm`; dropped at random; "
          "settled and levelled at `depth_mm`, at rest, in periodic tiles (below); or at the positions of `grains`."),
      {"bed", "grains", "",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   s.bed.given = readGrains(v, s.bed.soil.radius_m);
                   s.bed.start = BedStart::kGiven;
                 },
                 kOnlyRead},
       "Position of each particle: a .csv file next to the scene file (below), as written by `haptolith import`. "
       "Implies `start`."},
      {"bed", "grains_data", "",
       DataValue{[](S& s, std::string_view v) { readGrainsData(s.bed.given, v); },
                 [](const S& s) { return grainsData(s.bed.given); }},
       "Written by the program instead of `grains`: number of held particles, a colon, and all numbers in base64."},
      bed.count("particles", &BedParameters::particles, BedRanges::particles,
                "Number of macroparticles; for `count` and `rain`."),
      bed.count("layers", &BedParameters::layers, BedRanges::layers, "Number of layers; for `count`."),
      bed.number("width_mm", &BedParameters::width_m, BedRanges::length_m, kMillimetres,
                 "Inner size of the box along x; at least a particle."),
      bed.number("length_mm", &BedParameters::length_m, BedRanges::length_m, kMillimetres,
                 "Inner size of the box along y; at least a particle."),
      bed.number("depth_mm", &BedParameters::depth_m, BedRanges::length_m, kMillimetres,
                 "Height of the undisturbed soil; for `packed` and `settled`; at least a particle."),
      bed.count("seed", &BedParameters::seed, BedRanges::seed,
                "Seed of the random numbers; for `rain`, `settled` and finer grains. One seed, one bed."),
      bed.onOrOff("ready_made", &BedParameters::ready_made,
                  "Whether settled soil that ships with the program is taken, where there is some of this soil, "
                  "radius, depth, gravity and seed, instead of letting it settle here; for `settled`."),
      grading.number("fine_radius_mm", &Grading::fine_radius_m, BedRanges::fine_radius_m, kMillimetres,
                     "Radius of finer grains where soil is felt: the soil's halved once, twice or three times, with "
                     "shells of the sizes between around them; 0: grains are all alike."),
      grading.number("fine_width_mm", &Grading::fine_width_m, BedRanges::fine_length_m, kMillimetres,
                     "Size of the soil with the finest grains along x."),
      grading.number("fine_length_mm", &Grading::fine_length_m, BedRanges::fine_length_m, kMillimetres,
                     "Size of the soil with the finest grains along y."),
      grading.number("fine_depth_mm", &Grading::fine_depth_m, BedRanges::fine_length_m, kMillimetres,
                     "How deep the finest grains go below the surface."),
      grading.number("fine_x_mm", &Grading::fine_x_m, BedRanges::fine_place_m, kMillimetres,
                     "Middle of the soil with the finest grains along x."),
      grading.number("fine_y_mm", &Grading::fine_y_m, BedRanges::fine_place_m, kMillimetres,
                     "Middle of the soil with the finest grains along y."),
      bed.onOrOff("sleep", &BedParameters::sleep,
                  "Whether soil at rest is not computed until something near it moves."),
      bed.number("sleep_speed_m_s", &BedParameters::sleep_speed_m_s, BedRanges::sleep_speed_m_s,
                 "What moves faster is not at rest. 0 changes no bit, the default next to nothing, and 0.01 with a "
                 "sleep_distance_mm of a hundredth of a radius lets far more of a large bed sleep."),
      {"bed", "sleep_distance_mm", "sleep_distance_m",
       NumberValue{BedRanges::sleep_distance_m.in(kMillimetres.in_si),
                   [](S& s, double v) { s.bed.sleep_distance_m = v * kMillimetres.in_si; },
                   [](const S& s) { return s.bed.sleep_distance_m / kMillimetres.in_si; }},
       "Nor is at rest what has gone further from where it came to rest; 0: as far as it goes at sleep_speed_m_s in 20 "
       "ms."},
      bed.count("threads", &BedParameters::threads, BedRanges::threads,
                "Threads that share a tick; the result is the same for any number."),
      bed.count("max_substeps", &BedParameters::max_substeps, BedRanges::max_substeps,
                "A soil that would need more steps in a tick to be stable is refused."),
  };
}

Keys keysOfStones() {
  const auto stones = memberKeys<S>("stones", &S::bed, &BedParameters::stones);
  return {
      stones.count("count", &StonesParameters::count, StonesRanges::count,
                   "Stones at random positions in the soil, in addition to each [[stone]]."),
      {"stones", "shape", "form",
       WordValue{{kStoneFormWords[0].name, kStoneFormWords[1].name},
                 [](S& s, std::string_view v) { s.bed.stones.form = valueOf(kStoneFormWords, v); },
                 [](const S& s) { return wordFor(kStoneFormWords, s.bed.stones.form); }},
       "Angular rocks, or spheres."},
      stones.number("smallest_mm", &StonesParameters::smallest_m, kStoneSize_m, kMillimetres,
                    "Smallest diameter of a sphere of equal volume."),
      stones.number("largest_mm", &StonesParameters::largest_m, kStoneSize_m, kMillimetres,
                    "Largest diameter of a sphere of equal volume."),
      stones.number("exponent", &StonesParameters::exponent, StonesRanges::exponent,
                    "How many are larger than D goes as D to the minus this (below)."),
      stones.number("shallowest_mm", &StonesParameters::shallowest_m, StonesRanges::depth_m, kMillimetres,
                    "How deep the middle of the shallowest lies below the surface; below 0: above it."),
      stones.number("deepest_mm", &StonesParameters::deepest_m, StonesRanges::depth_m, kMillimetres,
                    "How deep that of the deepest does."),
      stones.count("seed", &StonesParameters::seed, StonesRanges::seed, "Seed of their sizes, shapes and places."),
      stones.onOrOff("fixed", &StonesParameters::fixed, "Whether they stay where they are, whatever pushes them."),
      stones.number("density_kg_m3", &StonesParameters::density_kg_m3, StonesRanges::density_kg_m3,
                    "Density of all stones, including each [[stone]]."),
  };
}

/// Of `mesh_sheet_mm`, whose number has another name.
constexpr KeyUnit kSheetMillimetres{kMillimetres.in_si, "mesh_sheet_mm", "sheet_thickness_m"};

Keys keysOfTool() {
  const auto tool = memberKeys<S>("tool", &S::tool);
  const auto mesh = memberKeys<S>("tool", &S::mesh);
  return {
      tool.word("shape", &ToolParameters::shape, kToolShapeWords,
                "Shape of the tool: the shovel, a sphere, a flat round plate, an upright cylinder, two jaws that open "
                "along x, or a `mesh`."),
      {"tool", "name", "",
       WordValue{namesOf(builtInTools()), [](S& s, std::string_view v) { setTool(s, v); }, kOnlyRead},
       "A tool that the program brings along, drawn to size (below); instead of `shape` and `mesh`."},
      tool.vector("size_mm", &ToolParameters::size_m, ToolRanges::length_m, kMillimetres,
                  "Edges of the `box` along its x, y and z; of each of the `jaws` along z, y and x."),
      tool.number("diameter_mm", &ToolParameters::diameter_m, ToolRanges::length_m, kMillimetres,
                  "Diameter of the `sphere`, `plate` or `cylinder`."),
      tool.number("thickness_mm", &ToolParameters::thickness_m, ToolRanges::length_m, kMillimetres,
                  "Height of the `plate`."),
      tool.number("opening_mm", &ToolParameters::opening_m, ToolRanges::length_m, kMillimetres,
                  "How far apart the `jaws` are when they are wide open; bent ones at their ends."),
      tool.number("jaw_bend_deg", &ToolParameters::jaw_bend_rad, ToolRanges::jaw_bend_rad, kDegrees,
                  "By how much each of the `jaws` is bent to a shell that bulges outwards; 0: flat plates."),
      tool.number("length_mm", &ToolParameters::length_m, ToolRanges::length_m, kMillimetres,
                  "Length of the `cylinder` along its axis."),
      mesh.number("mesh_unit_mm", &ToolMeshSource::unit_m, kMeshUnit_m, kMillimetres,
                  "What a 1 in an STL or OBJ file is: 1 of a file in millimetres, 25.4 of one in inches, 1000 of one "
                  "in metres. glTF is in metres, whatever this says."),
      mesh.number("mesh_sheet_mm", &ToolMeshSource::sheet_thickness_m, kSheetThickness_m, kSheetMillimetres,
                  "How thick a surface is that is not closed; 0: it has to be closed."),
      mesh.vector("mesh_origin_mm", &ToolMeshSource::origin_m, ToolMeshRanges::origin_m, kMillimetres,
                  "Which point of the mesh the hand holds, in the file's coordinates times its unit; left out: the "
                  "middle of the box around it."),
      mesh.vector("mesh_turn_deg", &ToolMeshSource::turn_rad, ToolMeshRanges::turn_rad, kDegrees,
                  "How the mesh is turned in the hand: about x, then y, then z."),
      {"tool", "mesh", "",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   readInto(s.mesh, v);
                   s.tool.shape = ToolShape::kMesh;
                 },
                 kOnlyRead},
       "Mesh of the tool: an .stl, .obj, .glb or .gltf file, next to the scene file. Implies `shape`."},
      {"tool", "mesh_data", "",
       DataValue{[](S& s, std::string_view v) { readData(s.mesh, v); }, [](const S& s) { return dataOf(s.mesh); }},
       "Written by the program instead of `mesh`: format of the file, a colon, and the file in base64."},
      tool.number("stiffness_n_m", &ToolParameters::stiffness_n_m, ToolRanges::stiffness_n_m,
                  "Stiffness between tool and particle (paper 21)."),
      tool.number("damping_factor", &ToolParameters::damping_factor, ToolRanges::damping_factor,
                  "Damping between tool and particle, over half a tick times the stiffness (paper, II-E)."),
      tool.number("adhesion_ratio", &ToolParameters::adhesion_ratio, ToolRanges::adhesion_ratio,
                  "How many radii outside the tool a particle still sticks to it (paper 21); with `paper` friction of "
                  "the soil."),
      tool.number("friction", &ToolParameters::friction, ToolRanges::friction,
                  "Friction between soil and tool, tan(delta); with `contact` friction of the soil."),
      tool.number(
          "adhesion_n", &ToolParameters::adhesion_n, ToolRanges::adhesion_n,
          "Largest pull of a contact with the tool, and what it adds to the normal force; with `contact` friction."),
      tool.number(
          "mass_kg", &ToolParameters::mass_kg, ToolRanges::mass_kg,
          "Mass of the tool that the hand feels as its weight, and with a virtual coupling as its inertia; 0: none."),
      tool.vector("centre_of_mass_mm", &ToolParameters::centre_of_mass_m, ToolRanges::centre_of_mass_m, kMillimetres,
                  "Where that mass has its centre, from the tool's origin, in the tool's frame."),
  };
}

Keys keysOfHand() {
  const auto hand = memberKeys<S>("hand", &S::hand);
  return {
      hand.word("manoeuvre", &HandParameters::manoeuvre, kManoeuvreWords, "Motion of the hand, which repeats."),
      {"hand", "poses", "poses",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   s.hand.poses_file = v.string();
                   s.hand.manoeuvre = Manoeuvre::kPoses;
                 },
                 [](const S& s) {
                   return s.hand.manoeuvre == Manoeuvre::kPoses ? std::filesystem::absolute(s.hand.poses_file)
                                                                : std::filesystem::path();
                 }},
       "A recorded movement: CSV with `t_s,x_m,y_m,z_m,qw,qx,qy,qz`, next to the scene file. Implies `manoeuvre`."},
      hand.word("compliance", &HandParameters::compliance, kHandComplianceWords,
                "Whether the hand yields to force like an arm or follows the motion exactly."),
      hand.number("mass_kg", &HandParameters::mass_kg, HandRanges::mass_kg, "Mass of the arm as the hand feels it."),
      hand.number("damping_n_s_m", &HandParameters::damping_n_s_m, HandRanges::damping_n_s_m, "Damping of the arm."),
      hand.number("stiffness_n_m", &HandParameters::stiffness_n_m, HandRanges::stiffness_n_m, "Stiffness of the arm."),
      hand.number("lever_mm", &HandParameters::lever_m, HandRanges::lever_m, kMillimetres,
                  "Turns the arm's mass, damping and stiffness into those of its rotation: times lever squared."),
      hand.number("period_s", &HandParameters::period_s, HandRanges::period_s, "Duration of one manoeuvre."),
      hand.number("active_s", &HandParameters::active_s, HandRanges::active_s,
                  "After this time the hand leaves the soil and waits above it."),
      hand.vector("home_mm", &HandParameters::home_m, HandRanges::home_m, kMillimetres,
                  "Where the manoeuvre starts and ends: x and y in the scene, z above the surface."),
      hand.number("depth_mm", &HandParameters::depth_m, HandRanges::depth_m, kMillimetres,
                  "How far below the surface the tool's centre goes."),
      hand.number("surface_mm", &HandParameters::surface_m, HandRanges::surface_m, kMillimetres,
                  "Height of the soil's surface over the floor, as the hand takes it; left out, it is measured."),
      hand.number("reach_mm", &HandParameters::reach_m, HandRanges::reach_m, kMillimetres,
                  "How far to the sides the tool's centre goes."),
      hand.number("max_force_n", &HandParameters::max_force_n, HandRanges::max_force_n,
                  "Largest force the device shows."),
      hand.number("max_torque_nm", &HandParameters::max_torque_nm, HandRanges::max_torque_nm,
                  "Largest torque the device shows, N m."),
  };
}

Keys keysOfLoop() {
  const auto loop = memberKeys<S>("loop", &S::loop);
  const auto device = memberKeys<S>("device", &S::device);
  const auto mapping = memberKeys<S>("mapping", &S::handling, &HandlingParameters::mapping);
  return {
      loop.number("duration_s", &LoopParameters::duration_s, LoopRanges::duration_s,
                  "Simulated time; 0 runs until stopped."),
      loop.onOrOff("paced", &LoopParameters::paced,
                   "Whether a simulated second takes a second, or as little as it can."),
      loop.number("filter_cutoff_hz", &LoopParameters::filter_cutoff_hz, LoopRanges::filter_cutoff_hz,
                  "Cutoff of the low-pass filter of force and torque (paper, II-E)."),
      loop.count("cpu", &LoopParameters::cpu, LoopRanges::cpu,
                 "The only CPU that the loop's thread runs on; -1 leaves it to the system."),

      device.word("kind", &DeviceParameters::kind, kDeviceWords,
                  "Haptic device (devices.md); [hand] moves the virtual hand, a user moves the others."),
      device.text("id", &DeviceParameters::id,
                  "Device to use when several are connected, as listed by `haptolith devices`."),
      device.text("address", &DeviceParameters::address,
                  "Where `network` listens [127.0.0.1:9050], or the service of `inverse3` is [ws://localhost:10001]."),
      device.number("delay_ms", &DeviceParameters::delay_s, DeviceRanges::delay_s, kMilliseconds,
                    "How much later than the next millisecond a force acts on what the device reports, as measured; "
                    "left out: what the driver assumes."),
      device.number("resolution_mm", &DeviceParameters::resolution_m, DeviceRanges::resolution_m, kMillimetres,
                    "Steps or noise of the positions it reports, whichever is larger, as measured; left out: what the "
                    "driver assumes."),

      mapping.vector("offset_mm", &MappingParameters::offset_m, MappingRanges::offset_m, kMillimetres,
                     "Where the middle of the device's workspace lies: x and y in the scene, z above the surface."),
      mapping.vector("turn_deg", &MappingParameters::turn_rad, MappingRanges::turn_rad, kDegrees,
                     "Turns what is right, away and up for a person at the device from the scene's x, y and z: about "
                     "its x, then y, then z."),
      mapping.number("scale", &MappingParameters::scale, MappingRanges::scale,
                     "Metres in the scene for a metre at the device."),
      mapping.number("force_scale", &MappingParameters::force_scale, MappingRanges::force_scale,
                     "Newtons at the hand for a newton on the tool."),
      mapping.count("clutch_button", &MappingParameters::clutch_button, MappingRanges::clutch_button,
                    "While this button is pressed, the tool stays in place and no force is rendered; -1: none."),
      mapping.onOrOff("gripper", &MappingParameters::gripper,
                      "Whether the gripper opens and closes the tool's jaws, where both have some."),
  };
}

Keys keysOfHandling() {
  const auto coupling = memberKeys<S>("coupling", &S::handling, &HandlingParameters::coupling);
  const auto spring =
      memberKeys<S>("coupling", &S::handling, &HandlingParameters::coupling, &CouplingParameters::spring);
  const auto safety = memberKeys<S>("safety", &S::handling, &HandlingParameters::safety);
  return {
      coupling.word("kind", &CouplingParameters::kind, kCouplingWords,
                    "The tool is where the hand is, as in the paper; or a spring and a damper pull it there; `auto`: "
                    "direct where the device shows force at most 1 ms late and reports positions to 0.02 mm."),
      spring.number("stiffness_n_m", &ArmParameters::stiffness_n_m, CouplingRanges::stiffness_n_m,
                    "Stiffness of the spring; this and the rest for `virtual`."),
      spring.number("damping_n_s_m", &ArmParameters::damping_n_s_m, CouplingRanges::damping_n_s_m,
                    "Damping of the damper."),
      spring.number("mass_kg", &ArmParameters::mass_kg, CouplingRanges::mass_kg,
                    "Mass that the tool has then; enough for a tick to follow spring and damper."),
      spring.number("lever_mm", &ArmParameters::lever_m, CouplingRanges::lever_m, kMillimetres,
                    "Turns mass, damping and stiffness into those of its rotation: times lever squared."),
      coupling.number("max_force_n", &CouplingParameters::max_force_n, CouplingRanges::max_force_n,
                      "The spring pulls no harder, and turns no harder than this times the lever."),

      safety.number(
          "soft_start_s", &SafetyParameters::soft_start_s, SafetyRanges::soft_start_s,
          "Time in which forces rise from zero, at the start and after every interruption; not with a simulated hand."),
      safety.number("soft_stop_s", &SafetyParameters::soft_stop_s, SafetyRanges::soft_stop_s,
                    "Time in which forces fall to zero at a regular end of a run; not with a simulated hand."),
      safety.count("most_misses", &SafetyParameters::most_misses, SafetyRanges::most_misses,
                   "Tolerated number of consecutive missed deadlines before a safety trip; not with a simulated hand."),
      safety.number("heartbeat_ms", &SafetyParameters::heartbeat_s, SafetyRanges::heartbeat_s, kMilliseconds,
                    "Time without a tick after which the watchdog sets the force to zero; not with a simulated hand."),
      safety.number("calm_s", &SafetyParameters::calm_s, SafetyRanges::calm_s,
                    "Duration without a fault before forces return."),
      safety.onOrOff("passivity", &SafetyParameters::passivity, "Whether energy that soil could not give is damped."),
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

Keys allKeys() {
  const auto scene = memberKeys<S>("");
  Keys keys{
      scene.text("title", &S::title, "Title of the scene, on one line."),
  };
  for (const auto& table :
       {keysOfSoil, keysOfWorld, keysOfBed, keysOfStones, keysOfTool, keysOfHand, keysOfLoop, keysOfHandling}) {
    std::ranges::move(table(), std::back_inserter(keys));
  }
  return keys;
}

}  // namespace

std::span<const SceneFileKey> sceneFileKeys() {
  static const std::vector<SceneFileKey> kKeys = allKeys();
  return kKeys;
}

}  // namespace haptolith

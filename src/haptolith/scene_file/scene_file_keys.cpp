#include "haptolith/scene_file/scene_file_keys.h"

#include <algorithm>
#include <array>
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
       "Soil of the ICRA 2021 paper (Table II); excludes the numbers that define a soil."},
      {"soil", "name", "",
       WordValue{namesOf(builtInSoils()), [](S& s, std::string_view v) { setSoil(s, findSoil(v)); }, kOnlyRead},
       "Named soil; excludes `preset` and the numbers that define a soil."},
      {"soil", "file", "",
       PathValue{[](S& s, const std::filesystem::path& v) { setSoil(s, loadSoilFile(v)); }, kOnlyRead},
       "Soil file (soils.md), next to the scene file; excludes the same keys."},
  };
  const auto* of_model = std::ranges::find_if(kSoilNumbers, [](const SoilNumber& n) { return n.model.has_value(); });
  std::transform(kSoilNumbers.begin(), of_model, std::back_inserter(keys), soilNumber);
  keys.push_back(soil.word(
      "friction_model", &SoilParameters::friction, kFrictionWords,
      "Friction model: `icra2021` acts against absolute space (paper 14), `contact` between touching particles."));
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
       "Direction of gravity; any length except 0."},
      {"gravity", "body", "",
       WordValue{namesOf(bodies()),
                 [](S& s, std::string_view v) {
                   s.body = v;
                   setGravity(s, s.bed.gravity_m_s2, findBody(v).gravity_m_s2);
                 },
                 kOnlyRead},
       "Gravity of a celestial body; excludes `magnitude_m_s2`."},
      {"gravity", "magnitude_m_s2", "gravity_m_s2",
       NumberValue{BedRanges::gravity_m_s2,
                   [](S& s, double v) {
                     s.body.clear();
                     setGravity(s, s.bed.gravity_m_s2, v);
                   },
                   kOnlyRead},
       "Magnitude of gravity."},
      {"gravity", "vector_m_s2", "gravity_m_s2",
       VectorValue{kGravityAxis_m_s2,
                   [](S& s, const Vec3& v) {
                     s.body.clear();
                     s.bed.gravity_m_s2 = v;
                   },
                   [](const S& s) { return s.bed.gravity_m_s2; }},
       "Gravity vector; excludes the three other keys."},

      // Names that the program writes in addition to numbers.
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
      bed.word("start", &BedParameters::start, kBedStartWords,
               "Initial bed: `particles` in `layers`, close packing, random rain, settled and levelled, or positions "
               "from `grains`."),
      {"bed", "grains", "",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   s.bed.given = readGrains(v, s.bed.soil.radius_m);
                   s.bed.start = BedStart::kGiven;
                 },
                 kOnlyRead},
       "CSV file of particle positions, next to the scene file. Implies `start`."},
      {"bed", "grains_data", "",
       DataValue{[](S& s, std::string_view v) { readGrainsData(s.bed.given, v); },
                 [](const S& s) { return grainsData(s.bed.given); }},
       "Written by the program instead of `grains`: number of held particles, colon, numbers in base64."},
      bed.count("particles", &BedParameters::particles, BedRanges::particles,
                "Number of particles; `count` and `rain`."),
      bed.count("layers", &BedParameters::layers, BedRanges::layers, "Number of layers; `count`."),
      bed.number("width_mm", &BedParameters::width_m, BedRanges::length_m, kMillimetres,
                 "Inner size of the box along x, at least a particle."),
      bed.number("length_mm", &BedParameters::length_m, BedRanges::length_m, kMillimetres,
                 "Inner size of the box along y, at least a particle."),
      bed.number("depth_mm", &BedParameters::depth_m, BedRanges::length_m, kMillimetres,
                 "Height of the undisturbed soil, at least a particle; `packed` and `settled`."),
      bed.count("seed", &BedParameters::seed, BedRanges::seed,
                "Random seed; `rain`, `settled` and graded beds. One seed gives one bed."),
      bed.onOrOff("ready_made", &BedParameters::ready_made,
                  "Use the shipped settled tile where soil, radius, depth, gravity and seed match; `settled`."),
      grading.number("fine_radius_mm", &Grading::fine_radius_m, BedRanges::fine_radius_m, kMillimetres,
                     "Finest radius of a graded bed: R/2, R/4 or R/8; 0: one size."),
      grading.number("fine_width_mm", &Grading::fine_width_m, BedRanges::fine_length_m, kMillimetres,
                     "Size of the finest region along x."),
      grading.number("fine_length_mm", &Grading::fine_length_m, BedRanges::fine_length_m, kMillimetres,
                     "Size of the finest region along y."),
      grading.number("fine_depth_mm", &Grading::fine_depth_m, BedRanges::fine_length_m, kMillimetres,
                     "Depth of the finest region below the surface."),
      grading.number("fine_x_mm", &Grading::fine_x_m, BedRanges::fine_place_m, kMillimetres,
                     "Centre of the finest region along x."),
      grading.number("fine_y_mm", &Grading::fine_y_m, BedRanges::fine_place_m, kMillimetres,
                     "Centre of the finest region along y."),
      bed.onOrOff("sleep", &BedParameters::sleep, "Skip particles at rest until something near them moves."),
      bed.number(
          "sleep_speed_m_s", &BedParameters::sleep_speed_m_s, BedRanges::sleep_speed_m_s,
          "Faster particles stay awake. 0 changes no bit; 0.01 with `sleep_distance_mm` = R/100 suits large beds."),
      {"bed", "sleep_distance_mm", "sleep_distance_m",
       NumberValue{BedRanges::sleep_distance_m.in(kMillimetres.in_si),
                   [](S& s, double v) { s.bed.sleep_distance_m = v * kMillimetres.in_si; },
                   [](const S& s) { return s.bed.sleep_distance_m / kMillimetres.in_si; }},
       "Particles further from their resting place stay awake; 0: 20 ms at `sleep_speed_m_s`."},
      bed.count("threads", &BedParameters::threads, BedRanges::threads,
                "Threads that share a tick; the result is the same for any number."),
      bed.count("max_substeps", &BedParameters::max_substeps, BedRanges::max_substeps,
                "A soil that needs more substeps per tick is refused."),
  };
}

Keys keysOfStones() {
  const auto stones = memberKeys<S>("stones", &S::bed, &BedParameters::stones);
  return {
      stones.count("count", &StonesParameters::count, StonesRanges::count,
                   "Stones at random positions, in addition to each [[stone]]."),
      {"stones", "shape", "form",
       WordValue{{kStoneFormWords[0].name, kStoneFormWords[1].name},
                 [](S& s, std::string_view v) { s.bed.stones.form = valueOf(kStoneFormWords, v); },
                 [](const S& s) { return wordFor(kStoneFormWords, s.bed.stones.form); }},
       "Angular rocks or spheres."},
      stones.number("smallest_mm", &StonesParameters::smallest_m, kStoneSize_m, kMillimetres,
                    "Smallest volume-equivalent diameter."),
      stones.number("largest_mm", &StonesParameters::largest_m, kStoneSize_m, kMillimetres,
                    "Largest volume-equivalent diameter."),
      stones.number("exponent", &StonesParameters::exponent, StonesRanges::exponent,
                    "The number of stones larger than D is proportional to D^-exponent."),
      stones.number("shallowest_mm", &StonesParameters::shallowest_m, StonesRanges::depth_m, kMillimetres,
                    "Smallest depth of a centre below the surface; below 0: above it."),
      stones.number("deepest_mm", &StonesParameters::deepest_m, StonesRanges::depth_m, kMillimetres,
                    "Largest depth of a centre below the surface."),
      stones.count("seed", &StonesParameters::seed, StonesRanges::seed, "Seed of sizes, shapes and positions."),
      stones.onOrOff("fixed", &StonesParameters::fixed, "The stones never move."),
      stones.number("density_kg_m3", &StonesParameters::density_kg_m3, StonesRanges::density_kg_m3,
                    "Density of all stones, each [[stone]] included."),
  };
}

/// Unit of `mesh_sheet_mm`, whose number has another name.
constexpr KeyUnit kSheetMillimetres{kMillimetres.in_si, "mesh_sheet_mm", "sheet_thickness_m"};

constexpr Range kJointAxis{-1e6, 1e6};

void setJointAxis(S& scene, const Vec3& direction) {
  constexpr double kRounding = 1e-12;
  if (direction.isZero(kRounding)) {
    throw InvalidParameter("joint_axis", "the zero vector", "a direction, for example [0, 1, 0]");
  }
  const bool is_unit = std::abs(direction.norm() - 1) < kRounding;  // a written axis is read with the same bits
  scene.tool.joint.axis = is_unit ? direction : Vec3(direction.normalized());
}

Keys keysOfTool() {
  const auto tool = memberKeys<S>("tool", &S::tool);
  const auto mesh = memberKeys<S>("tool", &S::mesh);
  const auto joint = memberKeys<S>("tool", &S::tool, &ToolParameters::joint);
  return {
      tool.word("shape", &ToolParameters::shape, kToolShapeWords,
                "The shovel (`box`), a sphere, a flat round plate, an upright cylinder, two jaws that open along x, or "
                "a `mesh`."),
      {"tool", "model", "",
       WordValue{namesOf(builtInTools()), [](S& s, std::string_view v) { setTool(s, v); }, kOnlyRead},
       "Built-in mesh; excludes `shape` and `mesh`."},
      tool.vector("size_mm", &ToolParameters::size_m, ToolRanges::length_m, kMillimetres,
                  "Edges of the `box` along its x, y and z; of each of the `jaws` along z, y and x."),
      tool.number("diameter_mm", &ToolParameters::diameter_m, ToolRanges::length_m, kMillimetres,
                  "Diameter of the `sphere`, `plate` or `cylinder`."),
      tool.number("thickness_mm", &ToolParameters::thickness_m, ToolRanges::length_m, kMillimetres,
                  "Height of the `plate`."),
      tool.number("opening_mm", &ToolParameters::opening_m, ToolRanges::length_m, kMillimetres,
                  "Largest distance between the `jaws`; if bent, at their ends."),
      tool.number("jaw_bend_deg", &ToolParameters::jaw_bend_rad, ToolRanges::jaw_bend_rad, kDegrees,
                  "Angle by which each of the `jaws` is bent to an outward shell; 0: flat."),
      tool.number("length_mm", &ToolParameters::length_m, ToolRanges::length_m, kMillimetres,
                  "Length of the `cylinder` along its axis."),
      mesh.number(
          "mesh_unit_mm", &ToolMeshSource::unit_m, kMeshUnit_m, kMillimetres,
          "Unit of an STL or OBJ file: 1 for millimetres, 25.4 for inches, 1000 for metres. glTF is in metres."),
      mesh.number("mesh_sheet_mm", &ToolMeshSource::sheet_thickness_m, kSheetThickness_m, kSheetMillimetres,
                  "Thickness given to an open surface; 0: the mesh must be closed."),
      mesh.vector(
          "mesh_origin_mm", &ToolMeshSource::origin_m, ToolMeshRanges::origin_m, kMillimetres,
          "Point of the mesh at the tool's origin, in scaled file coordinates; default: centre of its bounding box."),
      mesh.vector("mesh_turn_deg", &ToolMeshSource::turn_rad, ToolMeshRanges::turn_rad, kDegrees,
                  "Rotation of the mesh in the tool's frame: about x, then y, then z."),
      {"tool", "mesh", "",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   readInto(s.mesh, v);
                   s.tool.shape = ToolShape::kMesh;
                 },
                 kOnlyRead},
       "An .stl, .obj, .glb or .gltf file, next to the scene file. Implies `shape`."},
      {"tool", "mesh_data", "",
       DataValue{[](S& s, std::string_view v) { readData(s.mesh, v); }, [](const S& s) { return dataOf(s.mesh); }},
       "Written by the program instead of `mesh`: format, colon, file in base64."},
      tool.number("stiffness_n_m", &ToolParameters::stiffness_n_m, ToolRanges::stiffness_n_m,
                  "Stiffness between tool and particle (paper 21)."),
      tool.number("damping_factor", &ToolParameters::damping_factor, ToolRanges::damping_factor,
                  "Damping between tool and particle, over half a tick times the stiffness (paper, II-E)."),
      tool.number("adhesion_ratio", &ToolParameters::adhesion_ratio, ToolRanges::adhesion_ratio,
                  "Range of adhesion outside the tool, in radii (paper 21); `icra2021` soil only."),
      tool.number("friction", &ToolParameters::friction, ToolRanges::friction,
                  "Friction coefficient between soil and tool, tan(delta); `contact` soil only."),
      tool.number("adhesion_n", &ToolParameters::adhesion_n, ToolRanges::adhesion_n,
                  "Pull-off force of a contact with the tool, added to its normal force; `contact` soil only."),
      tool.number("mass_kg", &ToolParameters::mass_kg, ToolRanges::mass_kg,
                  "Mass rendered as weight and, with a virtual coupling, as inertia; 0: none."),
      tool.vector("centre_of_mass_mm", &ToolParameters::centre_of_mass_m, ToolRanges::centre_of_mass_m, kMillimetres,
                  "Centre of that mass from the tool's origin, tool's frame."),
      joint.word(
          "joint_drive", &Joint::drive, kDriveWords,
          "Drive of a joint between hand and tool: a motor that holds a speed or gives a torque, or none but the soil "
          "(`free`)."),
      {"tool", "joint_axis", "joint_axis",
       VectorValue{kJointAxis, setJointAxis, [](const S& s) { return s.tool.joint.axis; }},
       "Direction of that axis, tool's frame; required with a drive."},
      joint.vector("joint_point_mm", &Joint::point_m, JointRanges::point_m, kMillimetres,
                   "A point on that axis, from the tool's origin."),
      joint.number("joint_speed_rad_s", &Joint::speed_rad_s, JointRanges::speed_rad_s,
                   "Speed that the motor holds, or the first speed; right-handed about the axis."),
      joint.number("joint_torque_nm", &Joint::torque_nm, JointRanges::torque_nm, "Torque of the motor, N m."),
      {"tool", "joint_inertia_kg_m2", "joint_inertia_kg_m2",
       NumberValue{JointRanges::inertia_kg_m2, [](S& s, double v) { s.tool.joint.inertia_kg_m2 = v; },
                   [](const S& s) { return s.tool.joint.inertia_kg_m2 > 0 ? s.tool.joint.inertia_kg_m2 : kLeftOut; }},
       "Moment of inertia of the tool about the axis; required with `torque` or `free`."},
  };
}

Keys keysOfHand() {
  const auto hand = memberKeys<S>("hand", &S::hand);
  return {
      hand.word("motion", &HandParameters::motion, kHandMotionWords, "Motion that the hand repeats."),
      {"hand", "poses", "poses",
       PathValue{[](S& s, const std::filesystem::path& v) {
                   s.hand.poses_file = v.string();
                   s.hand.motion = HandMotion::kPoses;
                 },
                 [](const S& s) {
                   return s.hand.motion == HandMotion::kPoses ? std::filesystem::absolute(s.hand.poses_file)
                                                              : std::filesystem::path();
                 }},
       "Recorded motion: CSV with `t_s,x_m,y_m,z_m,qw,qx,qy,qz`, next to the scene file. Implies `motion`."},
      hand.word("compliance", &HandParameters::compliance, kHandComplianceWords,
                "Yield to force as an arm, or follow the motion exactly."),
      hand.number("mass_kg", &HandParameters::mass_kg, HandRanges::mass_kg, "Mass of the arm at the hand."),
      hand.number("damping_n_s_m", &HandParameters::damping_n_s_m, HandRanges::damping_n_s_m, "Damping of the arm."),
      hand.number("stiffness_n_m", &HandParameters::stiffness_n_m, HandRanges::stiffness_n_m, "Stiffness of the arm."),
      hand.number("lever_mm", &HandParameters::lever_m, HandRanges::lever_m, kMillimetres,
                  "Lever; rotational mass, damping and stiffness are the above times its square."),
      hand.number("period_s", &HandParameters::period_s, HandRanges::period_s, "Duration of one motion."),
      hand.number("active_s", &HandParameters::active_s, HandRanges::active_s,
                  "After this time the hand leaves the soil and waits above it."),
      hand.vector("home_mm", &HandParameters::home_m, HandRanges::home_m, kMillimetres,
                  "Start and end of the motion: x and y in the scene, z above the surface."),
      hand.vector("turn_deg", &HandParameters::turn_rad, HandRanges::turn_rad, kDegrees,
                  "Rotation of the tool in the hand: about x, then y, then z; not with `poses`."),
      hand.number("depth_mm", &HandParameters::depth_m, HandRanges::depth_m, kMillimetres,
                  "Depth of the tool's centre below the surface."),
      hand.number("surface_mm", &HandParameters::surface_m, HandRanges::surface_m, kMillimetres,
                  "Height of the surface over the floor that the hand assumes; default: the bed's."),
      hand.number("reach_mm", &HandParameters::reach_m, HandRanges::reach_m, kMillimetres,
                  "Lateral travel of the tool's centre."),
      hand.number("max_force_n", &HandParameters::max_force_n, HandRanges::max_force_n,
                  "Largest force of the simulated device."),
      hand.number("max_torque_nm", &HandParameters::max_torque_nm, HandRanges::max_torque_nm,
                  "Largest torque of the simulated device, N m."),
  };
}

Keys keysOfLoop() {
  const auto loop = memberKeys<S>("loop", &S::loop);
  const auto device = memberKeys<S>("device", &S::device);
  const auto mapping = memberKeys<S>("mapping", &S::handling, &HandlingParameters::mapping);
  return {
      loop.number("duration_s", &LoopParameters::duration_s, LoopRanges::duration_s,
                  "Simulated time; 0 runs until stopped."),
      loop.onOrOff("real_time", &LoopParameters::real_time, "Run in real time, or as fast as possible."),
      loop.number("filter_cutoff_hz", &LoopParameters::filter_cutoff_hz, LoopRanges::filter_cutoff_hz,
                  "Cutoff of the low-pass filter of force and torque (paper, II-E)."),
      loop.count("cpu", &LoopParameters::cpu, LoopRanges::cpu, "The only CPU of the loop's thread; -1: any."),

      device.word("kind", &DeviceParameters::kind, kDeviceWords,
                  "Type of device (devices.md); [hand] moves the virtual hand only."),
      device.text("id", &DeviceParameters::id, "Device among several, as `haptolith devices` names it."),
      device.text("address", &DeviceParameters::address,
                  "Where `network` listens [127.0.0.1:9050], or the service of `inverse3` is [ws://localhost:10001]."),
      device.number("delay_ms", &DeviceParameters::delay_s, DeviceRanges::delay_s, kMilliseconds,
                    "Measured latency from position to force, beyond the next millisecond; default: the driver's."),
      device.number("resolution_mm", &DeviceParameters::resolution_m, DeviceRanges::resolution_m, kMillimetres,
                    "Measured step or noise of positions, whichever is larger; default: the driver's."),

      mapping.vector("offset_mm", &MappingParameters::offset_m, MappingRanges::offset_m, kMillimetres,
                     "Centre of the device's workspace: x and y in the scene, z above the surface."),
      mapping.vector("turn_deg", &MappingParameters::turn_rad, MappingRanges::turn_rad, kDegrees,
                     "Rotation of the user's frame (right, away, up) into the scene's: about x, then y, then z."),
      mapping.number("scale", &MappingParameters::scale, MappingRanges::scale,
                     "Metres in the scene per metre at the device."),
      mapping.number("force_scale", &MappingParameters::force_scale, MappingRanges::force_scale,
                     "Newtons at the device per newton on the tool."),
      mapping.count("clutch_button", &MappingParameters::clutch_button, MappingRanges::clutch_button,
                    "While pressed, the tool stays and the force is zero; -1: none."),
      mapping.onOrOff("gripper", &MappingParameters::gripper,
                      "The gripper opens and closes the tool's jaws, where both exist."),
  };
}

Keys keysOfHandling() {
  const auto coupling = memberKeys<S>("coupling", &S::handling, &HandlingParameters::coupling);
  const auto spring =
      memberKeys<S>("coupling", &S::handling, &HandlingParameters::coupling, &CouplingParameters::spring);
  const auto safety = memberKeys<S>("safety", &S::handling, &HandlingParameters::safety);
  return {
      coupling.word("kind", &CouplingParameters::kind, kCouplingWords,
                    "Tool at the handle (direct, as in the ICRA 2021 paper), or pulled by a spring and a damper "
                    "(virtual); `auto`: direct where the device renders force at most 1 ms late and resolves 0.02 mm."),
      spring.number("stiffness_n_m", &ArmParameters::stiffness_n_m, CouplingRanges::stiffness_n_m,
                    "Stiffness of the spring; this and the rest: `virtual` only."),
      spring.number("damping_n_s_m", &ArmParameters::damping_n_s_m, CouplingRanges::damping_n_s_m,
                    "Damping of the damper."),
      spring.number("mass_kg", &ArmParameters::mass_kg, CouplingRanges::mass_kg,
                    "Mass of the tool; large enough for a tick to resolve spring and damper."),
      spring.number("lever_mm", &ArmParameters::lever_m, CouplingRanges::lever_m, kMillimetres,
                    "Lever; rotational mass, damping and stiffness are the above times its square."),
      coupling.number("max_force_n", &CouplingParameters::max_force_n, CouplingRanges::max_force_n,
                      "Force limit of the spring; its torque limit is this times the lever."),

      safety.number(
          "soft_start_s", &SafetyParameters::soft_start_s, SafetyRanges::soft_start_s,
          "Time in which forces rise from zero, at first and after each interruption; not for the virtual hand."),
      safety.number("soft_stop_s", &SafetyParameters::soft_stop_s, SafetyRanges::soft_stop_s,
                    "Time in which forces fall to zero at a regular end; not for the virtual hand."),
      safety.count("max_missed_deadlines", &SafetyParameters::max_missed_deadlines, SafetyRanges::max_missed_deadlines,
                   "Consecutive missed deadlines before a safety trip; not for the virtual hand."),
      safety.number("watchdog_timeout_ms", &SafetyParameters::watchdog_timeout_s, SafetyRanges::watchdog_timeout_s,
                    kMilliseconds, "Time without a tick until the watchdog trips; not for the virtual hand."),
      safety.number("recovery_s", &SafetyParameters::recovery_s, SafetyRanges::recovery_s,
                    "Time without a fault before forces return."),
      safety.onOrOff("passivity", &SafetyParameters::passivity,
                     "Damp energy that soil cannot supply (passivity control)."),
      {"safety", "max_force_n", "max_force_n",
       NumberValue{SafetyRanges::max_force_n, [](S& s, double v) { s.handling.safety.max_force_n = v; },
                   [](const S& s) { return limitOrLeftOut(s.handling.safety.max_force_n); }},
       "Largest force at the hand; default: the device's limit."},
      {"safety", "max_torque_nm", "max_torque_nm",
       NumberValue{SafetyRanges::max_torque_nm, [](S& s, double v) { s.handling.safety.max_torque_nm = v; },
                   [](const S& s) { return limitOrLeftOut(s.handling.safety.max_torque_nm); }},
       "Largest torque at the hand, N m; default: the device's limit."},
  };
}

Keys allKeys() {
  const auto scene = memberKeys<S>("");
  Keys keys{
      scene.text("title", &S::title, "One line that describes the scene."),
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

bool isToolTable(std::string_view table) {
  constexpr std::array<std::string_view, 6> kTables{"tool", "hand", "device", "mapping", "coupling", "safety"};
  return std::ranges::find(kTables, table) != kTables.end();
}

bool isOfTool(const SceneFileKey& key) {
  return isToolTable(key.table) || (key.table == "names" && key.name == "mesh");
}

std::span<const SceneFileKey> keysOfTools() {
  static const std::vector<SceneFileKey> kKeys = [] {
    std::vector<SceneFileKey> keys;
    std::ranges::copy_if(sceneFileKeys(), std::back_inserter(keys), isOfTool);
    std::stable_partition(keys.begin(), keys.end(), [](const SceneFileKey& key) { return key.table == "tool"; });
    return keys;
  }();
  return kKeys;
}

}  // namespace haptolith

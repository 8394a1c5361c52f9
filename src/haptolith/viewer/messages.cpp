#include "haptolith/viewer/messages.h"

#include <nlohmann/json.hpp>

#include <bit>
#include <cmath>
#include <cstdint>
#include <exception>
#include <numbers>
#include <utility>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/base64.h"
#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/session/soil_sliders.h"
#include "haptolith/soil/bodies.h"
#include "haptolith/soil/layers.h"
#include "haptolith/soil/presets.h"
#include "haptolith/soil/strength.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {

namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kProtocol = 1;
constexpr double kPerMetre_mm = 1e3;

OrderedJson array(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Wrong letters, which can only come from a client or a file, are replaced.
std::string written(const OrderedJson& message) {
  return message.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

OrderedJson orNull(std::string_view text) {
  return text.empty() ? OrderedJson(nullptr) : OrderedJson(text);
}

/// Mean density of the uppermost 15 cm as Table I has it, in kg/m^3, rounded; null where the analysis has none.
OrderedJson analysedDensity(const SoilParameters& soil, double gravity_m_s2) {
  constexpr double kBand_m = 0.15;
  try {
    return std::round(bandMeanDensity(layersToDepth(soil, gravity_m_s2, kBand_m), 0, kBand_m));
  } catch (const std::exception&) {  // contacts that cannot carry the soil above them
    return nullptr;
  }
}

/// Friction angle, cohesion and density that the soil shows: a named soil's as they were measured, a preset's as
/// (paper 17, 18) and the analysis of its layers have them. rho0 is neither's: it is that of the surface alone. For
/// a named soil with changed numbers nothing is known, except the density if only its contacts differ.
OrderedJson measuresOf(const SceneFile& scene_file) {
  const SoilParameters& soil = scene_file.bed.soil;
  OrderedJson measures{{"friction_angle_deg", nullptr}, {"cohesion_pa", nullptr}, {"bulk_density_kg_m3", nullptr}};
  if (!scene_file.soil_name.empty()) {
    try {
      const SoilFile file = findSoil(scene_file.soil_name);
      if (rescaled(file.soil, soil.radius_m) == soil) {
        measures["friction_angle_deg"] = file.target.friction_angle_deg;
        measures["cohesion_pa"] = file.target.cohesion_pa;
      }
      if (withContactsOf(rescaled(file.soil, soil.radius_m), soil) == soil) {
        measures["bulk_density_kg_m3"] = file.target.bulk_density_kg_m3;
      }
    } catch (const std::exception&) {  // a file that has gone: its measures are not known, that is all
    }
    return measures;
  }
  if (soil.friction == FrictionModel::kIcra2021) {
    measures["bulk_density_kg_m3"] = analysedDensity(soil, scene_file.bed.gravity_m_s2.norm());
    for (const SoilSlider& slider : slidersOf(soil)) {
      measures[std::string(slider.key)] = slider.value;
    }
  }
  return measures;
}

/// Numbers as little-endian bytes, as every machine that this runs on has them, in base64.
template <class Number>
std::string packed(const std::vector<Number>& numbers) {
  static_assert(std::endian::native == std::endian::little && sizeof(Number) == 4);
  return base64({reinterpret_cast<const char*>(numbers.data()), 4 * numbers.size()});
}

OrderedJson meshJson(const TriangleMesh& mesh) {
  std::vector<float> points_m;
  points_m.reserve(3 * mesh.points_m.size());
  for (const Vec3& point_m : mesh.points_m) {
    for (const double x : point_m) {
      points_m.push_back(static_cast<float>(x));
    }
  }
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  return {{"points_base64", packed(points_m)}, {"triangles_base64", packed(corners)}};
}

/// The tool's mesh, if it has one, whatever its shape is now.
OrderedJson toolMeshJson(const ToolParameters& tool, const ToolMeshSource& source) {
  if (tool.mesh == nullptr) {
    return nullptr;
  }
  OrderedJson mesh{{"name", source.name}, {"report", tool.mesh->report}};
  mesh.update(meshJson(tool.mesh->surface));
  return mesh;
}

OrderedJson toolJson(const ToolParameters& tool, const ToolMeshSource& source) {
  return {{"shape", wordFor(kToolShapeWords, tool.shape)}, {"size_mm", array(kPerMetre_mm * tool.size_m)},
          {"diameter_mm", kPerMetre_mm * tool.diameter_m}, {"thickness_mm", kPerMetre_mm * tool.thickness_m},
          {"opening_mm", kPerMetre_mm * tool.opening_m},   {"jaw_bend_deg", tool.jaw_bend_rad * 180 / std::numbers::pi},
          {"length_mm", kPerMetre_mm * tool.length_m},     {"mesh", toolMeshJson(tool, source)}};
}

OrderedJson namedToolJson(std::string_view name, HandMotion motion, const OrderedJson& tool) {
  OrderedJson named{{"name", name}, {"motion", wordFor(kHandMotionWords, motion)}};
  named.update(tool);
  return named;
}

/// Every tool; `first` is toolJson() of the first.
OrderedJson toolsJson(const SceneLookedAt& shown, const OrderedJson& first) {
  OrderedJson tools = OrderedJson::array({namedToolJson(shown.scene_file.tool_name, shown.motion, first)});
  for (const SceneTool& tool : shown.scene_file.more_tools) {
    tools.push_back(namedToolJson(tool.name, tool.hand.motion, toolJson(tool.tool, tool.mesh)));
  }
  return tools;
}

OrderedJson soilJson(const SceneFile& scene_file) {
  OrderedJson soil{{"preset", orNull(scene_file.preset)},
                   {"name", orNull(scene_file.soil_name)},
                   {"friction", wordFor(kFrictionWords, scene_file.bed.soil.friction)}};
  soil.update(measuresOf(scene_file));
  return soil;
}

/// Number of particles per radius, in the order of a frame's particles.
OrderedJson grainsJson(const std::vector<Bed::GrainRun>& runs, double radius_m) {
  OrderedJson grains = OrderedJson::array();
  for (const Bed::GrainRun& run : runs) {
    grains.push_back({{"count", run.count}, {"radius_m", GrainClasses::scale(run.grain_class) * radius_m}});
  }
  return grains;
}

OrderedJson stonesJson(const std::vector<std::shared_ptr<const StoneShape>>& stones) {
  OrderedJson list = OrderedJson::array();
  for (const auto& stone : stones) {
    list.push_back(stoneJson(*stone));
  }
  return list;
}

std::size_t countOf(const std::vector<Bed::GrainRun>& runs) {
  std::size_t count = 0;
  for (const Bed::GrainRun& run : runs) {
    count += run.count;
  }
  return count;
}

OrderedJson recordedJson(const std::filesystem::path& file) {
  return file.empty() ? OrderedJson(nullptr)
                      : OrderedJson{{"file", file.filename().string()}, {"folder", file.parent_path().string()}};
}

OrderedJson learnedJson(const std::optional<RobotShown::Learned>& learned) {
  return learned ? OrderedJson{{"friction_angle_deg", learned->friction_angle_deg},
                               {"cohesion_pa", learned->cohesion_pa},
                               {"tool_friction_angle_deg", learned->tool_friction_angle_deg}}
                 : OrderedJson(nullptr);
}

OrderedJson siteJson(const std::optional<RobotShown::Site>& site) {
  if (!site) {
    return nullptr;
  }
  OrderedJson heights_mm = OrderedJson::array();
  for (const double height_m : site->height_m) {
    constexpr double kTenthsInMetre = 1e4;
    heights_mm.push_back(std::isfinite(height_m) ? OrderedJson(std::round(height_m * kTenthsInMetre) / 10)
                                                 : OrderedJson(nullptr));
  }
  return {{"corner_m", {site->x_m, site->y_m}},
          {"cell_m", site->cell_m},
          {"columns", site->columns},
          {"rows", site->rows},
          {"heights_mm", heights_mm}};
}

OrderedJson robotJson(const RobotShown* robot) {
  if (robot == nullptr) {
    return nullptr;
  }
  const Vec3& at = robot->scene_T_tool.position_m;
  const Quat& turn = robot->scene_T_tool.orientation;
  const auto vector = [](const Vec3& v) { return OrderedJson{v.x(), v.y(), v.z()}; };
  return {{"state", robot->state},
          {"reason", orNull(robot->reason)},
          {"heard", robot->heard},
          {"behind", robot->behind},
          {"round_trip_s", robot->round_trip_s},
          {"pose", {at.x(), at.y(), at.z(), turn.w(), turn.x(), turn.y(), turn.z()}},
          {"felt_n", vector(robot->displayed_n)},
          {"met_n", vector(robot->met_n)},
          {"learned", learnedJson(robot->learned)},
          {"site", siteJson(robot->site)}};
}

}  // namespace

Board::Texts helloMessages(std::string_view version, bool read_only, bool takes_uploads) {
  OrderedJson message{{"type", "hello"},     {"protocol", kProtocol},  {"version", version},
                      {"client", "$client"}, {"read_only", read_only}, {"takes_uploads", takes_uploads}};
  OrderedJson& presets_list = message["presets"] = OrderedJson::array();
  for (const Preset& preset : presets()) {
    presets_list.push_back({{"name", preset.name}, {"friction_coefficient", preset.friction_coefficient}});
  }
  OrderedJson& soils = message["soils"] = OrderedJson::array();
  for (const std::string& name : soilNames()) {
    const SoilFile file = findSoil(name);
    soils.push_back({{"name", name},
                     {"source", file.source},
                     {"friction_angle_deg", file.target.friction_angle_deg},
                     {"cohesion_pa", file.target.cohesion_pa},
                     {"bulk_density_kg_m3", file.target.bulk_density_kg_m3}});
  }
  OrderedJson& bodies_list = message["bodies"] = OrderedJson::array();
  for (const Body& body : bodies()) {
    bodies_list.push_back({{"name", body.name}, {"gravity_m_s2", body.gravity_m_s2}});
  }
  message["frictions"] = namesOf(kFrictionWords);
  message["shapes"] = namesOf(kToolShapeWords);
  message["motions"] = playableMotions();
  std::string whole = written(message);
  for (const char* names : {"presets", "soils", "bodies", "frictions"}) {
    message[names] = OrderedJson::array();
  }
  return {std::move(whole), written(message)};
}

OrderedJson stoneJson(const StoneShape& stone) {
  if (!stone.shown.triangles.empty()) {
    return meshJson(stone.shown);
  }
  OrderedJson spheres = OrderedJson::array();
  for (const StoneSphere& sphere : stone.spheres) {
    spheres.push_back({sphere.centre_m.x(), sphere.centre_m.y(), sphere.centre_m.z(), sphere.radius_m});
  }
  return {{"spheres", std::move(spheres)}};
}

bool showsEveryTool(const SceneFile& scene_file) {
  return toolCount(scene_file) > 1 || scene_file.tool.joint.any();
}

Board::Texts sceneMessages(const Session& session, const FrameSpace& space) {
  const Bed& bed = session.scene().bed();
  SceneLookedAt shown{.scene_file = session.sceneFile(),
                      .soil = session.shown().bed.soil,
                      .scene = session.scenes(),
                      .grains = bed.grainRuns(),
                      .surface_m = session.surface(),
                      .motion = session.motion(),
                      .low_m = session.workspaceLow(),
                      .high_m = session.workspaceHigh()};
  for (std::size_t stone = 0; stone < bed.stones().size(); ++stone) {
    shown.stones.push_back(bed.stones().shape(stone));
  }
  return sceneMessages(shown, space);
}

FrameSpace shownSpace(const BedParameters& bed, double surface_m) {
  constexpr double kAboveSurface_m = 0.4;
  constexpr double kBesideBox_m = 0.02;
  const double x = bed.width_m / 2 + kBesideBox_m;
  const double y = bed.length_m / 2 + kBesideBox_m;
  return {Vec3(-x, -y, -kBesideBox_m), Vec3(x, y, surface_m + kAboveSurface_m)};
}

Board::Texts sceneMessages(const SceneLookedAt& shown, const FrameSpace& space) {
  const SceneFile& scene_file = shown.scene_file;
  const BedParameters& bed = scene_file.bed;
  OrderedJson sliders = OrderedJson::array();
  for (const SoilSlider& slider : slidersOf(bed.soil, calibrationOf(scene_file))) {
    sliders.push_back({{"key", slider.key},
                       {"label", slider.label},
                       {"unit", slider.unit},
                       {"value", slider.value},
                       {"low", slider.low},
                       {"high", slider.high},
                       {"step", slider.step}});
  }
  OrderedJson message({{"type", "scene"},
                       {"scene", shown.scene},
                       {"title", scene_file.title},
                       {"particles", countOf(shown.grains)},
                       {"radius_m", bed.soil.radius_m},
                       {"can_coarsen", canBeCoarser(scene_file)},
                       {"grains", grainsJson(shown.grains, shown.soil.radius_m)},
                       {"size_spread", shown.soil.friction == FrictionModel::kContact ? shown.soil.size_spread : 0.0},
                       {"box",
                        {{"width_m", bed.width_m},
                         {"length_m", bed.length_m},
                         {"surface_m", shown.surface_m},
                         {"periodic_x", bed.periodic_x},
                         {"periodic_y", bed.periodic_y}}},
                       {"quantised", {{"low_m", array(space.low_m)}, {"high_m", array(space.high_m)}}},
                       {"soil", soilJson(scene_file)},
                       {"sliders", sliders},
                       {"body", orNull(scene_file.body)},
                       {"gravity_m_s2", array(bed.gravity_m_s2)},
                       {"tool", toolJson(scene_file.tool, scene_file.mesh)},
                       {"hand",
                        {{"motion", wordFor(kHandMotionWords, shown.motion)},
                         {"max_force_n", scene_file.hand.max_force_n},
                         {"max_torque_nm", scene_file.hand.max_torque_nm}}},
                       {"workspace", {{"low_m", array(shown.low_m)}, {"high_m", array(shown.high_m)}}}});
  if (!shown.stones.empty()) {
    message["stones"] = stonesJson(shown.stones);
  }
  if (showsEveryTool(scene_file)) {
    message["tools"] = toolsJson(shown, message["tool"]);
  }
  std::string whole = written(message);
  if (message.contains("tools")) {  // a participant sees the own tool
    message["tools"] = OrderedJson::array({namedToolJson("", shown.motion, message["tool"])});
  }
  for (auto& [key, value] : message["soil"].items()) {
    value = nullptr;
  }
  message["title"] = "";
  message["can_coarsen"] = false;
  message["sliders"] = OrderedJson::array();
  message["body"] = nullptr;
  message["gravity_m_s2"] = array(Vec3::Zero());
  return {std::move(whole), written(message)};
}

Board::Texts statusMessages(const Session& session, const StatusBeside& beside) {
  const SceneSnapshot& now = session.snapshot();
  const RealTime& real_time = session.realTime();
  OrderedJson message({{"type", "status"},
                       {"time_s", now.time_s},
                       {"ticks", now.ticks},
                       {"misses", now.deadline_misses},
                       {"misses_too_long", now.misses_too_long},
                       {"misses_woken_late", now.misses_woken_late},
                       {"misses_preempted", now.misses_preempted},
                       {"success_rate", now.success_rate},
                       {"rate_hz", beside.rate_hz},
                       {"tick_us", {{"p50", now.tick_us_p50}, {"p99", now.tick_us_p99}, {"max", now.tick_us_max}}},
                       {"particles", now.position.size()},
                       {"awake", now.awake},
                       {"paused", now.paused},
                       {"speed", session.speed()},
                       {"held_by", beside.held_by ? OrderedJson(*beside.held_by) : OrderedJson(nullptr)},
                       {"clients", beside.clients},
                       {"device", session.deviceName()},
                       {"person_feels", session.personFeels()},
                       {"let_go", orNull(now.trip == SafetyTrip::kNone ? "" : text(now.trip))},
                       {"real_time", {{"scheduler", real_time.scheduler}, {"memory_locked", real_time.memory_locked}}},
                       {"simd", simdTarget()},
                       {"threads", session.sceneFile().bed.threads},
                       {"busy", orNull(session.busy())},
                       {"problem", orNull(session.problem())},
                       {"can_undo", !session.undoable().empty()},
                       {"undo", orNull(session.undoable())},
                       {"undo_redoes", session.undoRedoes()},
                       {"recording", orNull(beside.recording)},
                       {"recorded", recordedJson(beside.recorded)},
                       {"robot", robotJson(beside.robot)}});
  std::string whole = written(message);
  for (const char* names : {"problem", "undo", "recording", "recorded"}) {
    message[names] = nullptr;
  }
  return {std::move(whole), written(message)};
}

std::string replyMessage(std::optional<std::int64_t> id, std::string_view refused) {
  OrderedJson message{{"type", "reply"}, {"id", id ? OrderedJson(*id) : OrderedJson(nullptr)}, {"ok", refused.empty()}};
  if (!refused.empty()) {
    message["error"] = refused;
  }
  return written(message);
}

}  // namespace haptolith

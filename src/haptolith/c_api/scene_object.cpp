#include "haptolith/c_api/scene_object.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/c_api/values.h"
#include "haptolith/core/error.h"
#include "haptolith/tool/tool_contact.h"

namespace haptolith::library {

namespace {

/// Before the texts and the state in the bytes of a saved scene.
struct Header {
  std::array<char, 8> magic{'H', 'A', 'P', 'T', 'O', 'S', 'T', '2'};
  std::uint32_t version = HAPTO_VERSION;
  std::int32_t condition = HAPTO_OK;
  std::array<char, 16> arithmetic{};
  std::uint64_t uses_bytes = 0, made_of_bytes = 0, scene_file_bytes = 0, scene_bytes = 0;
  std::uint64_t hash = 0;  ///< XXH3 of all that follows
};

/// Use of a tool, in those bytes.
struct SavedUse {
  double opening = 1, fade = 1;
  std::uint64_t in_soil = 1;
};

std::array<char, 16> arithmeticInUse() {
  std::array<char, 16> name{};
  std::strncpy(name.data(), arithmetic(), name.size() - 1);
  return name;
}

bool isFinite(const hapto_twist& t) noexcept {
  return twist(t).linear_m_s.allFinite() && twist(t).angular_rad_s.allFinite();
}

/// A rotation whose rounding is no matter stays as it is, bit for bit.
Quat unit(const Quat& turn) noexcept {
  constexpr double kRounding = 1e-9;
  return std::abs(turn.squaredNorm() - 1) > kRounding ? turn.normalized() : turn;
}

std::int32_t statusOf(StepStatus status) noexcept {
  switch (status) {
    case StepStatus::kOk: return HAPTO_OK;
    case StepStatus::kNotFinite: return HAPTO_NOT_FINITE;
    case StepStatus::kCollapsed: return HAPTO_COLLAPSED;
  }
  return HAPTO_NOT_FINITE;
}

/// Parameters of a tool of the scene.
const ToolParameters& toolOf(const SceneFile& scene, std::size_t tool) {
  return tool == 0 ? scene.tool : scene.more_tools[tool - 1].tool;
}
ToolParameters& toolOf(SceneFile& scene, std::size_t tool) {
  return const_cast<ToolParameters&>(toolOf(std::as_const(scene), tool));
}

std::vector<std::string> namesOf(const SceneFile& scene) {
  const std::vector<std::string_view> names = toolNames(scene);
  return {names.begin(), names.end()};
}

/// Value that a joint's drive holds; null where it holds nothing.
double* heldBy(Joint& joint) noexcept {
  switch (joint.drive) {
    case Drive::kSpeed: return &joint.speed_rad_s;
    case Drive::kTorque: return &joint.torque_nm;
    case Drive::kNone:
    case Drive::kFree: break;
  }
  return nullptr;
}

/// The first of two scenes with what may change in soil as it lies taken from the second.
SceneFile withChangesOf(SceneFile scene, const SceneFile& other) {
  scene.title = other.title;
  scene.preset = other.preset;
  scene.soil_name = other.soil_name;
  scene.body = other.body;
  scene.bed.soil = other.bed.soil;
  scene.bed.gravity_m_s2 = other.bed.gravity_m_s2;
  scene.bed.start = other.bed.start;  // the soil already exists
  scene.bed.threads = other.bed.threads;
  scene.mesh = other.mesh;
  scene.tool = other.tool;
  for (std::size_t i = 0; i < std::min(scene.more_tools.size(), other.more_tools.size()); ++i) {
    scene.more_tools[i].mesh = other.more_tools[i].mesh;
    scene.more_tools[i].tool = other.more_tools[i].tool;
  }
  return scene;
}

SceneFile madeOf(SceneFile scene, const SoilParameters& soil) {
  scene.bed.soil = soil;
  makeToolMesh(scene);
  return scene;
}

}  // namespace

struct SceneObject::Saved {
  std::int32_t condition;
  ToolUses uses;
  SoilParameters made_of;
  SceneFile scene_file;
  SavedScene scene;
};

SceneObject::SceneObject(const SceneFile& scene_file, const SettleProgress& progress)
    : scene_file_(scene_file),
      made_of_(scene_file.bed.soil),
      scene_(std::make_unique<Scene>(scene_file.bed, toolSet(scene_file), progress)),
      tool_names_(namesOf(scene_file)) {
  placeAtStart();
}

/// Puts each tool above the soil. Tools other than the first touch nothing until they are placed or stepped.
void SceneObject::placeAtStart() noexcept {
  const double surface_m = scene_->bed().surfaceHeight();
  for (std::size_t i = 0; i < scene_->tools(); ++i) {
    const HandlingParameters& handling = i == 0 ? scene_file_.handling : scene_file_.more_tools[i - 1].handling;
    HandState hand;
    hand.pose.position_m = handling.mapping.offset_m + Vec3(0, 0, surface_m);
    scene_->placeTool(hand, i);
    if (i > 0) {
      uses_[i].in_soil = false;
      scene_->setToolFade(0, i);
    }
  }
}

SceneObject::SceneObject(const SceneObject& other)
    : SceneObject(Saved{other.condition_, other.uses_, other.made_of_, other.scene_file_, other.scene_->save()}) {
  as_made_ = other.as_made_;
}

SceneObject::SceneObject(std::string_view saved) : SceneObject(parsed(saved)) {}

SceneObject::SceneObject(const Saved& saved)
    : scene_file_(saved.scene_file),
      made_of_(saved.made_of),
      scene_(
          std::make_unique<Scene>(madeOf(saved.scene_file, saved.made_of).bed, toolSet(saved.scene_file), saved.scene)),
      tool_names_(namesOf(saved.scene_file)) {
  goOn(saved);
}

/// The soil first: that wakes the bed, whose state is restored after it.
void SceneObject::goOn(const Saved& saved) {
  Bed& bed = scene_->bed();
  if (bed.parameters().soil != saved.scene_file.bed.soil) {
    bed.setSoil(SoilLaws(saved.scene_file.bed.soil, grainClasses(saved.scene_file.bed)));
  }
  bed.setGravity(saved.scene_file.bed.gravity_m_s2);
  scene_->restore(saved.scene);
  condition_ = saved.condition;
  uses_ = saved.uses;
  as_made_ = false;
}

std::uint64_t SceneObject::startTick(std::size_t moved) const noexcept {
  const std::uint64_t ticks = scene_->bed().state().step / static_cast<std::uint64_t>(scene_->substeps());
  const bool as_scene_says = as_made_ && moved == scene_->tools() && scene_->toolFade() == 1;
  return as_scene_says ? ticks : std::max<std::uint64_t>(ticks, 1);
}

std::string SceneObject::save() const {
  const std::string made_of = sceneFileText(madeOf(scene_file_, made_of_));
  const std::string now = sceneFileText(scene_file_);
  const std::string scene = serialise(scene_->save());
  std::string uses;
  for (std::size_t i = 0; i < scene_->tools(); ++i) {
    const SavedUse use{uses_[i].opening, uses_[i].fade, uses_[i].in_soil ? 1U : 0U};
    uses.append(reinterpret_cast<const char*>(&use), sizeof use);
  }
  const std::string all = uses + made_of + now + scene;
  const Header header{.condition = condition_,
                      .arithmetic = arithmeticInUse(),
                      .uses_bytes = uses.size(),
                      .made_of_bytes = made_of.size(),
                      .scene_file_bytes = now.size(),
                      .scene_bytes = scene.size(),
                      .hash = XXH3_64bits(all.data(), all.size())};
  return std::string(reinterpret_cast<const char*>(&header), sizeof header) + all;
}

SceneObject::Saved SceneObject::parsed(std::string_view bytes) {
  const Header expected;
  Header header;
  if (bytes.size() < sizeof header || std::memcmp(bytes.data(), expected.magic.data(), expected.magic.size()) != 0) {
    throw Failure("not a saved scene");
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  bytes.remove_prefix(sizeof header);
  if (header.version != expected.version) {
    throw Failure(fmt::format("this scene was saved by version {}.{}.{} of the library; this is {}",
                              header.version / 1'000'000, header.version / 1000 % 1000, header.version % 1000,
                              HAPTO_VERSION_STRING));
  }
  header.arithmetic.back() = '\0';
  if (header.arithmetic != arithmeticInUse()) {
    throw Failure(
        fmt::format("this scene was saved with {} arithmetic, which this machine has with {}; {} would differ",
                    header.arithmetic.data(), targetsWith(header.arithmetic.data()), instructionSetName(simdTarget())));
  }
  std::uint64_t left = bytes.size();
  bool fits = true;
  for (const std::uint64_t part : {header.uses_bytes, header.made_of_bytes, header.scene_file_bytes}) {
    fits = fits && part <= left;
    left -= fits ? part : 0;
  }
  if (!fits || header.scene_bytes != left || header.hash != XXH3_64bits(bytes.data(), bytes.size()) ||
      header.condition < HAPTO_OK || header.condition > HAPTO_COLLAPSED) {
    throw Failure("this saved scene is damaged");
  }
  const auto take = [&](std::uint64_t count) {
    const std::string_view part = bytes.substr(0, count);
    bytes.remove_prefix(count);
    return part;
  };
  const std::string_view uses = take(header.uses_bytes);
  const SceneFile made_of = loadSceneFileText(take(header.made_of_bytes), "the saved scene");
  Saved saved{.condition = header.condition,
              .uses = {},
              .made_of = made_of.bed.soil,
              .scene_file = loadSceneFileText(take(header.scene_file_bytes), "the saved scene"),
              .scene = deserialiseSavedScene(bytes)};
  if (uses.size() != toolCount(saved.scene_file) * sizeof(SavedUse)) {
    throw Failure("this saved scene is damaged");
  }
  for (std::size_t i = 0; i < toolCount(saved.scene_file); ++i) {
    SavedUse use;
    std::memcpy(&use, uses.data() + i * sizeof use, sizeof use);
    saved.uses[i] = {requireInRange("opening", use.opening, {0, 1}), requireInRange("tool_fade", use.fade, {0, 1}),
                     use.in_soil != 0};
  }
  return saved;
}

void SceneObject::restore(std::string_view bytes) {
  const Saved saved = parsed(bytes);
  const SceneFile& now = saved.scene_file;
  const bool same_bed =
      withChangesOf(now, scene_file_) == scene_file_ && saved.made_of == made_of_ &&
      substepsFor(madeOf(now, made_of_).bed, stiffnessInStep(toolSet(now).all(), made_of_)) == scene_->substeps();
  if (!same_bed) {
    throw InvalidParameter(
        "state", fmt::format("the state of scene '{}'", now.title),
        "the state of a scene with the same parameters; hapto_scene_from_state() makes another scene");
  }
  const Saved before{condition_, uses_, made_of_, scene_file_, scene_->save()};
  const auto set_tools = [this](const SceneFile& scene_file) {
    for (std::size_t i = 0; i < scene_->tools(); ++i) {
      scene_->setTool(toolOf(scene_file, i), i);
    }
  };
  try {
    set_tools(now);
    goOn(saved);
  } catch (...) {
    set_tools(before.scene_file);
    goOn(before);
    throw;
  }
  const int threads = scene_file_.bed.threads;
  scene_file_ = now;
  scene_file_.bed.threads = threads;  // the bed's own, which no state changes
}

bool SceneObject::isValid(const hapto_pose& at) const noexcept {
  const Pose there = pose(at);
  return there.position_m.allFinite() && isUnit(there.orientation) && isNearBed(scene_file_.bed, there.position_m);
}

/// A tool grows into the soil that it meets from now on.
void SceneObject::enterSoil(std::size_t tool) noexcept {
  ToolUse& use = uses_[tool];
  if (!use.in_soil) {
    use.in_soil = true;
    scene_->setToolFade(use.fade, tool);
  }
}

void SceneObject::setFade(std::size_t tool, double share) noexcept {
  uses_[tool].fade = share;
  if (uses_[tool].in_soil) {
    scene_->setToolFade(share, tool);
  }
}

std::int32_t SceneObject::placeTool(std::size_t tool, const hapto_pose& at) noexcept {
  if (!isValid(at)) {
    return HAPTO_INVALID_PARAMETER;
  }
  const Pose there = pose(at);
  scene_->placeTool({{{there.position_m, unit(there.orientation)}, {}}, uses_[tool].opening}, tool);
  enterSoil(tool);
  return HAPTO_OK;
}

std::int32_t SceneObject::setDrive(std::size_t tool, double value) noexcept {
  Joint& joint = toolOf(scene_file_, tool).joint;
  double* const held = heldBy(joint);
  const Range range = joint.drive == Drive::kSpeed ? JointRanges::speed_rad_s : JointRanges::torque_nm;
  if (held == nullptr || !range.contains(value)) {  // NaN is in no range
    return HAPTO_INVALID_PARAMETER;
  }
  as_made_ = as_made_ && *held == value;
  *held = value;
  scene_->setDrive(value, tool);
  return HAPTO_OK;
}

/// Another value that a drive holds leaves the joint where it is, and what the tool touches as it was.
void SceneObject::setTool(std::size_t tool, const ToolParameters& parameters) noexcept {
  ToolParameters driven = scene_->tool(tool);
  if (driven == parameters) {
    return;
  }
  double* const held = heldBy(driven.joint);
  if (held != nullptr) {
    Joint wanted = parameters.joint;
    const double* const value = heldBy(wanted);
    *held = value != nullptr ? *value : *held;
    if (driven == parameters) {
      scene_->setDrive(*held, tool);
      return;
    }
  }
  scene_->setTool(parameters, tool);
}

HandState SceneObject::handFor(std::size_t tool, const hapto_pose& to, const hapto_twist* given) const noexcept {
  const Pose there = pose(to);
  HandState hand{{{there.position_m, unit(there.orientation)}, {}}, uses_[tool].opening};
  if (given != nullptr) {
    hand.twist = twist(*given);
  } else {
    const Pose& from = scene_->toolPose(tool);
    const double tick_s = scene_file_.bed.tick_s;
    hand.twist = {(hand.pose.position_m - from.position_m) / tick_s,
                  rotationBetween(from.orientation, hand.pose.orientation) / tick_s};
  }
  return hand;
}

/// The first `count` tools; the others stay where they are.
std::int32_t SceneObject::move(const hapto_pose* poses, const hapto_twist* given, std::size_t count,
                               hapto_wrench* felt) noexcept {
  if (condition_ != HAPTO_OK) {
    return condition_;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!isValid(poses[i]) || (given != nullptr && !isFinite(given[i]))) {
      return HAPTO_INVALID_PARAMETER;
    }
    hands_[i] = handFor(i, poses[i], given == nullptr ? nullptr : given + i);
  }
  for (std::size_t i = 0; i < count; ++i) {
    enterSoil(i);
  }
  condition_ = statusOf(scene_->tickAll({hands_.data(), count}));
  for (std::size_t i = 0; i < scene_->tools() && condition_ == HAPTO_OK; ++i) {
    const Wrench& now = scene_->soilWrench(i);
    condition_ = now.force_n.allFinite() && now.torque_nm.allFinite() ? HAPTO_OK : HAPTO_NOT_FINITE;
  }
  for (std::size_t i = 0; i < count && felt != nullptr; ++i) {
    felt[i] = condition_ == HAPTO_OK ? wrench(scene_->soilWrench(i)) : hapto_wrench{};
  }
  return condition_;
}

void SceneObject::setGravity(const Vec3& gravity_m_s2) noexcept {
  as_made_ = false;
  scene_->bed().setGravity(gravity_m_s2);
  scene_file_.bed.gravity_m_s2 = gravity_m_s2;
  scene_file_.body.clear();
}

SceneChanges SceneObject::planned(const std::vector<std::string>& overrides) const {
  SceneChanges changes{.gravity_m_s2 = {}, .laws = {}, .tools = {}, .wanted = changed(scene_file_, overrides)};
  SceneFile& wanted = changes.wanted;
  wanted.bed.start = scene_file_.bed.start;  // the soil already exists
  SceneFile rest = withChangesOf(wanted, scene_file_);
  if (!(rest == scene_file_)) {
    throw InvalidParameter("overrides", fmt::format("{} keys", overrides.size()),
                           "keys of [soil], [gravity], [tool] and [[tools]] only; other changes need another scene");
  }
  if (wanted.bed.threads != scene_file_.bed.threads) {
    throw InvalidParameter("bed.threads", fmt::format("{}", wanted.bed.threads),
                           fmt::format("{} during the lifetime of the scene", scene_file_.bed.threads));
  }
  const ToolSet tools = toolSet(wanted);
  const double stiffness_n_m = stiffnessInStep(tools.all(), wanted.bed.soil);
  requireEnoughInertia(wanted.bed, tools, scene_->substeps());
  for (std::size_t i = 0; i < scene_->tools(); ++i) {
    const ToolParameters& tool = toolOf(wanted, i);
    if (tool == toolOf(scene_file_, i)) {
      continue;
    }
    if (substepsFor(madeOf(wanted, made_of_).bed, stiffness_n_m) != scene_->substeps()) {
      throw InvalidParameter("tool.stiffness_n_m", fmt::format("{}", tool.stiffness_n_m),
                             "the stiffness of the present tool: another number of steps per tick needs another scene");
    }
    changes.tools.push_back({i, tool});
  }
  if (!(wanted.bed.soil == scene_file_.bed.soil)) {
    BedParameters made = scene_file_.bed;
    made.soil = made_of_;
    if (!isCompatible(made, wanted.bed.soil, stiffness_n_m)) {
      throw InvalidParameter("soil", wanted.soil_name.empty() ? wanted.preset : wanted.soil_name,
                             "a soil with the same particle size, mass, friction model and number of steps per tick; "
                             "another soil needs another scene");
    }
    changes.laws.emplace(wanted.bed.soil, grainClasses(wanted.bed));
  }
  if (wanted.bed.gravity_m_s2 != scene_file_.bed.gravity_m_s2) {
    changes.gravity_m_s2 = wanted.bed.gravity_m_s2;
  }
  return changes;
}

void SceneObject::takeBack(std::int32_t condition) {
  condition_ = condition;
  for (std::size_t i = 0; i < scene_->tools(); ++i) {
    scene_->setToolFade(uses_[i].in_soil ? uses_[i].fade : 0, i);
    setTool(i, toolOf(scene_file_, i));
  }
  Bed& bed = scene_->bed();
  if (!(bed.parameters().soil == scene_file_.bed.soil)) {
    bed.setSoil(SoilLaws(scene_file_.bed.soil, grainClasses(scene_file_.bed)));
  }
  bed.setGravity(scene_file_.bed.gravity_m_s2);
}

void SceneObject::carryOut(const SceneChanges& changes) {
  as_made_ = false;
  if (changes.gravity_m_s2) {
    scene_->bed().setGravity(*changes.gravity_m_s2);
  }
  if (changes.laws) {
    scene_->bed().setSoil(*changes.laws);
  }
  for (const ToolChange& change : changes.tools) {
    setTool(change.tool, change.parameters);
  }
  note(changes);
}

}  // namespace haptolith::library

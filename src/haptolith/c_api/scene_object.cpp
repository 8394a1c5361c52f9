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
  std::array<char, 8> magic{'H', 'A', 'P', 'T', 'O', 'S', 'T', '1'};
  std::uint32_t version = HAPTO_VERSION;
  std::int32_t condition = HAPTO_OK;
  std::array<char, 16> arithmetic{};
  double opening = 1;
  std::uint64_t made_of_bytes = 0, scene_file_bytes = 0, scene_bytes = 0;
  std::uint64_t hash = 0;  ///< XXH3 of all that follows
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
  double opening;
  SoilParameters made_of;
  SceneFile scene_file;
  SavedScene scene;
};

SceneObject::SceneObject(const SceneFile& scene_file, const SettleProgress& progress)
    : scene_file_(scene_file),
      made_of_(scene_file.bed.soil),
      scene_(std::make_unique<Scene>(scene_file.bed, toolSet(scene_file), progress)) {
  HandState hand;
  hand.pose.position_m = scene_file.handling.mapping.offset_m + Vec3(0, 0, scene_->bed().surfaceHeight());
  scene_->placeTool(hand);
}

SceneObject::SceneObject(const SceneObject& other)
    : SceneObject(Saved{other.condition_, other.opening_, other.made_of_, other.scene_file_, other.scene_->save()}) {
  as_made_ = other.as_made_;
}

SceneObject::SceneObject(std::string_view saved) : SceneObject(parsed(saved)) {}

SceneObject::SceneObject(const Saved& saved)
    : scene_file_(saved.scene_file),
      made_of_(saved.made_of),
      scene_(std::make_unique<Scene>(madeOf(saved.scene_file, saved.made_of).bed, toolSet(saved.scene_file),
                                     saved.scene)) {
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
  opening_ = saved.opening;
  as_made_ = false;
}

std::uint64_t SceneObject::startTick() const noexcept {
  const std::uint64_t ticks = scene_->bed().state().step / static_cast<std::uint64_t>(scene_->substeps());
  return as_made_ && scene_->toolFade() == 1 ? ticks : std::max<std::uint64_t>(ticks, 1);
}

std::string SceneObject::save() const {
  const std::string made_of = sceneFileText(madeOf(scene_file_, made_of_));
  const std::string now = sceneFileText(scene_file_);
  const std::string scene = serialise(scene_->save());
  const std::string all = made_of + now + scene;
  const Header header{.condition = condition_,
                      .arithmetic = arithmeticInUse(),
                      .opening = opening_,
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
  const std::uint64_t left = bytes.size();
  const bool fits = header.made_of_bytes <= left && header.scene_file_bytes <= left - header.made_of_bytes &&
                    header.scene_bytes == left - header.made_of_bytes - header.scene_file_bytes;
  if (!fits || header.hash != XXH3_64bits(bytes.data(), bytes.size()) || header.condition < HAPTO_OK ||
      header.condition > HAPTO_COLLAPSED || !std::isfinite(header.opening)) {
    throw Failure("this saved scene is damaged");
  }
  const SceneFile made_of = loadSceneFileText(bytes.substr(0, header.made_of_bytes), "the saved scene");
  return {
      .condition = header.condition,
      .opening = header.opening,
      .made_of = made_of.bed.soil,
      .scene_file = loadSceneFileText(bytes.substr(header.made_of_bytes, header.scene_file_bytes), "the saved scene"),
      .scene = deserialiseSavedScene(bytes.substr(header.made_of_bytes + header.scene_file_bytes))};
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
  const Saved before{condition_, opening_, made_of_, scene_file_, scene_->save()};
  try {
    scene_->setTool(now.tool);
    goOn(saved);
  } catch (...) {
    scene_->setTool(before.scene_file.tool);
    goOn(before);
    throw;
  }
  const int threads = scene_file_.bed.threads;
  scene_file_ = now;
  scene_file_.bed.threads = threads;  // the bed's own, which no state changes
}

std::int32_t SceneObject::placeTool(const hapto_pose& at) noexcept {
  const Pose there = pose(at);
  if (!there.position_m.allFinite() || !isUnit(there.orientation) || !isNearBed(scene_file_.bed, there.position_m)) {
    return HAPTO_INVALID_PARAMETER;
  }
  scene_->placeTool({{{there.position_m, unit(there.orientation)}, {}}, opening_});
  return HAPTO_OK;
}

std::int32_t SceneObject::step(const hapto_pose& to, const hapto_twist* given, hapto_wrench* felt) noexcept {
  if (condition_ != HAPTO_OK) {
    return condition_;
  }
  const Pose there = pose(to);
  if (!there.position_m.allFinite() || !isUnit(there.orientation) || !isNearBed(scene_file_.bed, there.position_m) ||
      (given != nullptr && !isFinite(*given))) {
    return HAPTO_INVALID_PARAMETER;
  }
  HandState hand{{{there.position_m, unit(there.orientation)}, {}}, opening_};
  if (given != nullptr) {
    hand.twist = twist(*given);
  } else {
    const Pose& from = scene_->toolPose();
    const double tick_s = scene_file_.bed.tick_s;
    hand.twist = {(hand.pose.position_m - from.position_m) / tick_s,
                  rotationBetween(from.orientation, hand.pose.orientation) / tick_s};
  }
  condition_ = statusOf(scene_->tick(hand));
  const Wrench& wrench_now = scene_->soilWrench();
  if (condition_ == HAPTO_OK && !(wrench_now.force_n.allFinite() && wrench_now.torque_nm.allFinite())) {
    condition_ = HAPTO_NOT_FINITE;
  }
  if (felt != nullptr) {
    *felt = condition_ == HAPTO_OK ? wrench(wrench_now) : hapto_wrench{};
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
  SceneChanges changes{.gravity_m_s2 = {}, .laws = {}, .tool = {}, .wanted = changed(scene_file_, overrides)};
  SceneFile& wanted = changes.wanted;
  wanted.bed.start = scene_file_.bed.start;  // the soil already exists
  SceneFile rest = withChangesOf(wanted, scene_file_);
  if (!(rest == scene_file_)) {
    throw InvalidParameter("overrides", fmt::format("{} keys", overrides.size()),
                           "keys of [soil], [gravity] and [tool] only; other changes need another scene");
  }
  if (wanted.bed.threads != scene_file_.bed.threads) {
    throw InvalidParameter("bed.threads", fmt::format("{}", wanted.bed.threads),
                           fmt::format("{} during the lifetime of the scene", scene_file_.bed.threads));
  }
  const double stiffness_n_m = stiffnessInStep(toolSet(wanted).all(), wanted.bed.soil);
  if (!(wanted.tool == scene_file_.tool)) {
    if (substepsFor(madeOf(wanted, made_of_).bed, stiffness_n_m) != scene_->substeps()) {
      throw InvalidParameter("tool.stiffness_n_m", fmt::format("{}", wanted.tool.stiffness_n_m),
                             "the stiffness of the present tool: another number of steps per tick needs another scene");
    }
    changes.tool = wanted.tool;
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

void SceneObject::takeBack(std::int32_t condition, double tool_fade) {
  condition_ = condition;
  scene_->setToolFade(tool_fade);
  if (!(scene_->tool() == scene_file_.tool)) {
    scene_->setTool(scene_file_.tool);
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
  if (changes.tool) {
    scene_->setTool(*changes.tool);
  }
  note(changes);
}

}  // namespace haptolith::library

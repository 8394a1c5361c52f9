#include "haptolith/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/core/process/async.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/soil/soil_parameters.h"
#include "haptolith/tool/tool_contact.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

/// Number of cached level beds: the stimuli of a study.
constexpr std::size_t kMaxCachedBeds = 64;

void requireRealTime(DeviceKind kind, const LoopParameters& loop) {
  if (kind != DeviceKind::kVirtualHand && !loop.real_time) {
    throw InvalidParameter(
        "real_time", "false",
        fmt::format(
            "true (without --no-realtime) with the haptic device '{}': forces on a hand must be rendered in real time",
            wordFor(kDeviceWords, kind)));
  }
}

/// Before anything is made or moves.
SceneFile forItsHand(SceneFile scene_file, const HapticDevice* device) {
  for (const SceneTool& tool : scene_file.more_tools) {
    requireRealTime(tool.device.kind, scene_file.loop);
  }
  if (device == nullptr) {
    requireRealTime(scene_file.device.kind, scene_file.loop);
  }
  return scene_file;
}

void requireEnoughSubsteps(const SceneFile& scene_file) {
  const BedParameters& bed = scene_file.bed;
  const ToolSet tools = toolSet(scene_file);
  requireEnoughInertia(bed, tools, substepsFor(bed, stiffnessInStep(tools.all(), bed.soil)));
}

bool sameTool(const ToolParameters& a, const ToolParameters& b) {
  return a.shape == b.shape && a.size_m == b.size_m && a.diameter_m == b.diameter_m && a.thickness_m == b.thickness_m &&
         a.opening_m == b.opening_m && a.jaw_bend_rad == b.jaw_bend_rad && a.length_m == b.length_m && a.mesh == b.mesh;
}

}  // namespace

/// A bed that is being made.
struct Session::Making {
  std::string_view why;
  std::atomic<bool> unwanted{false};
  std::atomic<double> settled_s{0};
  std::future<Showing> result;
};

/// A tool's mesh on its way.
struct Session::MakingMesh {
  ToolMeshSource source;
  std::future<std::shared_ptr<const ToolMesh>> result;
};

Session::Showing Session::showNew(const SceneFile& scene_file, const SettleProgress& progress) {
  Showing made;
  made.scene_file = scene_file;
  made.made_of = scene_file.bed;
  made.scene = std::make_unique<Scene>(scene_file.bed, toolSet(scene_file), progress);
  const Bed& bed = made.scene->bed();
  made.fresh = std::make_shared<const Fresh>(
      Fresh{scene_file.bed, made.scene->save(), bed.heldParticles(), bed.surfaceHeight()});
  return made;
}

Session::Showing Session::showFresh(const SceneFile& scene_file, std::shared_ptr<const Fresh> fresh) {
  Showing made;
  made.scene_file = scene_file;
  made.made_of = scene_file.bed;
  SavedScene saved = fresh->saved;
  const ToolSet tools = toolSet(scene_file);
  for (std::size_t i = 0; i < tools.all().size(); ++i) {
    saved.tools.at(i).opening_m = tools.all()[i].opening_m;  // the tool may be another one
  }
  made.scene = std::make_unique<Scene>(scene_file.bed, toolSet(scene_file), saved);
  made.fresh = std::move(fresh);
  return made;
}

Session::Showing Session::showLying(const SceneFile& scene_file, const LyingSoil& lying,
                                    std::shared_ptr<const Fresh> fresh) {
  Showing made;
  made.scene_file = scene_file;
  made.made_of = scene_file.bed;
  made.scene = std::make_unique<Scene>(scene_file.bed, toolSet(scene_file), lying);
  made.fresh = std::move(fresh);
  return made;
}

Session::Session(SceneFile scene_file, bool keep_records, const SettleProgress& progress,
                 std::unique_ptr<HapticDevice> device)
    : initial_(forItsHand(std::move(scene_file), device.get())),
      wanted_(initial_),
      current_(showNew(initial_, progress)) {
  keepFresh(current_.fresh);
  openHands(std::move(device));
  loop_ = std::make_unique<HapticLoop>(*current_.scene, handlings(), wanted_.loop, keep_records);
  current_.shown = &loop_->shownScene();
  snapshots_ = &current_.shown->snapshots;
}

Session::~Session() {
  if (making_) {
    making_->unwanted = true;
  }
}

void Session::start(std::atomic<bool>& stop) {
  thread_ = std::make_unique<LoopThread>(*loop_, wanted_.loop, stop);
}

LoopEnd Session::join() {
  return thread_->join();
}

bool Session::update() {
  return snapshots_->update();
}

bool Session::poll() {
  const bool on_stage = takeStage();
  bool made = takeMade();
  made = takeMadeMesh() || made;
  try {
    pursue();
  } catch (const Failure& failure) {
    problem_ = failure.what();
    made = true;
  }
  return on_stage || made;
}

/// Moves on to the bed that the loop now shows, once there is a picture of it.
bool Session::takeStage() {
  if (!coming_) {
    return false;
  }
  if (!coming_is_asked_for_) {
    coming_is_asked_for_ = loop_->ask(request::Replace{request::ReplaceBed{coming_->shown}});
  }
  if (&loop_->shownScene() != coming_->shown || !coming_->shown->snapshots.update()) {
    return false;
  }
  previous_ = std::move(current_);
  current_ = std::move(*coming_);
  coming_.reset();
  keepFresh(current_.fresh);
  ++scenes_;
  snapshots_ = &current_.shown->snapshots;
  for (std::size_t tool = 0; tool < hands_.size(); ++tool) {
    const HandParameters& begun = tool == 0 ? initial_.hand : initial_.more_tools.at(tool - 1).hand;
    Hand& hand = hands_[tool];
    hand.command.surface_m = begun.surface_m.value_or(current_.fresh->surface_m);
    ++hand.command.beginnings;
    commandHand(hand);
  }
  return true;
}

bool Session::takeMade() {
  if (!making_ || coming_ || !isThere(making_->result)) {
    return false;
  }
  const std::unique_ptr<Making> made = std::move(making_);
  try {
    Showing next = made->result.get();
    if (!made->unwanted) {
      current_.replaced_by = made->why;
      current_.taken_back = false;
      bringOnStage(std::move(next));
    }
  } catch (const std::exception& error) {  // the bed that is there stays
    if (!made->unwanted) {
      problem_ = error.what();
      wanted_ = current_.scene_file;
    }
  }
  return true;
}

void Session::takeToolMesh(ToolMeshSource source) {
  validate(source);
  if (making_mesh_) {
    throw Failure(
        fmt::format("the tool {} is still being prepared: wait until it is ready", making_mesh_->source.name));
  }
  problem_.clear();
  auto making = std::make_unique<MakingMesh>();
  making->source = std::move(source);
  try {
    making->result = setOut(Work::kBeside, [source = making->source, reach_m = contactReach(wanted_.tool, wanted_.bed),
                                            lengths_m = toolLengths(wanted_.bed)] {
      // One with a wrong unit is refused before it is measured, which takes the longer the larger it is.
      requireFitting(cornersOf(parseMesh(*source.bytes, source.name, source.format, {.unit_m = source.unit_m})),
                     source.name, lengths_m);
      return toolMesh(source, reach_m);
    });
  } catch (const std::exception& error) {
    throw Failure(fmt::format("cannot prepare another tool: {}", error.what()));
  }
  making_mesh_ = std::move(making);
}

bool Session::takeMadeMesh() {
  if (!making_mesh_ || !isThere(making_mesh_->result)) {
    return false;
  }
  const std::unique_ptr<MakingMesh> made = std::move(making_mesh_);
  try {
    (void)made->result.get();  // kept: the change below finds it
    change({.tool_shape = ToolShape::kMesh, .tool_mesh = made->source});
  } catch (const std::exception& error) {  // the tool that is there stays
    problem_ = error.what();
  }
  return true;
}

void Session::change(const SceneChange& change) {
  const SceneFile next = changed(wanted_, change);
  requireEnoughSubsteps(next);
  problem_.clear();
  wanted_ = next;
  if (change.wantsNewBed()) {
    wantBed("soil");
  }
  pursue();
}

void Session::reset() {
  problem_.clear();
  wanted_ = initial_;
  tellMotion(wanted_);
  wantBed("reset");
  pursue();
}

void Session::show(std::span<const SceneChange> changes) {
  SceneFile next = initial_;
  for (const SceneChange& change : changes) {
    next = changed(std::move(next), change);
  }
  requireEnoughSubsteps(next);
  problem_.clear();
  wanted_ = std::move(next);
  tellMotion(wanted_);
  wantBed("stimulus");
  pursue();
}

void Session::level() {
  problem_.clear();
  wantBed("level");
  pursue();
}

void Session::coarsen() {
  SceneFile next = wanted_, begin = initial_;
  makeCoarser(next);
  begin.bed.soil = rescaled(begin.bed.soil, next.bed.soil.radius_m);
  validate(begin);
  makeToolMesh(begin);
  problem_.clear();
  wanted_ = std::move(next);
  initial_ = std::move(begin);
  wantBed("coarser");
  pursue();
}

void Session::undo() {
  if (!previous_ || making_ || coming_) {
    throw RefusedAction("undo", making_ || coming_
                                    ? "nothing to undo yet: a bed is being prepared; wait until it is ready"
                                    : "nothing to undo: the bed has not been changed");
  }
  problem_.clear();
  current_.replaced_by = previous_->replaced_by;
  current_.taken_back = !previous_->taken_back;
  wanted_ = previous_->scene_file;
  tellMotion(wanted_);
  bringOnStage(std::move(*previous_));
  previous_.reset();
}

/// Notes that another bed is wanted; one that is being made is so no longer.
void Session::wantBed(std::string_view why) {
  bed_wanted_ = why;
  if (making_) {
    making_->unwanted = true;
  }
}

/// Does what is wanted and not done yet, as far as it can be now: one bed at a time.
void Session::pursue() {
  if (making_ || coming_) {
    return;
  }
  if (!bed_wanted_.empty()) {
    make(std::exchange(bed_wanted_, {}), false);
  } else {
    changeWhatIsThere();
  }
}

/// False when the loop takes no more now.
bool Session::replaceTools() {
  SceneFile& now = current_.scene_file;
  for (std::size_t tool = 0; tool < hands_.size(); ++tool) {
    ToolParameters& old_tool = tool == 0 ? now.tool : now.more_tools.at(tool - 1).tool;
    ToolMeshSource& old_mesh = tool == 0 ? now.mesh : now.more_tools.at(tool - 1).mesh;
    const ToolParameters& new_tool = tool == 0 ? wanted_.tool : wanted_.more_tools.at(tool - 1).tool;
    if (!sameTool(new_tool, old_tool)) {
      if (!loop_->ask(request::Replace{request::ReplaceTool{new_tool, tool}})) {
        return false;
      }
      old_tool = new_tool;
      old_mesh = tool == 0 ? wanted_.mesh : wanted_.more_tools.at(tool - 1).mesh;
    }
  }
  return true;
}

/// Requests that the loop does not accept now are repeated at the next poll().
void Session::changeWhatIsThere() {
  SceneFile& now = current_.scene_file;
  if (wanted_.bed.gravity_m_s2 != now.bed.gravity_m_s2) {
    if (!loop_->ask(request::Gravity{wanted_.bed.gravity_m_s2})) {
      return;
    }
    now.bed.gravity_m_s2 = wanted_.bed.gravity_m_s2;
  }
  now.body = wanted_.body;
  now.title = wanted_.title;
  if (!replaceTools()) {
    return;
  }
  if (wanted_.bed.soil == now.bed.soil) {
    return;
  }
  if (!isCompatible(current_.made_of, wanted_.bed.soil, stiffnessInStep(toolSet(wanted_).all(), wanted_.bed.soil))) {
    make("soil", true);
  } else if (loop_->ask(request::Soil{SoilLaws(wanted_.bed.soil, grainClasses(wanted_.bed))})) {
    now.bed.soil = wanted_.bed.soil;
  }
}

std::shared_ptr<const Session::Fresh> Session::freshFor(const SceneFile& scene_file) const {
  const auto same = [&scene_file](const std::shared_ptr<const Fresh>& fresh) { return fresh->bed == scene_file.bed; };
  const auto found = std::ranges::find_if(fresh_, same);
  return found == fresh_.end() ? nullptr : *found;
}

/// The first, which the scene was started with, stays.
void Session::keepFresh(std::shared_ptr<const Fresh> fresh) {
  if (std::ranges::find(fresh_, fresh) != fresh_.end()) {
    return;
  }
  if (fresh_.size() == kMaxCachedBeds) {
    fresh_.erase(fresh_.begin() + 1);
  }
  fresh_.push_back(std::move(fresh));
}

void Session::make(std::string_view why, bool as_it_lies) {
  const std::shared_ptr<const Fresh> fresh = as_it_lies ? current_.fresh : freshFor(wanted_);
  LyingSoil lying;
  if (as_it_lies) {
    lying = {.grains = snapshot().position, .held = fresh->held, .stones = snapshot().stones};
  }
  auto making = std::make_unique<Making>();
  making->why = why;
  try {
    making->result = setOut(Work::kBeside,
                            [scene_file = wanted_, fresh, as_it_lies, lying = std::move(lying), making = making.get()] {
                              const auto progress = [making](double time_s, double) {
                                making->settled_s = time_s;
                                return !making->unwanted;
                              };
                              Showing made = as_it_lies ? showLying(scene_file, lying, fresh)
                                             : fresh    ? showFresh(scene_file, fresh)  // no need to settle again
                                                        : showNew(scene_file, progress);
                              made.own_shown = std::make_unique<ShownScene>(*made.scene);
                              made.shown = made.own_shown.get();
                              return made;
                            });
  } catch (const std::exception& error) {  // no thread: the bed that is there stays
    wanted_ = current_.scene_file;
    throw Failure(fmt::format("cannot prepare another bed: {}", error.what()));
  }
  making_ = std::move(making);
}

void Session::bringOnStage(Showing next) {
  coming_ = std::move(next);
  (void)coming_->shown->snapshots.update();  // an old picture, of the last time it was shown
  coming_is_asked_for_ = false;
}

bool Session::adjust(const SoilAdjustment& adjustment) {
  SceneFile next = current_.scene_file;
  next.bed.soil = adjustment.of(next.bed.soil);
  next.tool.friction = adjustment.tool_friction;
  validate(next.bed.soil);
  validate(next.tool);
  if (making_ || coming_ || !bed_wanted_.empty() || wanted_.bed.soil != current_.scene_file.bed.soil ||
      !sameTool(wanted_.tool, current_.scene_file.tool) ||
      (next.bed.soil.contact_cohesion_n > 0) != (current_.scene_file.bed.soil.contact_cohesion_n > 0) ||
      !isCompatible(current_.made_of, next.bed.soil, stiffnessInStep(toolSet(next).all(), next.bed.soil)) ||
      !loop_->ask(request::Adjust{SoilLaws(next.bed.soil, grainClasses(next.bed)), next.tool.friction})) {
    return false;
  }
  for (SceneFile* scene_file : {&current_.scene_file, &wanted_}) {
    scene_file->bed.soil = next.bed.soil;
    scene_file->tool.friction = next.tool.friction;
  }
  return true;
}

bool Session::moveGrain(const GrainMove& move) {
  // The loop moves one particle per tick: without ticks, requests behind a second one would wait for ever.
  return !paused_ && !making_ && !coming_ && bed_wanted_.empty() && loop_->ask(request::MoveGrain{move});
}

void Session::touch(bool on) {
  ask(request::SetContact{on});
}

void Session::pause() {
  ask(request::Pause{});
  paused_ = true;
}

void Session::resume() {
  ask(request::Resume{});
  paused_ = false;
}

void Session::advance(int ticks) {
  if (!paused_) {
    throw RefusedAction("step", "cannot step: the simulation is running; pause it first");
  }
  ask(request::Advance{ticks});
}

void Session::setSpeed(double factor) {
  const auto at_person = std::ranges::find_if(hands_, [](const Hand& hand) { return !hand.device->simulated(); });
  if (at_person != hands_.end()) {
    throw RefusedAction("factor", fmt::format("cannot change the speed: a haptic device moves the tool ({}); only a "
                                              "simulated hand can run slower",
                                              at_person->device->name()));
  }
  ask(request::Speed{requireInRange("factor", factor, {0.01, 1})});
  speed_ = factor;
}

void Session::ask(const LoopRequest& request) {
  if (!loop_->ask(request)) {
    throw Failure("too many requests at once: try again");
  }
}

std::string Session::busy() const {
  if (making_mesh_) {
    return fmt::format("preparing the tool {}", making_mesh_->source.name);
  }
  if (!making_) {
    return coming_ ? "switching to the new bed" : "";
  }
  const double settled_s = making_->settled_s;
  return settled_s > 0 ? fmt::format("preparing the bed: settled for {:.1f} s", settled_s) : "preparing the bed";
}

}  // namespace haptolith

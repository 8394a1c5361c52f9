#include "haptolith/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

/// The tool may be pulled so far beyond the box and above the surface: well within what the loop takes for a hand.
constexpr double kBesideBox_m = 0.15;
constexpr double kAboveSurface_m = 0.35;

std::vector<Vec3> centresOf(const std::vector<Float4>& positions) {
  std::vector<Vec3> centres_m;
  centres_m.reserve(positions.size());
  for (const Float4& p : positions) {
    centres_m.emplace_back(p.x, p.y, p.z);
  }
  return centres_m;
}

/// Whether a bed made for one scene lies as one made for the other would when it is new.
bool sameStart(const Scenario& a, const Scenario& b) {
  return a.bed.soil == b.bed.soil && a.bed.gravity_m_s2 == b.bed.gravity_m_s2;
}

bool sameTool(const ToolParameters& a, const ToolParameters& b) {
  return a.shape == b.shape && a.size_m == b.size_m && a.diameter_m == b.diameter_m && a.thickness_m == b.thickness_m;
}

}  // namespace

/// A bed that is being made.
struct Session::Making {
  std::string_view why;
  std::atomic<bool> unwanted{false};
  std::atomic<double> settled_s{0};
  std::future<Showing> result;
};

Session::Showing Session::show(const Scenario& scenario, const std::vector<Vec3>* centres_m,
                               const SettleProgress& progress) {
  Showing made;
  made.scenario = scenario;
  made.made_of = scenario.bed.soil;
  made.scene = centres_m == nullptr ? std::make_unique<Scene>(scenario.bed, scenario.tool, progress)
                                    : std::make_unique<Scene>(scenario.bed, scenario.tool, *centres_m);
  const Bed& bed = made.scene->bed();
  made.fresh = centresOf(bed.state().position);
  made.fresh.resize(bed.particles());
  made.surface_m = bed.surfaceHeight();
  return made;
}

Session::Session(Scenario scenario, bool keep_records, const SettleProgress& progress)
    : initial_(std::move(scenario)), wanted_(initial_), current_(show(initial_, nullptr, progress)) {
  if (!wanted_.hand.surface_m) {
    wanted_.hand.surface_m = current_.surface_m;
  }
  wish_.manoeuvre = wanted_.hand.manoeuvre;
  wish_.surface_m = *wanted_.hand.surface_m;
  hand_ = std::make_unique<VirtualHand>(wanted_.hand, wanted_.bed.tick_s);
  loop_ = std::make_unique<HapticLoop>(*current_.scene, *hand_, wanted_.loop, keep_records);
  current_.stage = &loop_->stage();
  snapshots_ = &current_.stage->snapshots;
}

Session::~Session() {
  abandonMaking();
}

void Session::start(std::atomic<bool>& stop) {
  thread_ = std::make_unique<LoopThread>(*loop_, wanted_.loop.paced, stop);
}

LoopEnd Session::join() {
  return thread_->join();
}

bool Session::update() {
  return snapshots_->update();
}

bool Session::poll() {
  bool changed = false;
  if (coming_ && &loop_->stage() == coming_->stage) {
    changed = true;
    previous_ = std::move(current_);
    current_ = std::move(*coming_);
    coming_.reset();
    ++scenes_;
    snapshots_ = &current_.stage->snapshots;
    wish_.surface_m = initial_.hand.surface_m.value_or(current_.surface_m);
    ++wish_.beginnings;
    wish();
  }
  if (making_ && !coming_ && making_->result.wait_for(0s) == std::future_status::ready) {
    changed = true;
    const std::unique_ptr<Making> made = std::move(making_);
    try {
      Showing next = made->result.get();
      current_.replaced_by = made->why;
      bringOnStage(std::move(next));
    } catch (const std::exception& error) {  // the bed that is there stays
      problem_ = error.what();
      wanted_ = current_.scenario;
    }
  }
  return changed;
}

void Session::change(const SceneChange& change) {
  const Scenario next = changed(wanted_, change);
  (void)substepsFor(next.bed.soil, next.tool.stiffness_n_m, next.bed.tick_s, next.bed.max_substeps);  // throws
  problem_.clear();
  const bool on_its_way = making_ || coming_;
  const bool other_soil = !(next.bed.soil == wanted_.bed.soil);
  const bool goes_on = canGoOnWith(current_.made_of, next.bed.soil, next.tool.stiffness_n_m);
  Scenario& now = current_.scenario;
  if (next.bed.gravity_m_s2 != now.bed.gravity_m_s2) {
    ask(request::Gravity{next.bed.gravity_m_s2});
    now.bed.gravity_m_s2 = next.bed.gravity_m_s2;
    now.body = next.body;
  }
  if (!sameTool(next.tool, now.tool)) {
    ask(request::Exchange{request::ExchangeTool{next.tool}});
    now.tool = next.tool;
  }
  wanted_ = next;
  if (change.wantsNewBed() || on_its_way) {
    make(next, making_ ? making_->why : "soil", {});
  } else if (other_soil && goes_on) {
    ask(request::Soil{SoilLaws(next.bed.soil)});
    now = next;
  } else if (other_soil) {
    make(next, "soil", centresOf(snapshot().position));  // the soil as it lies
  }
}

void Session::reset() {
  problem_.clear();
  wanted_ = initial_;
  make(wanted_, "reset", {});
}

void Session::level() {
  problem_.clear();
  make(wanted_, "level", {});
}

void Session::undo() {
  if (!previous_ || making_ || coming_) {
    throw InvalidParameter("undo", making_ || coming_ ? "while a bed is being made" : "nothing",
                           "asked for after a change of the bed");
  }
  problem_.clear();
  current_.replaced_by = previous_->replaced_by;
  wanted_ = previous_->scenario;
  bringOnStage(std::move(*previous_));
  previous_.reset();
}

void Session::make(const Scenario& scenario, std::string_view why, std::vector<Vec3> centres_m) {
  abandonMaking();
  if (centres_m.empty() && sameStart(scenario, current_.scenario) && current_.made_of == scenario.bed.soil) {
    centres_m = current_.fresh;  // no need to settle again
  }
  making_ = std::make_unique<Making>();
  making_->why = why;
  making_->result =
      std::async(std::launch::async, [scenario, centres_m = std::move(centres_m), making = making_.get()] {
        Showing made = show(scenario, centres_m.empty() ? nullptr : &centres_m, [making](double time_s, double) {
          making->settled_s = time_s;
          return !making->unwanted;
        });
        made.own_stage = std::make_unique<Stage>(*made.scene);
        made.stage = made.own_stage.get();
        return made;
      });
}

void Session::abandonMaking() noexcept {
  if (making_) {
    making_->unwanted = true;
    making_->result.wait();
    making_.reset();
  }
}

void Session::bringOnStage(Showing next) {
  coming_ = std::move(next);
  ask(request::Exchange{request::ExchangeStage{coming_->stage}});
}

void Session::setSpeed(double factor) {
  ask(request::Speed{requireInRange("factor", factor, {0.01, 1})});
  speed_ = factor;
}

void Session::ask(const LoopRequest& request) {
  // The loop takes them within a tick, but for the tenth of a second in which a tool fades.
  constexpr int kTries = 1000;
  for (int i = 0; i < kTries; ++i) {
    if (loop_->ask(request)) {
      return;
    }
    std::this_thread::sleep_for(1ms);
  }
  throw Failure("the loop takes no more requests: it has stopped");
}

void Session::hold(const Pose& scene_T_tool) {
  const Vec3 low = workspaceLow();
  const Vec3 high = workspaceHigh();
  for (int axis = 0; axis < 3; ++axis) {
    requireInRange(fmt::format("pose[{}]", axis), scene_T_tool.position_m[axis], {low[axis], high[axis]});
  }
  const double norm = scene_T_tool.orientation.norm();
  requireInRange("the norm of the pose's quaternion", norm, {0.9, 1.1});
  wish_.held = Pose{scene_T_tool.position_m, scene_T_tool.orientation.normalized()};
  wish();
}

void Session::release() {
  if (wish_.held) {
    wish_.held = snapshot().scene_T_tool;
    wish();
  }
}

void Session::play(Manoeuvre manoeuvre) {
  wish_.held.reset();
  wish_.manoeuvre = manoeuvre;
  ++wish_.beginnings;
  wish();
}

Vec3 Session::workspaceLow() const noexcept {
  const BedParameters& bed = current_.scenario.bed;
  return {-bed.width_m / 2 - kBesideBox_m, -bed.length_m / 2 - kBesideBox_m, 0};
}

Vec3 Session::workspaceHigh() const noexcept {
  const BedParameters& bed = current_.scenario.bed;
  return {bed.width_m / 2 + kBesideBox_m, bed.length_m / 2 + kBesideBox_m, current_.surface_m + kAboveSurface_m};
}

std::string Session::busy() const {
  if (!making_) {
    return coming_ ? "the bed comes on stage" : "";
  }
  const double settled_s = making_->settled_s;
  return settled_s > 0 ? fmt::format("making the bed: settled for {:.1f} s", settled_s) : "making the bed";
}

}  // namespace haptolith

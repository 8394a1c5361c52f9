#include "haptolith/teleop/robot/site_robot.h"

#include <fmt/format.h>

#include <exception>
#include <optional>
#include <utility>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/platform/start_thread.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/loop_clock.h"

namespace haptolith {

namespace {

/// Initial pose of a scene's hand, over the surface.
Pose homeOf(const SceneFile& site) {
  HandParameters hand = site.hand;
  hand.surface_m = 0;
  return VirtualHand(hand, site.loop.tick_s).read().pose;
}

/// On this machine, at any port that is free.
EndOptions hereWith(const Sending& sending) {
  EndOptions end;
  end.listen = "127.0.0.1:0";
  end.sending = sending;
  return end;
}

}  // namespace

SiteRobot::SiteRobot(const SceneFile& site, std::unique_ptr<Scene> scene, const RobotParameters& parameters,
                     const EndOptions& end)
    : scene_(std::move(scene)),
      surface_m_(meanSurfaceHeight(scene_->bed())),
      robot_(parameters, *scene_, surface_m_, homeOf(site)),
      camera_(scene_->bed(), surface_m_, end.sending.site_period_s, site.loop.tick_s, Work::kBeside),
      server_(robot_, end, site.loop.tick_s) {}

void SiteRobot::tick() {
  server_.receive();
  robot_.tick();
  server_.answer();
  if (const std::optional<SitePacket> seen = camera_.tick(static_cast<std::uint64_t>(robot_.index()))) {
    server_.show(*seen);
  }
}

RobotBehindLink::RobotBehindLink(const SceneFile& site, std::unique_ptr<Scene> scene, const LinkParameters& up,
                                 const LinkParameters& down)
    : tick_s_(site.loop.tick_s),
      robot_(site, std::move(scene), {}, hereWith(sendingOver(up, down))),
      relay_(up, down, {.listen = "127.0.0.1:0", .to = fmt::format("127.0.0.1:{}", robot_.server().port())}) {
  keep("the robot", digging_, &RobotBehindLink::dig);
  keep("the robot's link", passing_, &RobotBehindLink::pass);
}

RobotBehindLink::~RobotBehindLink() {
  ends_ = true;
  for (std::thread* thread : {&digging_, &passing_}) {
    if (thread->joinable()) {
      thread->join();
    }
  }
}

std::string RobotBehindLink::address() const {
  return fmt::format("127.0.0.1:{}", relay_.port());
}

std::string RobotBehindLink::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

void RobotBehindLink::keep(const char* name, std::thread& thread, void (RobotBehindLink::*work)()) {
  const auto run = [this, name, work] {
    try {
      (this->*work)();
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      problem_ = fmt::format("{} has ended: {}", name, error.what());
    }
  };
  try {
    thread = startThread(name, run);
  } catch (...) {
    ends_ = true;  // no thread waits for the other one
    if (digging_.joinable()) {
      digging_.join();
    }
    throw;
  }
}

void RobotBehindLink::dig() {
  LoopClock clock(tick_s_, true);
  clock.start();
  while (!ends_) {
    (void)clock.waitForTick();
    clock.beginTick();
    robot_.tick();
    ready_ = robot_.robot().state() != RobotState::kTaring && robot_.robot().state() != RobotState::kFailed;
    clock.endTick();
    clock.planNextTick();
  }
}

void RobotBehindLink::pass() {
  constexpr double kBetweenLooks_s = 0.02;
  while (!ends_) {
    relay_.run(kBetweenLooks_s);
  }
}

}  // namespace haptolith

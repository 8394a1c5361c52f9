#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/teleop/link/udp_relay.h"
#include "haptolith/teleop/robot/robot_server.h"
#include "haptolith/teleop/robot/site_camera.h"

namespace haptolith {

/// A simulated remote robot: digs in a separate bed, with a camera above it, and communicates with its
/// operator by UDP.
class SiteRobot {
 public:
  /// @param site   whose soil and tool it has; its hand says where the robot waits.
  /// @param scene  of that site, its bed at rest.
  /// @throws InvalidParameter, Failure: as Robot and RobotServer.
  SiteRobot(const SceneFile& site, std::unique_ptr<Scene> scene, const RobotParameters& parameters,
            const EndOptions& end);
  SiteRobot(const SiteRobot&) = delete;
  SiteRobot& operator=(const SiteRobot&) = delete;

  void tick();

  [[nodiscard]] const Robot& robot() const noexcept { return robot_; }
  [[nodiscard]] const RobotServer& server() const noexcept { return server_; }

 private:
  std::unique_ptr<Scene> scene_;
  double surface_m_;
  Robot robot_;
  SiteCamera camera_;
  RobotServer server_;
};

/// A robot on this machine, at the other end of a link with delay, in real time on separate threads.
class RobotBehindLink {
 public:
  /// @throws InvalidParameter, Failure: as SiteRobot and UdpRelay; Failure when there is no thread for it.
  RobotBehindLink(const SceneFile& site, std::unique_ptr<Scene> scene, const LinkParameters& up,
                  const LinkParameters& down);
  ~RobotBehindLink();
  RobotBehindLink(const RobotBehindLink&) = delete;
  RobotBehindLink& operator=(const RobotBehindLink&) = delete;

  /// Address for its operator: HOST:PORT.
  [[nodiscard]] std::string address() const;
  /// Whether it has found its sensor's zero, and waits for an operator or follows one.
  [[nodiscard]] bool isReady() const noexcept { return ready_; }
  /// Reason why it ended early; empty while it runs.
  [[nodiscard]] std::string problem() const;

 private:
  void keep(const char* name, std::thread& thread, void (RobotBehindLink::*work)());
  void dig();
  void pass();

  double tick_s_;
  SiteRobot robot_;
  UdpRelay relay_;
  std::atomic<bool> ends_{false}, ready_{false};
  mutable std::mutex mutex_;
  std::string problem_;
  std::thread digging_, passing_;
};

}  // namespace haptolith

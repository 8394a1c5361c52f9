#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>
#include <thread>
#include <vector>

#include "haptolith/core/process/latest_value.h"
#include "haptolith/device/device_parameters.h"
#include "haptolith/device/drivers/rate_control.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

struct Spnav;

/// State of a SpaceMouse's puck from the daemon, in its counts: pushed along and turned about x to the right, y up and
/// z away from the user; turned right-handed in the frame (x, y, -z), as spnav_posrot_moveobj() of libspnav 1.0 has it.
struct PuckCounts {
  int x = 0, y = 0, z = 0;
  int rx = 0, ry = 0, rz = 0;
};

/// Deflection of the puck, in the device frame: x to the right, y away from the user, z up.
[[nodiscard]] Deflection deflectionOf(const PuckCounts& counts) noexcept;

/// A SpaceMouse or another puck with six degrees of freedom, through libspnav and its daemon, spacenavd: moves and
/// turns the tool by speeds (RateParameters). The daemon reports changes only, so that silence means rest, or a
/// constant push, and the state is never kStale. libspnav has one connection for the whole program, so there is one
/// SpaceMouse at a time. Not to be opened from several threads at once.
class SpaceMouse final : public HapticDevice {
 public:
  /// The daemon's counts at full deflection, as its default sensitivity has it.
  static constexpr double kFullDeflection = 350;

  /// @throws Failure when there is no daemon or no puck, with what to do; InvalidParameter as SteeredHandle and for an
  /// `id` other than "0": the daemon merges all pucks into one.
  SpaceMouse(const DeviceParameters& parameters, double tick_s);

  [[nodiscard]] std::string_view name() const noexcept override { return "SpaceMouse"; }
  /// It shows no force; its workspace is SteeredHandle's.
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput&) noexcept override {}
  void releaseForce() noexcept override {}
  void resumeForce() noexcept override {}
  [[nodiscard]] std::string_view problem() const noexcept override;

 private:
  /// libspnav's connection to the daemon.
  struct Connection {
    Connection();
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    const Spnav& spnav;
  };

  enum class Loss : std::uint8_t { kNone, kPuck, kDaemon };

  struct Told {
    Deflection deflection = {};
    std::uint32_t buttons = 0;
    Loss loss = Loss::kNone;
  };

  void serve(const std::stop_token& stop);

  SteeredHandle handle_;
  Connection connection_;
  LatestValue<Told> told_;
  std::atomic<Loss> loss_{Loss::kNone};
  std::jthread thread_;
};

/// The SpaceMouse, or the reason when there is no SpaceMouse. Takes up to 0.3 s when the daemon does not answer; not
/// for the tick.
[[nodiscard]] std::vector<DeviceReport> findSpaceMouse(const DeviceParameters& parameters);

}  // namespace haptolith

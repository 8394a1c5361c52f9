#include "haptolith/device/drivers/space_mouse.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <string>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/device/drivers/spnav.h"

namespace haptolith {

namespace {

/// Time for which the daemon's thread waits for an event before it checks whether it should end.
constexpr int kSpaceMouseWait_ms = 20;

constexpr std::string_view kNoDaemon =
    "the SpaceMouse daemon, spacenavd, does not respond at /var/run/spnav.sock (or where SPNAV_SOCKET or /etc/spnavrc "
    "says)";
constexpr std::string_view kNoDaemonRemedy = "sudo apt-get install spacenavd; sudo systemctl start spacenavd";
constexpr std::string_view kNoPuck = "spacenavd runs, but has no SpaceMouse";
constexpr std::string_view kNoPuckRemedy = "plug it in; if it is, sudo systemctl restart spacenavd";

/// Whether the daemon has a puck. One that speaks only the first version of its protocol cannot be asked.
bool hasPuck(const Spnav& spnav) {
  return spnav.protocol() < 1 || spnav.dev_type() >= 0;
}

/// Whether the daemon has closed its end: libspnav reports it like an unknown event.
bool hungUp(const Spnav& spnav) {
  char byte = 0;
  const ssize_t there = recv(spnav.fd(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return there == 0 || (there < 0 && errno != EAGAIN && errno != EINTR);
}

}  // namespace

Deflection deflectionOf(const PuckCounts& counts) noexcept {
  return {Vec3(counts.x, counts.z, counts.y) / SpaceMouse::kFullDeflection,
          Vec3(counts.rx, counts.rz, counts.ry) / SpaceMouse::kFullDeflection};
}

SpaceMouse::Connection::Connection() : spnav(Spnav::get()) {
  if (spnav.fd() >= 0) {
    throw Failure("the SpaceMouse is already in use by this program");
  }
  if (spnav.open() != 0) {
    throw Failure(fmt::format("{}: {}", kNoDaemon, kNoDaemonRemedy));
  }
}

SpaceMouse::Connection::~Connection() {
  spnav.close();
}

SpaceMouse::SpaceMouse(const DeviceParameters& parameters, double tick_s) : handle_(tick_s) {
  if (!parameters.id.empty() && parameters.id != "0") {
    throw InvalidParameter("id", fmt::format("'{}'", parameters.id),
                           "empty or 0: spacenavd combines all SpaceMice into one");
  }
  if (!hasPuck(connection_.spnav)) {
    throw Failure(fmt::format("{}: {}", kNoPuck, kNoPuckRemedy));
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
}

DeviceLimits SpaceMouse::limits() const noexcept {
  return SteeredHandle::limits();
}

DeviceInput SpaceMouse::read() noexcept {
  told_.update();
  const Told& told = told_.latest();
  const Movement& handle = handle_.drive(rateOf(told.deflection, {}));
  return {.pose = handle.pose,
          .twist = handle.twist,
          .buttons = told.buttons,
          .state = told.loss == Loss::kNone   ? DeviceState::kLive
                   : told.loss == Loss::kPuck ? DeviceState::kStale
                                              : DeviceState::kLost};
}

std::string_view SpaceMouse::problem() const noexcept {
  switch (loss_.load(std::memory_order_relaxed)) {
    case Loss::kPuck: return "the SpaceMouse was unplugged: plug it in to continue";
    case Loss::kDaemon:
      return "the SpaceMouse daemon, spacenavd, has ended: sudo systemctl start spacenavd, then start haptolith again";
    case Loss::kNone: break;
  }
  return {};
}

void SpaceMouse::serve(const std::stop_token& stop) {
  const Spnav& spnav = connection_.spnav;
  constexpr int kButtons = 32;
  Told told;
  const auto publish = [&] {
    loss_.store(told.loss, std::memory_order_relaxed);
    told_.draft() = told;
    told_.publish();
  };
  while (!stop.stop_requested()) {
    pollfd daemon{.fd = spnav.fd(), .events = POLLIN, .revents = 0};
    if (poll(&daemon, 1, kSpaceMouseWait_ms) <= 0) {
      continue;
    }
    if (hungUp(spnav)) {
      told = {.loss = Loss::kDaemon};
      publish();
      return;
    }
    spnav_event event{};
    switch (spnav.poll_event(&event)) {
      case SPNAV_EVENT_MOTION:
        told.loss = Loss::kNone;  // whatever was unplugged, something is there
        told.deflection = deflectionOf({.x = event.motion.x,
                                        .y = event.motion.y,
                                        .z = event.motion.z,
                                        .rx = event.motion.rx,
                                        .ry = event.motion.ry,
                                        .rz = event.motion.rz});
        break;
      case SPNAV_EVENT_BUTTON:
        if (event.button.bnum >= 0 && event.button.bnum < kButtons) {
          const std::uint32_t bit = 1U << event.button.bnum;
          told.buttons = event.button.press != 0 ? told.buttons | bit : told.buttons & ~bit;
        }
        break;
      case SPNAV_EVENT_DEV: told = {.loss = event.dev.op == SPNAV_DEV_RM ? Loss::kPuck : Loss::kNone}; break;
      default: continue;  // settings, and what no daemon says
    }
    publish();
  }
}

std::vector<DeviceReport> findSpaceMouse(const DeviceParameters&) {
  DeviceReport report{
      .kind = DeviceKind::kSpaceMouse, .name = "SpaceMouse", .id = "0", .usable = true, .why_not = {}, .remedy = {}};
  const auto why_not = [&report](std::string why, std::string_view remedy = {}) {
    report.usable = false;
    report.why_not = std::move(why);
    report.remedy = remedy;
    return std::vector{report};
  };
  const Spnav* spnav = nullptr;
  try {
    spnav = &Spnav::get();
  } catch (const Failure& failure) {
    return why_not(failure.what());
  }
  if (spnav->fd() >= 0) {
    return {report};  // open: then it is there
  }
  if (spnav->open() != 0) {
    return why_not(std::string(kNoDaemon), kNoDaemonRemedy);
  }
  const bool has_puck = hasPuck(*spnav);
  spnav->close();
  return has_puck ? std::vector{report} : why_not(std::string(kNoPuck), kNoPuckRemedy);
}

}  // namespace haptolith

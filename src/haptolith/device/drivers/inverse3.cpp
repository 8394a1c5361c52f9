#include "haptolith/device/drivers/inverse3.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/core/platform/start_thread.h"
#include "haptolith/core/process/latest_value.h"
#include "haptolith/device/drivers/inverse3_messages.h"

namespace haptolith {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::string_view kHaplyAddress = "ws://localhost:10001";
constexpr std::string_view kInstall =
    "start the Haply Hub or the haply-inverse-service, or give the service's address as ws://HOST:PORT";
constexpr std::string_view kPlugIn = "plug it in, switch it on, and check that the Haply Hub shows it";
constexpr auto kOpenPatience = 2s;
constexpr auto kFindPatience = 300ms;
constexpr auto kHaplyPeriod = 1ms;
constexpr std::int64_t kFresh_ns = 20'000'000;
constexpr std::int64_t kMostPatience_ns = 16 * kFresh_ns;
constexpr std::size_t kLargestMessage = 256 * 1024;  // bytes: an inventory is some kilobytes

struct Address {
  std::vector<Tcp::endpoint> endpoints;
  std::string host;  // and port, as HTTP wants them
};

Address addressOf(std::string_view text) {
  const auto refuse = [&] {
    return InvalidParameter("address", fmt::format("'{}'", text),
                            "ws://HOST:PORT with an IP address or localhost, for example ws://localhost:10001");
  };
  constexpr std::string_view kScheme = "ws://";
  std::string_view rest = text;
  if (!rest.starts_with(kScheme)) {
    throw refuse();
  }
  rest.remove_prefix(kScheme.size());
  if (rest.ends_with('/')) {
    rest.remove_suffix(1);
  }
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos) {
    throw refuse();
  }
  std::string_view host = rest.substr(0, colon);
  const std::string_view digits = rest.substr(colon + 1);
  std::uint16_t port = 0;
  const auto [end, wrong] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (wrong != std::errc{} || end != digits.data() + digits.size() || port == 0) {
    throw refuse();
  }
  Address address{{}, std::string(rest)};
  if (host == "localhost") {
    address.endpoints = {{asio::ip::address_v4::loopback(), port}, {asio::ip::address_v6::loopback(), port}};
    return address;
  }
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  }
  beast::error_code error;
  const auto ip = asio::ip::make_address(std::string(host), error);
  if (error) {
    throw refuse();
  }
  address.endpoints = {{ip, port}};
  return address;
}

/// A session with the service. Its start waits up to the given time; the rest happens on the thread that runs
/// `io`.
struct Session {
  asio::io_context io{1};
  websocket::stream<beast::tcp_stream> stream{io};
  beast::flat_buffer buffer{kLargestMessage};
  std::string inventory_text;
  HaplyInventory inventory;

  /// @throws InvalidParameter, Failure.
  Session(const std::string& where, Clock::duration timeout) {
    const Address address = addressOf(where);
    const Clock::time_point until = Clock::now() + timeout;
    const auto wait = [&](std::string_view what, std::string_view remedy, const auto& start) {
      std::optional<beast::error_code> ended;
      start([&ended](beast::error_code error, const auto&...) { ended = error; });
      io.restart();
      while (!ended && io.run_one_until(until) != 0) {
      }
      if (!ended || *ended) {
        throw Failure(fmt::format("cannot {} the Haply service at {}: {}; {}", what, where,
                                  ended ? ended->message() : "it does not respond in time", remedy));
      }
    };
    auto& tcp = beast::get_lowest_layer(stream);
    wait("reach", kInstall, [&](auto done) { tcp.async_connect(address.endpoints, done); });
    tcp.socket().set_option(Tcp::no_delay(true));
    stream.read_message_max(kLargestMessage);
    constexpr std::string_view kOther = "another program listens there: give the service's address as ws://HOST:PORT";
    wait("talk to", kOther, [&](auto done) { stream.async_handshake(address.host, "/", done); });
    wait("hear from", "restart the service", [&](auto done) { stream.async_read(buffer, done); });
    inventory_text = beast::buffers_to_string(buffer.data());
    buffer.consume(buffer.size());
    std::optional<HaplyInventory> told = parseHaplyInventory(inventory_text);
    if (!told) {
      throw Failure(
          fmt::format("the Haply service at {} does not begin with the list of its devices; {}", where, kOther));
    }
    inventory = *std::move(told);
    io.restart();
  }
};

std::string usualAddressOr(const std::string& address) {
  return address.empty() ? std::string(kHaplyAddress) : address;
}

}  // namespace

class Inverse3::Connection {
 public:
  explicit Connection(const DeviceParameters& parameters)
      : where_(usualAddressOr(parameters.address)), session_(where_, kOpenPatience) {
    const std::vector<std::string>& there = session_.inventory.devices;
    if (there.empty()) {
      throw Failure(fmt::format("the Haply service at {} has no Inverse3; {}", where_, kPlugIn));
    }
    if (!parameters.id.empty() && std::ranges::find(there, parameters.id) == there.end()) {
      throw Failure(fmt::format("the Haply service at {} has no Inverse3 '{}', only {}; choose one of them, or {}",
                                where_, parameters.id, fmt::join(there, ", "), kPlugIn));
    }
    device_ = parameters.id.empty() ? there.front() : parameters.id;
    grip_ = session_.inventory.grips.empty() ? std::string() : session_.inventory.grips.front();
    input_.state = DeviceState::kStale;
    nothing_waited_ns_ = monotonicNs();
    take(session_.inventory_text);
    thread_ = startThread("the Inverse3", [this] { serve(); });
  }

  ~Connection() {
    over_.store(true);
    session_.io.stop();
    thread_.join();
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // For the loop's thread.

  [[nodiscard]] DeviceInput read() noexcept {
    if (told_.update()) {
      const Inverse3State& state = told_.latest().state;
      input_.pose.position_m = state.position_m;
      input_.twist.linear_m_s = state.velocity_m_s;
      input_.pose.orientation = state.orientation.value_or(input_.pose.orientation);
      input_.buttons = state.buttons.value_or(input_.buttons);
    }
    const bool fresh = told_.latest().at_ns != 0 && monotonicNs() - told_.latest().at_ns <= kFresh_ns;
    input_.state = lost_.load(std::memory_order_acquire) ? DeviceState::kLost
                   : fresh                               ? DeviceState::kLive
                                                         : DeviceState::kStale;
    if (input_.state != DeviceState::kLive) {
      input_.twist = {};
    }
    return input_;
  }

  void write(const Vec3& force_n) noexcept {
    wanted_.draft() = {force_n, monotonicNs()};
    wanted_.publish();
  }

  // For any thread.

  void setReleased(bool released) noexcept {
    zero_sent_.store(false);
    released_.store(released);
  }
  [[nodiscard]] bool isReleased() const noexcept { return zero_sent_.load() || lost_.load(); }
  [[nodiscard]] bool hasGrip() const noexcept { return !grip_.empty(); }
  [[nodiscard]] std::uint64_t badAnswers() const noexcept { return bad_answers_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::string_view problem() const noexcept {
    return lost_.load(std::memory_order_acquire) ? std::string_view(problem_) : std::string_view{};
  }

 private:
  struct Told {
    Inverse3State state;
    std::int64_t at_ns = 0;  ///< at the earliest
  };
  struct Wanted {
    Vec3 force_n = Vec3::Zero();
    std::int64_t at_ns = 0;
  };

  // For the driver's thread: reads messages as they arrive, and sends a force each millisecond, unless the one before
  // has not been answered or messages still wait to be read: neither the service nor this thread is given more than it
  // can do, else the arm would be shown as it was ever longer ago. Messages without end hold no force back for long,
  // and for longer each time, so that a slow reader also catches up.

  void serve() {
    receive();
    send();
    wait();
    while (!over_.load() && !lost_.load()) {
      const std::int64_t now_ns = monotonicNs();
      if (session_.io.poll_one() == 0) {  // later messages are not older than this
        nothing_waited_ns_ = now_ns;
        caught_up_ = answered_;
        session_.io.run_one();
      }
    }
  }

  void wait() {
    timer_.async_wait([this](beast::error_code error) {
      if (error) {
        return;
      }
      const bool zero_is_due = released_.load() && !zero_sent_.load();
      const bool held_back_long = answered_ && monotonicNs() - sent_ns_ > patience_ns_;
      if (!writing_ && (caught_up_ || held_back_long || zero_is_due)) {
        patience_ns_ =
            caught_up_ ? std::max(kFresh_ns, patience_ns_ / 2) : std::min(kMostPatience_ns, 2 * patience_ns_);
        send();
      }
      timer_.expires_at(std::max(timer_.expiry() + kHaplyPeriod, Clock::now()));  // missed periods are skipped
      wait();
    });
  }

  void send() {
    const bool released = released_.load();
    command_ = inverse3Command(device_, released ? Vec3(Vec3::Zero()) : force(), session_.inventory.dialect);
    sent_ns_ = monotonicNs();
    writing_ = true;
    answered_ = caught_up_ = false;
    session_.stream.async_write(asio::buffer(command_), [this, released](beast::error_code error, std::size_t) {
      writing_ = false;
      if (error) {
        lose(error);
      } else if (released) {
        zero_sent_.store(true);
      }
    });
  }

  void receive() {
    session_.stream.async_read(session_.buffer, [this](beast::error_code error, std::size_t) {
      if (error) {
        lose(error);
        return;
      }
      answered_ = true;
      take(beast::buffers_to_string(session_.buffer.data()));
      session_.buffer.consume(session_.buffer.size());
      receive();
    });
  }

  [[nodiscard]] Vec3 force() {
    wanted_.update();
    const Wanted& wanted = wanted_.latest();
    const bool believed = monotonicNs() - wanted.at_ns <= kFresh_ns && wanted.force_n.allFinite();
    return believed ? wanted.force_n : Vec3(Vec3::Zero());
  }

  void take(const std::string& message) {
    const std::optional<Inverse3State> state = parseInverse3State(message, device_, grip_);
    if (!state) {
      bad_answers_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    // The loop may miss a message, and with it the only news of the grip.
    if (state->orientation) {
      newest_.orientation = state->orientation;
    }
    if (state->buttons) {
      newest_.buttons = state->buttons;
    }
    newest_.position_m = state->position_m;
    newest_.velocity_m_s = state->velocity_m_s;
    told_.draft() = {newest_, nothing_waited_ns_};
    told_.publish();
  }

  void lose(beast::error_code error) {
    problem_ = fmt::format("the Haply service at {} has ended the connection: {}; check that it runs, then start again",
                           where_, error.message());
    lost_.store(true, std::memory_order_release);
  }

  std::string where_;
  Session session_;
  std::string device_, grip_;
  std::string command_;
  asio::steady_timer timer_{session_.io, Clock::now()};
  bool writing_ = false;
  bool answered_ = false, caught_up_ = false;  ///< since the force was sent; and nothing waited after that
  std::int64_t sent_ns_ = 0;
  std::int64_t patience_ns_ = kFresh_ns;  ///< for how long a force is held back at most
  std::int64_t nothing_waited_ns_ = 0;    ///< when that was seen last: no message that comes now is older
  Inverse3State newest_;

  LatestValue<Told> told_;
  LatestValue<Wanted> wanted_;
  DeviceInput input_;
  std::atomic<bool> released_{false}, zero_sent_{false}, lost_{false}, over_{false};
  std::atomic<std::uint64_t> bad_answers_{0};
  std::string problem_;
  std::thread thread_;
};

Inverse3::Inverse3(const DeviceParameters& parameters)
    : parameters_(parameters), connection_(std::make_unique<Connection>(parameters)) {}
Inverse3::~Inverse3() = default;

DeviceLimits Inverse3::limits() const noexcept {
  DeviceLimits limits;
  // The service's documentation gives no largest force; this is on the safe side until one has been measured.
  limits.max_force_n = 5;
  limits.max_torque_nm = 0;
  limits.max_gripper_force_n = 0;
  limits.max_force_rate_n_s = limits.max_force_n / 0.003;
  limits.max_stiffness_n_m = 400;  // the stiffest that the sample "Force and Position" of Haply's Unity package offers
  // docs.haply.co, Inverse Service 3.5: tutorial 06 keeps an Inverse3 within 100 mm; the pose in "WebSocket Protocol".
  limits.workspace_centre_m = Vec3(0, -0.12, 0.15);
  limits.workspace_radius_m = 0.1;
  limits.turns = connection_->hasGrip();
  // A message goes through the service on its way to the device and back; neither has been measured.
  limits.delay_s = 0.005;
  limits.delay_known = false;
  limits.resolution_m = 1e-4;
  return measured(limits, parameters_);
}

DeviceInput Inverse3::read() noexcept {
  return connection_->read();
}
void Inverse3::write(const DeviceOutput& output) noexcept {
  connection_->write(output.wrench.force_n);
}
void Inverse3::releaseForce() noexcept {
  connection_->setReleased(true);
}
ForceRelease Inverse3::forceRelease() const noexcept {
  return connection_->isReleased() ? ForceRelease::kDone : ForceRelease::kUnderWay;
}
void Inverse3::resumeForce() noexcept {
  connection_->setReleased(false);
}
std::string_view Inverse3::problem() const noexcept {
  return connection_->problem();
}
std::uint64_t Inverse3::badAnswers() const noexcept {
  return connection_->badAnswers();
}

std::vector<DeviceReport> findInverse3(const DeviceParameters& parameters) {
  const std::string where = usualAddressOr(parameters.address);
  const auto none = [](std::string why_not, std::string_view remedy) {
    return std::vector{DeviceReport{.kind = DeviceKind::kInverse3,
                                    .name = "Inverse3",
                                    .id = {},
                                    .usable = false,
                                    .why_not = std::move(why_not),
                                    .remedy = std::string(remedy)}};
  };
  try {
    const Session session(where, kFindPatience);
    if (session.inventory.devices.empty()) {
      return none(fmt::format("the Haply service at {} has no Inverse3", where), kPlugIn);
    }
    std::vector<DeviceReport> reports;
    for (const std::string& id : session.inventory.devices) {
      reports.push_back(
          {.kind = DeviceKind::kInverse3, .name = "Inverse3", .id = id, .usable = true, .why_not = {}, .remedy = {}});
    }
    return reports;
  } catch (const Failure& failure) {
    const std::string_view what = failure.what();  // "what was tried; what to do"
    const std::size_t end = what.rfind("; ");
    return none(std::string(what.substr(0, end)), what.substr(end + 2));
  }
}

}  // namespace haptolith

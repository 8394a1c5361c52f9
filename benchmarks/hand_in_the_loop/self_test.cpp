#include "self_test.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstring>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "session.h"

namespace hand_in_the_loop {

namespace {

int failures = 0;

void check(bool holds, const std::string& what) {
  std::printf("%s %s\n", holds ? "ok    " : "FAILED", what.c_str());
  failures += holds ? 0 : 1;
}

void near(double value, double expected, double within, const std::string& what) {
  char text[200];
  std::snprintf(text, sizeof text, "%s: %.6g, expected %.6g +- %.2g", what.c_str(), value, expected, within);
  check(std::abs(value - expected) <= within, text);
}

/// Mock program: answers each packet immediately with a force that depends only on the position.
class StandIn {
 public:
  explicit StandIn(std::function<Vec3(const Vec3&)> force)
      : force_(std::move(force)), socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    const timeval patience{.tv_sec = 0, .tv_usec = 50'000};  // to check for the end
    // NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast)
    if (socket_ < 0 || bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
        setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0) {
      throw std::runtime_error("cannot make a UDP socket");
    }
    // NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { answer(); });
  }
  ~StandIn() {
    ends_ = true;
    thread_.join();
    close(socket_);
  }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  void answer() {
    std::uint32_t number = 0;
    while (!ends_) {
      std::array<std::byte, DevicePacket::kBytes + 1> bytes{};
      sockaddr_in sender{};
      socklen_t size = sizeof sender;
      // NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast)
      auto* address = reinterpret_cast<sockaddr*>(&sender);
      const ssize_t received = recvfrom(socket_, bytes.data(), bytes.size(), 0, address, &size);
      // NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)
      if (received < 0) {
        continue;
      }
      const auto packet = parseDevicePacket(std::span(bytes).first(static_cast<std::size_t>(received)));
      if (packet) {
        const auto reply = bytesOf(Answer{.live = packet->held,
                                          .sequence = packet->sequence,
                                          .number = number++,
                                          .time = packet->time,
                                          .force_n = force_(packet->position_m)});
        (void)sendto(socket_, reply.data(), reply.size(), MSG_NOSIGNAL, address, size);
      }
    }
  }

  std::function<Vec3(const Vec3&)> force_;
  int socket_;
  std::uint16_t port_ = 0;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

constexpr double kPeriod_s = 1e-3;

/// Mass on a spring that is sampled with period T, held for T, and delayed:
///
///     m s^2 + b s + K exp(-s delay) (1 - exp(-s T)) / (s T) = 0
///
/// @returns the root near that of the spring without delay; its real part is the growth rate of a vibration.
std::complex<double> root(double mass, double damping, double stiffness, double delay_s) {
  using Complex = std::complex<double>;
  const auto f = [&](Complex s) {
    return mass * s * s + damping * s +
           stiffness * std::exp(-s * delay_s) * (1.0 - std::exp(-s * kPeriod_s)) / (s * kPeriod_s);
  };
  Complex s(0, std::sqrt(stiffness / mass));
  for (int i = 0; i < 50; ++i) {
    constexpr double kSmall = 1e-4;
    s -= f(s) * kSmall / (f(s + kSmall) - f(s));
  }
  return s;
}

/// Returns the damping at which it neither grows nor decays.
double limit(double mass, double stiffness, double delay_s) {
  double low = 0, high = 10 * stiffness * (kPeriod_s + delay_s);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (root(mass, middle, stiffness, delay_s).real() > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

struct Sample {
  double at_s, z_m, device_j;
};

struct Swing {
  Measures measures;
  std::vector<Sample> samples;
  double unbalanced_j = 0, turned_over_j = 0;  ///< imbalance of the ledger, and total energy through it
};

/// Simulates a handle on a spring of the mock program, released 0.5 mm from its equilibrium.
Swing swing(StandIn& stand_in, double mass, double damping, double delay_ms, DelayAt at) {
  Settings settings;
  settings.handle = {.mass_kg = mass, .damping_n_s_m = damping};
  settings.device.delay_ms = delay_ms;
  settings.device.delay_at = at;
  settings.device.velocity_share = 1;
  Swing result;
  InStep in_step{.port = stand_in.port(),
                 .wanted = [](double) { return Wanted{}; },
                 .hand = {},
                 .seconds = 4,
                 .start_m = {0, 0, 0.0005},
                 .follow =
                     [&](double at_s, const Handle& handle) {
                       const Ledger& ledger = handle.ledger();
                       result.samples.push_back({at_s, handle.position().z, ledger.device_j});
                       result.unbalanced_j = std::max(
                           result.unbalanced_j, std::abs(ledger.device_j + ledger.hand_j + ledger.damping_j +
                                                         ledger.weight_j + ledger.stops_j - handle.kineticEnergy()));
                       result.turned_over_j = std::max(result.turned_over_j, -ledger.damping_j);
                     }};
  result.measures = judgeInStep(settings, in_step);
  return result;
}

/// Returns the maximum distance from equilibrium between two times, and its time.
Sample highest(const std::vector<Sample>& samples, double from_s, double to_s) {
  Sample best{0, 0, 0};
  for (const Sample& s : samples) {
    if (s.at_s >= from_s && s.at_s < to_s && std::abs(s.z_m) > std::abs(best.z_m)) {
      best = s;
    }
  }
  return best;
}

void testPackets() {
  DevicePacket sent;
  sent.sequence = 0x01020304;
  sent.time = 7;
  sent.position_m = {0.5, 0, -1};
  const auto bytes = bytesOf(sent);
  check(std::memcmp(bytes.data(), "HLDV\x01\x00\x01\x00\x04\x03\x02\x01", 12) == 0 && bytes[16] == std::byte{7} &&
            bytes[30] == std::byte{0xe0} && bytes[31] == std::byte{0x3f} && bytes[47] == std::byte{0xbf} &&
            bytes[54] == std::byte{0xf0} && bytes[55] == std::byte{0x3f},
        "a packet lies in memory as docs/reference/udp.md says");
  const Answer answer{.live = true, .sequence = 3, .number = 9, .force_n = {0, 0, 2}, .grip_n = -1};
  auto answered = bytesOf(answer);
  const auto parsed = parseAnswer(answered);
  check(parsed && parsed->live && !parsed->let_go && parsed->number == 9 && parsed->force_n == answer.force_n &&
            parsed->grip_n == -1 && answered[6] == std::byte{1} && answered[46] == std::byte{0x00} &&
            answered[47] == std::byte{0x40},
        "an answer is read from where docs/reference/udp.md says");
  answered[4] = std::byte{2};
  check(!parseAnswer(answered) && !parseAnswer(std::span(answered).first(79)), "another version or size is no answer");
}

void testDevice() {
  Device late({.delay_ms = 4, .delay_at = DelayAt::kSplit}, 1);
  late.follow(0, {});
  late.follow(1'000'000, {0, 0, 1});
  check(late.read(2'000'000).position_m.z == 0 && late.read(3'000'000).position_m.z == 1,
        "half of the delay at measuring");
  late.take(Answer{.live = true, .force_n = {0, 0, 5}}, 3'000'000);
  check(late.shown(4'999'999).z == 0 && late.shown(5'000'000).z == 5, "half of the delay at showing");
  check(late.shown(25'000'000).z == 5 && late.shown(25'000'001).z == 0, "no force 20 ms after the last answer");

  Device coarse({.step_mm = 0.06, .noise_mm = 0.1}, 1);
  coarse.follow(0, {});
  double squares = 0, largest_m = 0;
  bool in_steps = true;
  constexpr int kReadings = 20000;
  for (int i = 0; i < kReadings; ++i) {
    const double x = coarse.read(i).position_m.x;
    in_steps = in_steps && std::abs(x / 6e-5 - std::round(x / 6e-5)) < 1e-9;
    squares += x * x;
    largest_m = std::max(largest_m, std::abs(x));
  }
  // Uniform noise of +-0.1 mm in steps of 0.06 mm: 0, 0.06, 0.12 mm of either sign with fractions 0.3, 0.3 and 0.05.
  near(1e3 * std::sqrt(squares / kReadings), std::sqrt(0.6 * 0.06 * 0.06 + 0.1 * 0.12 * 0.12), 1e-3,
       "noise in steps, rms mm");
  check(in_steps && largest_m < 1.21e-4, "positions are told in steps");
}

void testMeasures() {
  HighPass filter(6);
  double highest_50 = 0, highest_1 = 0;
  for (const double hz : {50.0, 1.0}) {
    HighPass fresh(6);
    for (int i = 0; i < 4000; ++i) {
      const double y = fresh.step(std::sin(2 * std::numbers::pi * hz * kPeriod_s * i));
      double& most = hz > 6 ? highest_50 : highest_1;
      most = i > 2000 ? std::max(most, y) : most;
    }
  }
  near(highest_50, 1, 0.015, "50 Hz pass the vibration's filter");
  near(highest_1, 1.0 / 36, 0.002, "1 Hz does not");

  const Bars bars;
  Observer observer(bars, 1);
  Answer answer{.live = true, .force_n = {0, 0, 3}};
  for (int i = 0; i < 1000; ++i) {
    answer.number = static_cast<std::uint32_t>(i);
    answer.force_n.z = i < 500 ? 3 + 0.5 * (i == 100) : i < 600 ? 0 : 1;
    observer.answer(1e-3 * i, Phase::kStill, answer);
    if (i == 475) {
      observer.open(3, -0.002);
    }
    observer.handle(1e-3 * i, {}, i < 450 ? -0.01 : i < 480 ? -0.002 : i < 490 ? -0.0015 : -0.003);
  }
  const Measures m = observer.measures();
  near(m.largest_step_n_ms, 1, 1e-9, "largest step without the fall to zero");
  near(m.first_let_go_s, 0.5, 1e-9, "let go when the force falls to zero at once");
  near(m.let_go_share, 0.1, 1e-9, "share of let go");
  near(m.energy_rise_mj, 8.5, 1e-9, "energy's rise");
  near(m.opened_n, 3, 1e-9, "force when the hand opened");
  near(m.opened_mj, 0.5, 1e-9, "energy since the hand opened");
  near(m.energy_max_mj, 0, 1e-9, "energy's maximum since the start");

  Measures shaken;
  shaken.vibration_before_mm = shaken.vibration_after_mm = 1;
  Measures falling = shaken;
  falling.vibration_after_mm = 0.5;
  Measures given = falling;
  given.energy_max_mj = 6;
  given.first_excess_s = 5;
  check(judge(shaken, {}, bars) == Verdict::kShaking && judge(falling, {}, bars) == Verdict::kOk &&
            judge(given, {}, bars) == Verdict::kEnergy && judge(given, {3}, bars) == Verdict::kEnergy &&
            judge(given, {5.4}, bars) == Verdict::kReleased && judge(given, {5.6}, bars) == Verdict::kEnergy,
        "verdicts");
}

void testSprings() {
  constexpr double kMass = 0.1, kStiffness = 300;
  StandIn spring([](const Vec3& x) { return Vec3{0, 0, -kStiffness * x.z}; });
  struct Case {
    double delay_ms;
    DelayAt at;
    double share;  // relative to the damping at the limit
  };
  for (const Case& c : {Case{0, DelayAt::kShow, 3}, Case{0, DelayAt::kShow, 0.7}, Case{2, DelayAt::kSplit, 1.3},
                        Case{2, DelayAt::kShow, 0.7}, Case{2, DelayAt::kMeasure, 0.7}}) {
    const double at_limit = limit(kMass, kStiffness, 1e-3 * c.delay_ms);
    const double rate = root(kMass, c.share * at_limit, kStiffness, 1e-3 * c.delay_ms).real();
    const Swing result = swing(spring, kMass, c.share * at_limit, c.delay_ms, c.at);
    const Sample early = highest(result.samples, 0.5, 1), late = highest(result.samples, 3.5, 4);
    const std::string what = "spring of 300 N/m, " + std::to_string(static_cast<int>(c.delay_ms)) +
                             " ms late, damped " + std::to_string(static_cast<int>(100 * c.share)) +
                             " % of what it needs: ";
    near(std::log(std::abs(late.z_m / early.z_m)) / (late.at_s - early.at_s), rate, 0.03 * std::abs(rate) + 0.02,
         what + "growth, 1/s");
    check((judge(result.measures, {}, {.energy_mj = 1e9, .still_mm = 1e-3}) == Verdict::kShaking) == (c.share < 1),
          what + (c.share < 1 ? "shakes" : "comes to rest"));
    check(result.unbalanced_j < 0.01 * result.turned_over_j + 1e-9, what + "no energy appears in the handle");
  }
  // Limit K (T / 2 + delay) to first order (Colgate and Schenkel).
  near(limit(kMass, kStiffness, 0), kStiffness * kPeriod_s / 2, 1e-3, "damping at the limit, no delay");

  // At the limit the spring transfers the power K A^2 w sin(w late) / 2, late = T / 2 + delay.
  const double delay_s = 2e-3, at_limit = limit(kMass, kStiffness, delay_s);
  const Swing steady = swing(spring, kMass, at_limit, 1e3 * delay_s, DelayAt::kSplit);
  const double w = root(kMass, at_limit, kStiffness, delay_s).imag();
  const Sample from = highest(steady.samples, 0.5, 0.7), to = highest(steady.samples, 3.5, 3.7);
  const double power = kStiffness * from.z_m * from.z_m * w * std::sin(w * (delay_s + kPeriod_s / 2)) / 2;
  near(1e3 * (to.device_j - from.device_j), 1e3 * power * (to.at_s - from.at_s), 0.02e3 * power * (to.at_s - from.at_s),
       "energy that a late spring gives, mJ");
}

void testWall() {
  constexpr double kStiffness = 1000;
  StandIn wall([](const Vec3& x) { return Vec3{0, 0, x.z < 0 ? -kStiffness * x.z : 0}; });
  Settings settings;
  const Hand hand{800, 10};
  InStep in_step{.port = wall.port(),
                 .wanted =
                     [](double at_s) {
                       return Wanted{{0, 0, 0.005 - 0.02 * std::min(1.0, at_s)}, {}};
                     },
                 .hand = hand,
                 .weight_n = 0,
                 .seconds = 4,
                 .start_m = {0, 0, 0.005},
                 .follow = {}};
  // judgeInStep() reports everything to the observer as before the script's phases; its phases are not used here.
  settings.script = {.wait_s = 0.1, .press_s = 1, .settle_s = 0.5, .draw_s = 0, .still_s = 2.4};
  const Measures m = judgeInStep(settings, in_step);
  // Hand and wall in series, with 15 mm between the wall's surface and the hand's target.
  const double force_n = 0.015 * kStiffness * hand.stiffness_n_m / (kStiffness + hand.stiffness_n_m);
  near(m.still_n, force_n, 0.01 * force_n, "force of a hand at a wall, N");
  check(m.energy_max_mj < 0.01 && judge(m, {}, {}) == Verdict::kOk, "a hand at a wall gives energy and takes none");
  near(m.energy_end_mj, -1e3 * force_n * force_n / (2 * kStiffness), 0.3, "energy in the wall, mJ");
  near(m.answers, 4000, 1, "an answer a tick");
}

}  // namespace

int selfTest() {
  failures = 0;
  testPackets();
  testDevice();
  testMeasures();
  testSprings();
  testWall();
  std::printf("%s\n", failures == 0 ? "all checks hold" : (std::to_string(failures) + " checks failed").c_str());
  return failures;
}

}  // namespace hand_in_the_loop

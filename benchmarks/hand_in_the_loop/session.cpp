#include "session.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <fstream>
#include <memory>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "program.h"

namespace hand_in_the_loop {

namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr int kSteps = 20;  // steps of the handle per tick: 20 kHz
constexpr std::int64_t kStep_ns = kTick_ns / kSteps;

constexpr std::array<Grip, 6> kGrips = {{{"stiff", {1500, 20}},
                                         {"firm", {800, 10}},
                                         {"medium", {300, 5}},
                                         {"loose", {50, 1}},
                                         {"none", {300, 5}, Grip::Opens::kAtSoil},
                                         {"letgo", {300, 5}, Grip::Opens::kWhenStill}}};

constexpr std::array<std::pair<const char*, const char*>, 4> kScenes = {
    {{"A", "title = \"A: the scene icra2021, P3 on the Moon\"\n[soil]\npreset = \"P3\"\n"},
     {"B",
      "title = \"B: P6 on Earth, contact friction\"\n[soil]\npreset = \"P6\"\nfriction_model = \"contact\"\n"
      "stiffness_n_m = 3000\n[gravity]\nbody = \"Earth\"\n"},
     {"C", "title = \"C: apollo-15-srp\"\n[soil]\nname = \"apollo-15-srp\"\n"},
     {"D",
      "title = \"D: B behind a virtual coupling\"\n[soil]\npreset = \"P6\"\nfriction_model = \"contact\"\n"
      "stiffness_n_m = 3000\n[gravity]\nbody = \"Earth\"\n[coupling]\nkind = \"virtual\"\n"}}};

/// Interpolates from 0 to 1 without a jump in velocity or acceleration.
double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10 - 15 * u + 6 * u * u);
}

Vec3 wantedPosition(const Script& script, Grip::Opens opens, double at_s) {
  // A hand that opens at the soil stops 1 mm above it.
  const double depth_mm = opens == Grip::Opens::kAtSoil ? -1 : script.depth_mm;
  const double down = smooth((at_s - script.wait_s) / script.press_s);
  const double z_mm = -script.surface_mm + script.above_mm - down * (script.above_mm + depth_mm);
  const double drawn_s = at_s - script.wait_s - script.press_s - script.settle_s;
  const double u = script.draw_s > 0 ? std::clamp(drawn_s / script.draw_s, 0.0, 1.0) : 0;
  const double side = std::sin(std::numbers::pi * smooth(u));
  return {1e-3 * script.draw_mm * side * side, 0, 1e-3 * z_mm};
}

Wanted wantedAt(const Script& script, Grip::Opens opens, double at_s) {
  constexpr double kHalf_s = 1e-5;
  return {
      wantedPosition(script, opens, at_s),
      0.5 / kHalf_s * (wantedPosition(script, opens, at_s + kHalf_s) - wantedPosition(script, opens, at_s - kHalf_s))};
}

/// Mean and SD for each window of the still hold.
struct Window {
  double from_s = 0, sum = 0, squares = 0, largest_n = 0, energy_mj = 0;
  long n = 0;

  [[nodiscard]] Json json() const {
    const double mean = n > 0 ? sum / static_cast<double>(n) : 0;
    const double variance = n > 0 ? squares / static_cast<double>(n) - mean * mean : 0;
    return {{"from_s", from_s},
            {"mean_up_n", mean},
            {"sd_n", std::sqrt(std::max(0.0, variance))},
            {"largest_n", largest_n},
            {"energy_mj", energy_mj}};
  }
};

enum class Attack { kJump, kTurn, kVelocity };
constexpr std::array<std::pair<Attack, const char*>, 3> kAttacks = {
    {{Attack::kJump, "5 cm off"}, {Attack::kTurn, "turned by 180 degrees"}, {Attack::kVelocity, "99 m/s, still pose"}}};

struct Glitch {
  const char* what = "";
  double at_s = 0, before_n = 0, largest_n = 0, largest_step_n_ms = 0, torque_nm = 0, energy_before_mj = 0,
         energy_mj = 0;
  double let_go_ms = -1;
  std::uint32_t sequence = 0;
  bool seen = false;  ///< whether this packet was answered

  [[nodiscard]] Json json() const {
    return {{"what", what},
            {"at_s", at_s},
            {"before_n", before_n},
            {"largest_n", largest_n},
            {"largest_step_n_ms", largest_step_n_ms},
            {"largest_torque_nm", torque_nm},
            {"energy_mj", energy_mj},
            {"let_go_ms", let_go_ms}};
  }
};

struct Stall {
  double stopped_ms = 0, before_n = 0, first_n = -1, largest_n = 0;

  [[nodiscard]] Json json() const {
    return {{"stopped_ms", stopped_ms}, {"before_n", before_n}, {"first_n", first_n}, {"largest_n", largest_n}};
  }
};

/// Hand, handle and device, and the answering program.
class Session {
 public:
  Session(const Settings& settings, std::uint16_t port, const Vec3& start_m, double end_s)
      : settings_(settings),
        grip_(findGrip(settings.grip)),
        handle_(settings.handle, start_m),
        device_(settings.device, settings.seed),
        random_(settings.seed ^ 0x9e3779b9U),
        link_(port),
        observer_(settings.bars, end_s),
        end_s_(end_s) {
    device_.follow(0, start_m);
  }

  void beginScript() { start_ns_ = done_ns_; }
  void playInStep(const InStep& in_step) { in_step_ = &in_step; }
  void playAgainst(const Program& program) { program_ = &program; }

  /// Advances to a time of the run, a multiple of 1 ms. All received answers must have been processed.
  void advance(std::int64_t to_ns) {
    while (done_ns_ < to_ns) {
      for (int i = 0; i < kSteps; ++i) {
        const double at_s = scriptTime(done_ns_ + kStep_ns / 2);
        const auto [hand, weight_n] = holder(at_s);
        if (!open_ && in_step_ == nullptr && isOpen(at_s)) {
          open_ = true;
          observer_.open(length(device_.shown(done_ns_)), handle_.ledger().device_j);
        }
        handle_.step(1e-9 * kStep_ns, device_.shown(done_ns_), hand, wanted(at_s), weight_n);
        done_ns_ += kStep_ns;
        device_.follow(done_ns_, handle_.position());
      }
      reading_ = device_.read(done_ns_);
      const double at_s = scriptTime(done_ns_);
      if (at_s <= end_s_) {
        observer_.handle(at_s, handle_.position(), handle_.ledger().device_j);
        if (in_step_ != nullptr && in_step_->follow) {
          in_step_->follow(at_s, handle_);
        }
      }
    }
  }

  void send() {
    DevicePacket packet;
    packet.sequence = sequence_++;
    packet.time = static_cast<std::uint64_t>(monotonicNs());
    packet.position_m = reading_.position_m;
    packet.velocity_m_s = reading_.velocity_m_s;
    disturb(packet);
    if (!device_.drops()) {
      link_.send(packet);
    }
  }

  /// Processes answers. Converts clock time to `at_ns` of the run; in lockstep all have the current time.
  template <class Time>
  void take(const Time& at_ns) {
    while (const auto arrival = link_.take()) {
      const Answer& answer = arrival->answer;
      if (device_.drops()) {
        continue;
      }
      const std::int64_t arrived_ns = at_ns(arrival->at_ns);
      const bool holds = answer.live && !answer.let_go;
      if (start_ns_ < 0 ? holds : !holds && restarts_ < kMostRestarts && waits(arrived_ns)) {
        // After a safety trip before the first contact, the hand waits for the next soft start.
        restarts_ += start_ns_ < 0 ? 0 : 1;
        start_ns_ = done_ns_;
      }
      device_.take(answer, arrived_ns);
      const double at_s = scriptTime(arrived_ns);
      if (at_s > end_s_) {
        continue;
      }
      observer_.answer(at_s, settings_.script.phase(at_s), answer);
      watch(at_s, answer);
      last_ = answer;
    }
  }
  [[nodiscard]] int restarts() const { return restarts_; }
  [[nodiscard]] bool waitForAnswer(int timeout_ms) { return link_.wait(timeout_ms); }

  [[nodiscard]] bool started() const { return start_ns_ >= 0; }
  [[nodiscard]] double time() const { return scriptTime(done_ns_); }
  [[nodiscard]] bool over() const { return time() > end_s_ || stallsDone() || glitchesDone(); }
  [[nodiscard]] const Observer& observer() const { return observer_; }
  [[nodiscard]] const Handle& handle() const { return handle_; }

  [[nodiscard]] Json lists() const {
    Json json;
    for (const Window& window : windows_) {
      json["windows"].push_back(window.json());
    }
    for (const Glitch& glitch : glitches_) {
      if (glitch.seen) {
        json["glitches"].push_back(glitch.json());
      }
    }
    for (const Stall& stall : stalls_) {
      if (stall.first_n >= 0) {
        json["stalls"].push_back(stall.json());
      }
    }
    return json;
  }

  /// Stops the program at random times, and continues it.
  void stall() {
    const double at_s = time();
    if (settings_.task != Task::kStalls || settings_.script.phase(at_s) != Phase::kStill) {
      return;
    }
    if (resume_s_ >= 0 && at_s >= resume_s_) {
      resume_s_ = -1;
      resumed_s_ = at_s;
      program_->signal(SIGCONT);
    } else if (resume_s_ < 0 && at_s > resumed_s_ + kStallsApart_s && length(last_.force_n) > kPressed_n &&
               !stallsDone()) {
      // Uniform on a logarithmic scale, so that short and long stalls are equally common.
      constexpr double kShortest_ms = 5, kLongest_ms = 500;
      const double u = std::uniform_real_distribution<double>(0, 1)(random_);
      Stall stall;
      stall.stopped_ms = std::round(kShortest_ms * std::pow(kLongest_ms / kShortest_ms, u));
      stall.before_n = length(last_.force_n);
      stalls_.push_back(stall);
      resume_s_ = at_s + 1e-3 * stall.stopped_ms;
      program_->signal(SIGSTOP);
    }
  }

 private:
  static constexpr double kAfterGlitch_s = 0.05, kGlitchesApart_s = 0.5, kForceIsBack_s = 3.5, kAfterStall_s = 0.15,
                          kStallsApart_s = 1.6, kPressed_n = 0.5;
  static constexpr int kMostRestarts = 30;

  [[nodiscard]] bool waits(std::int64_t at_ns) const {
    return in_step_ == nullptr && settings_.script.phase(scriptTime(at_ns)) == Phase::kWait;
  }

  [[nodiscard]] double scriptTime(std::int64_t at_ns) const {
    return start_ns_ < 0 ? -1 : 1e-9 * static_cast<double>(at_ns - start_ns_);
  }

  [[nodiscard]] Wanted wanted(double at_s) const {
    return in_step_ != nullptr ? in_step_->wanted(at_s) : wantedAt(settings_.script, grip_.opens, at_s);
  }

  [[nodiscard]] bool isOpen(double at_s) const {
    const Phase phase = settings_.script.phase(at_s);
    return (grip_.opens == Grip::Opens::kAtSoil && phase >= Phase::kSettle) ||
           (grip_.opens == Grip::Opens::kWhenStill && phase >= Phase::kStill);
  }

  [[nodiscard]] std::pair<Hand, double> holder(double at_s) const {
    if (in_step_ != nullptr) {
      return {in_step_->hand, in_step_->weight_n};
    }
    const bool open = isOpen(at_s);
    const double weight_n = settings_.handle_weight_n + (open ? settings_.weight_n : 0);
    return {open ? Hand{} : grip_.hand, weight_n};
  }

  /// Makes single packets implausible at random times, in undisturbed operation.
  void disturb(DevicePacket& packet) {
    const double at_s = time();
    const std::vector<double>& releases_s = observer_.releases();
    if (settings_.task != Task::kGlitches || settings_.script.phase(at_s) != Phase::kStill ||
        length(last_.force_n) < kPressed_n || observer_.isReleased() ||
        (!releases_s.empty() && at_s < releases_s.back() + kForceIsBack_s)) {
      return;
    }
    if (!glitches_.empty()) {
      if (at_s < glitches_.back().at_s + kGlitchesApart_s) {
        return;
      }
      if (!glitches_.back().seen) {  // the next packet arrived in the same tick; repeat
        glitches_.pop_back();
      }
    }
    if (glitches_.size() >= static_cast<std::size_t>(settings_.count)) {
      return;
    }
    const auto [attack, what] = kAttacks[glitches_.size() % kAttacks.size()];
    Glitch glitch;
    glitch.what = what;
    glitch.sequence = packet.sequence;
    glitch.at_s = at_s;
    glitch.before_n = length(last_.force_n);
    glitch.energy_before_mj = 1e3 * handle_.ledger().device_j;
    glitches_.push_back(glitch);
    switch (attack) {
      case Attack::kJump: packet.position_m.z -= 0.05; break;
      case Attack::kTurn: packet.orientation_wxyz = {0, 1, 0, 0}; break;
      case Attack::kVelocity: packet.velocity_m_s.z = -99; break;
    }
  }

  void watch(double at_s, const Answer& answer) {
    const double force_n = length(answer.force_n);
    if (!glitches_.empty() && at_s >= glitches_.back().at_s && at_s <= glitches_.back().at_s + kAfterGlitch_s) {
      Glitch& glitch = glitches_.back();
      glitch.seen = glitch.seen || answer.sequence == glitch.sequence;
      glitch.largest_n = std::max(glitch.largest_n, force_n);
      glitch.torque_nm = std::max(glitch.torque_nm, length(answer.torque_nm));
      if (answer.number == last_.number + 1 && force_n > 0) {
        glitch.largest_step_n_ms = std::max(glitch.largest_step_n_ms, length(answer.force_n - last_.force_n));
      }
      glitch.energy_mj = std::max(glitch.energy_mj, 1e3 * handle_.ledger().device_j - glitch.energy_before_mj);
      if (observer_.isReleased() && glitch.let_go_ms < 0) {
        glitch.let_go_ms = 1e3 * (at_s - glitch.at_s);
      }
    }
    // While the program is stopped, earlier answers may still arrive.
    if (!stalls_.empty() && resume_s_ < 0 && at_s >= resumed_s_ && at_s <= resumed_s_ + kAfterStall_s) {
      Stall& stall = stalls_.back();
      stall.first_n = stall.first_n < 0 ? force_n : stall.first_n;
      stall.largest_n = std::max(stall.largest_n, force_n);
    }
    if (settings_.windows_s > 0 && settings_.script.phase(at_s) == Phase::kStill) {
      const double still_from_s = settings_.script.end() - settings_.script.still_s;
      const auto index = static_cast<std::size_t>((at_s - still_from_s) / settings_.windows_s);
      if (windows_.size() <= index) {
        windows_.emplace_back().from_s = static_cast<double>(index) * settings_.windows_s;
      }
      Window& window = windows_.back();
      window.sum += answer.force_n.z;
      window.squares += answer.force_n.z * answer.force_n.z;
      window.largest_n = std::max(window.largest_n, force_n);
      window.energy_mj = 1e3 * handle_.ledger().device_j;
      ++window.n;
    }
  }

  [[nodiscard]] bool glitchesDone() const {
    return settings_.task == Task::kGlitches && static_cast<int>(glitches_.size()) >= settings_.count &&
           glitches_.back().seen && time() > glitches_.back().at_s + 1;
  }
  [[nodiscard]] bool stallsDone() const {
    return settings_.task == Task::kStalls && static_cast<int>(stalls_.size()) >= settings_.count && resume_s_ < 0 &&
           time() > resumed_s_ + 2 * kAfterStall_s;
  }

  const Settings& settings_;
  const Grip& grip_;
  const InStep* in_step_ = nullptr;
  const Program* program_ = nullptr;
  Handle handle_;
  Device device_;
  std::mt19937 random_;
  Link link_;
  Observer observer_;
  double end_s_;
  std::int64_t done_ns_ = 0, start_ns_ = -1;
  bool open_ = false;  ///< whether the handle is released
  int restarts_ = 0;
  Reading reading_;
  Answer last_;
  std::uint32_t sequence_ = 0;
  std::vector<Window> windows_;
  std::vector<Glitch> glitches_;
  std::vector<Stall> stalls_;
  double resume_s_ = -1, resumed_s_ = 0;
};

/// Lateness of this program.
struct Punctuality {
  double latest_ms = 0;
  long ticks = 0, late = 0, skipped = 0;
};

void becomeRealTime() {
  (void)mlockall(MCL_CURRENT | MCL_FUTURE);
  // Below the loop's priority (80), so that this program does not delay haptolith.
  const sched_param parameters{.sched_priority = 70};
  if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) != 0) {
    prctl(PR_SET_TIMERSLACK, 1);
  }
}

void sleepUntil(std::int64_t at_ns) {
  const timespec time{.tv_sec = at_ns / 1'000'000'000, .tv_nsec = at_ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

std::string readAll(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string replaced(std::string text, const std::string& what, double by) {
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "%g", by);
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at)) {
    text.replace(at, what.size(), number.data());
  }
  return text;
}

/// Splits text into lines: at ';', and after a table's name in brackets.
std::string linesOf(const std::string& extra, const DeviceParameters& device) {
  std::string text;
  bool at_start = true, in_name = false;
  for (const char c : extra) {
    in_name = in_name || (at_start && c == '[');
    at_start = c == ';' || c == '\n' || (at_start && c == ' ');
    text += c == ';' ? '\n' : c;
    if (in_name && c == ']') {
      text += '\n';
      in_name = false;
      at_start = true;
    }
  }
  text = replaced(text, "{delay_ms}", device.delay_ms);
  text = replaced(text, "{step_mm}", device.step_mm);
  return replaced(text, "{noise_mm}", device.noise_mm) + '\n';
}

/// Returns the line with an error, or else the last line.
std::string whatItSaid(const std::string& log) {
  std::istringstream lines(log);
  std::string line, last = "(it said nothing)";
  while (std::getline(lines, line)) {
    if (line.find("error:") != std::string::npos) {
      return line;
    }
    last = line.empty() ? last : line;
  }
  return last;
}

const char* text(DelayAt at) {
  return at == DelayAt::kSplit ? "split" : at == DelayAt::kShow ? "show" : "measure";
}

Json rowOf(const Settings& s, const Session& session, const Punctuality& punctuality, std::optional<int> early_end,
           int exit_status) {
  const Measures m = session.observer().measures();
  Bars bars = s.bars;
  bars.still_mm += s.device.step_mm + 2 * s.device.noise_mm;  // rest at the resolution of this device
  const Verdict verdict = judge(m, session.observer().releases(), bars);
  return {{"name", s.name},
          {"soil", s.soil},
          {"grip", s.grip},
          {"delay_ms", s.device.delay_ms},
          {"delay_at", text(s.device.delay_at)},
          {"step_mm", s.device.step_mm},
          {"noise_mm", s.device.noise_mm},
          {"mass_kg", s.handle.mass_kg},
          {"damping_n_s_m", s.handle.damping_n_s_m},
          {"jitter_ms", s.device.jitter_ms},
          {"drop", s.device.drop},
          {"seed", s.seed},
          {"verdict", early_end ? "ENDED" : text(verdict)},
          {"largest_force_n", m.largest_force_n},
          {"largest_step_n_ms", m.largest_step_n_ms},
          {"largest_torque_nm", m.largest_torque_nm},
          {"energy_max_mj", m.energy_max_mj},
          {"energy_end_mj", m.energy_end_mj},
          {"energy_rise_mj", m.energy_rise_mj},
          {"opened_n", m.opened_n},
          {"opened_mj", m.opened_mj},
          {"first_excess_s", m.first_excess_s},
          {"vibration_mm", m.vibration_mm},
          {"vibration_hz", m.vibration_hz},
          {"vibration_before_mm", m.vibration_before_mm},
          {"vibration_after_mm", m.vibration_after_mm},
          {"first_let_go_s", m.first_let_go_s},
          {"let_go_share", m.let_go_share},
          {"press_n", m.press_n},
          {"draw_n", m.draw_n},
          {"still_n", m.still_n},
          {"press_up_n", m.press_up_n},
          {"still_up_n", m.still_up_n},
          {"still_sd_n", m.still_sd_n},
          {"answers", m.answers},
          {"lost", m.lost},
          {"longest_gap_ms", m.longest_gap_ms},
          {"late_max_ms", punctuality.latest_ms},
          {"late_share", punctuality.ticks > 0 ? static_cast<double>(punctuality.late) / punctuality.ticks : 0},
          {"skipped_ticks", punctuality.skipped},
          {"restarts", session.restarts()},
          {"exit_status", exit_status}};
}

}  // namespace

const Grip& findGrip(const std::string& name) {
  for (const Grip& grip : kGrips) {
    if (name == grip.name) {
      return grip;
    }
  }
  throw std::runtime_error("grip '" + name + "' is not known; there are " + gripNames());
}

std::string gripNames() {
  std::string names;
  for (const Grip& grip : kGrips) {
    names += (names.empty() ? "" : ", ") + std::string(grip.name);
  }
  return names;
}

std::string sceneOf(const std::string& soil) {
  for (const auto& [name, scene] : kScenes) {
    if (soil == name) {
      return scene;
    }
  }
  return {};
}

Phase Script::phase(double at_s) const {
  double until_s = wait_s;
  if (at_s < until_s) {
    return Phase::kWait;
  }
  if (at_s < (until_s += press_s)) {
    return Phase::kPress;
  }
  if (at_s < (until_s += settle_s)) {
    return Phase::kSettle;
  }
  if (at_s < (until_s += draw_s)) {
    return Phase::kDraw;
  }
  return at_s <= until_s + still_s ? Phase::kStill : Phase::kOver;
}

Json judgeProgram(const Settings& settings) {
  const std::string scene_file = settings.folder + "/scene.toml", log = settings.folder + "/output.txt";
  std::string scene = sceneOf(settings.soil);
  if (scene.empty() && (scene = readAll(settings.soil)).empty()) {
    throw std::runtime_error("soil '" + settings.soil + "' is neither A, B, C or D nor a scene file");
  }
  std::ofstream(scene_file) << scene << linesOf(settings.extra_toml, settings.device);
  const std::uint16_t port = freePort();
  std::vector<std::string> command = {settings.program,
                                      "run",
                                      scene_file,
                                      "--device",
                                      "network",
                                      "--device-address",
                                      "127.0.0.1:" + std::to_string(port),
                                      "--no-serve"};
  if (!settings.record.empty()) {
    command.insert(command.end(), {"--record", settings.record});
  }
  Program program(command, settings.folder, log);
  becomeRealTime();

  const Vec3 start_m = wantedPosition(settings.script, findGrip(settings.grip).opens, 0);
  Session session(settings, port, start_m, settings.script.end());
  session.playAgainst(program);
  const std::int64_t base_ns = monotonicNs();
  const auto of_run = [base_ns](std::int64_t at_ns) { return at_ns - base_ns; };
  constexpr std::int64_t kMostWait_ns = 120'000'000'000, kMostEnd_ns = 5'000'000'000;
  Punctuality punctuality;
  std::optional<int> ended;
  std::int64_t tick = 0, over_ns = -1;
  while (true) {
    ++tick;
    sleepUntil(base_ns + tick * kTick_ns);
    const std::int64_t late_ns = monotonicNs() - base_ns - tick * kTick_ns;
    const std::int64_t skipped = late_ns / kTick_ns;
    tick += skipped;
    if (session.time() >= settings.script.wait_s && over_ns < 0) {
      punctuality.latest_ms = std::max(punctuality.latest_ms, 1e-6 * static_cast<double>(late_ns));
      ++punctuality.ticks;
      punctuality.late += skipped > 0 ? 1 : 0;
      punctuality.skipped += skipped;
    }
    session.take(of_run);
    session.advance(tick * kTick_ns);
    session.stall();
    session.send();
    if ((ended = program.ended())) {
      break;
    }
    if (!session.started() && tick * kTick_ns > kMostWait_ns) {
      throw std::runtime_error("the program has not taken the hand within two minutes: " + whatItSaid(readAll(log)));
    }
    if (session.over() && over_ns < 0) {
      over_ns = tick * kTick_ns;
      program.signal(SIGINT);
    }
    if (over_ns >= 0 && tick * kTick_ns > over_ns + kMostEnd_ns) {
      program.signal(SIGKILL);
    }
  }
  if (!session.started()) {
    throw std::runtime_error("the program ended with status " + std::to_string(*ended) + ": " +
                             whatItSaid(readAll(log)));
  }
  const std::optional<int> early_end = over_ns < 0 ? ended : std::nullopt;
  Json result = session.lists();
  result["row"] = rowOf(settings, session, punctuality, early_end, *ended);
  if (*ended != 0) {
    result["said"] = whatItSaid(readAll(log));
  }
  return result;
}

Measures judgeInStep(const Settings& settings, const InStep& in_step) {
  Session session(settings, in_step.port, in_step.start_m, in_step.seconds);
  session.playInStep(in_step);
  session.beginScript();
  for (std::int64_t tick = 1; session.time() < in_step.seconds; ++tick) {
    session.advance(tick * kTick_ns);
    session.send();
    if (!session.waitForAnswer(10'000)) {
      throw std::runtime_error("the stand-in does not answer");
    }
    session.take([tick](std::int64_t) { return tick * kTick_ns; });
  }
  return session.observer().measures();
}

}  // namespace hand_in_the_loop

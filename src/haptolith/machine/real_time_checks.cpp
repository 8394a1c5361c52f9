#include "haptolith/machine/real_time_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace haptolith {

namespace {

namespace fs = std::filesystem;

constexpr const char* kNotTold = "not reported by this system";
constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

/// Less than this share of a second, and a loop that computes a lot is stopped by the kernel for the rest of it.
constexpr double kEnoughRealTimeShare = 0.9;

/// `haptolith run` maps 100 MiB with the scene icra2021, and a bed of 100 000 particles some more.
constexpr std::uint64_t kEnoughMemory_bytes = std::uint64_t{256} << 20;

/// A CPU that needs longer than this to come out of its sleep spends a tenth of a tick on that.
constexpr double kLongIdleExit_us = 100;

constexpr const char* kContainerRemedy =
    "start the container with --cap-add SYS_NICE --ulimit rtprio=80 --ulimit memlock=-1 (docker, podman)";

/// The kernel's small files.
class MachineFiles {
 public:
  explicit MachineFiles(fs::path root) : root_(std::move(root)) {}

  /// Without white space at its ends; nothing when it is not there, not readable or empty.
  [[nodiscard]] std::optional<std::string> text(const fs::path& name) const {
    constexpr std::size_t kLongest = 1 << 16;
    std::ifstream file(root_ / name);
    std::string text(kLongest, '\0');
    file.read(text.data(), kLongest);
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
    const auto first = text.find_first_not_of(" \t\n");
    return first == std::string::npos ? std::nullopt
                                      : std::optional(text.substr(first, text.find_last_not_of(" \t\n") + 1 - first));
  }

  [[nodiscard]] std::optional<std::int64_t> number(const fs::path& name) const {
    const std::optional<std::string> digits = text(name);
    std::int64_t value = 0;
    if (!digits) {
      return std::nullopt;
    }
    const auto [end, error] = std::from_chars(digits->data(), digits->data() + digits->size(), value);
    return error == std::errc{} && end == digits->data() + digits->size() ? std::optional(value) : std::nullopt;
  }

  [[nodiscard]] bool has(const fs::path& name) const {
    std::error_code unreadable;
    return fs::exists(root_ / name, unreadable);
  }

  /// Value after "name:" or "name  " in a file of such lines.
  [[nodiscard]] std::string field(const fs::path& name, std::string_view label) const {
    const std::string lines = fmt::format("\n{}\n", text(name).value_or(""));
    const std::size_t at = lines.find(fmt::format("\n{}", label));
    if (at == std::string::npos) {
      return {};
    }
    const std::size_t from = lines.find_first_not_of(": \t", at + 1 + label.size());
    return lines.substr(from, lines.find('\n', from) - from);
  }

 private:
  fs::path root_;
};

/// The numbers of a list such as "0-3,6"; empty when the text is no such list.
std::vector<int> cpuList(std::string_view text) {
  constexpr int kMostCpus = 1 << 13;  // more than any machine has: a malformed list must not exhaust memory
  std::vector<int> cpus;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    int first = 0;
    auto [rest, error] = std::from_chars(at, end, first);
    int last = first;
    if (error == std::errc{} && rest != end && *rest == '-') {
      const auto upper = std::from_chars(rest + 1, end, last);
      rest = upper.ptr;
      error = upper.ec;
    }
    if (error != std::errc{} || first < 0 || last < first || last >= kMostCpus || (rest != end && *rest != ',')) {
      return {};
    }
    for (int cpu = first; cpu <= last; ++cpu) {
      cpus.push_back(cpu);
    }
    at = rest == end ? end : rest + 1;
  }
  return cpus;
}

std::vector<int> cpuListOf(const MachineFiles& files, const fs::path& name) {
  return cpuList(files.text(name).value_or(""));
}

/// The soft limit in a line of /proc/self/limits; empty when it is not reported.
std::optional<std::uint64_t> limitOf(const MachineFiles& files, std::string_view label) {
  const std::string line = files.field("proc/self/limits", label);
  if (line.starts_with("unlimited")) {
    return kUnlimited;
  }
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  return error == std::errc{} ? std::optional(value) : std::nullopt;
}

struct Unit {
  std::uint64_t size;
  const char* name;
};
constexpr Unit kOne{1, ""};
constexpr Unit kMiB{1 << 20, " MiB"};

/// A right of a process to which a limit does not apply, and its bit (capabilities(7)).
struct Capability {
  int bit;
  const char* name;
};
constexpr Capability kSysNice{23, "CAP_SYS_NICE"};
constexpr Capability kIpcLock{14, "CAP_IPC_LOCK"};

bool holds(const MachineFiles& files, const Capability& capability) {
  const std::string bits = files.field("proc/self/status", "CapEff:");
  std::uint64_t held = 0;
  std::from_chars(bits.data(), bits.data() + bits.size(), held, 16);
  return (held >> capability.bit & 1) != 0;
}

/// A limit in words, and whether this process is above it.
std::string limitText(const MachineFiles& files, std::optional<std::uint64_t> limit, const Unit& unit,
                      const Capability& above) {
  const std::string told = !limit                 ? kNotTold
                           : *limit == kUnlimited ? "unlimited"
                                                  : fmt::format("{}{}", *limit / unit.size, unit.name);
  return fmt::format("limit of this user {}{}", told,
                     holds(files, above) ? fmt::format(", overridden by {}", above.name) : "");
}

/// The kind of container that this process is in; empty when none is known.
std::string containerOf(const MachineFiles& files) {
  if (files.has(".dockerenv")) {
    return "docker";
  }
  if (files.has("run/.containerenv")) {
    return "podman";
  }
  return files.text("run/systemd/container").value_or("");
}

std::string_view remedyIn(const std::string& container, std::string_view at_home) {
  return container.empty() ? at_home : kContainerRemedy;
}

/// Remedies that concern the kernel do not work inside a container.
std::string onHost(const std::string& container, std::string_view remedy) {
  return fmt::format("{}{}", container.empty() ? "" : "on the container's host: ", remedy);
}

Check kernelCheck(const MachineFiles& files, const std::string& container) {
  Check check{.name = "kernel",
              .found = files.text("proc/sys/kernel/osrelease").value_or("Linux"),
              .needed = "PREEMPT_RT, or wake-ups in time without it"};
  const std::string version = files.text("proc/version").value_or("");
  if (files.number("sys/kernel/realtime") == 1 || version.find("PREEMPT_RT") != std::string::npos) {
    check.found += ", PREEMPT_RT";
    return check;
  }
  // "none voluntary (full) lazy": only root may read it.
  const std::string modes = files.text("sys/kernel/debug/sched/preempt").value_or("");
  const std::size_t open = modes.find('(');
  const std::size_t close = modes.find(')', open);
  std::string mode = kNotTold;
  if (close != std::string::npos) {
    mode = modes.substr(open + 1, close - open - 1);
  } else if (version.find("PREEMPT_DYNAMIC") != std::string::npos) {
    mode = "chosen at boot";
  } else if (version.find("PREEMPT") != std::string::npos) {
    mode = "full";
  }
  check.found += fmt::format(", without PREEMPT_RT; preemption {}", mode);
  check.verdict = Fitness::kImprovable;
  check.remedy =
      onHost(container, R"-(sudo apt-get install "linux-image-rt-$(dpkg --print-architecture)", then boot it)-");
  return check;
}

Check schedulerCheck(const MachineFiles& files, const RealTime& granted, const std::string& container) {
  const std::optional<std::uint64_t> limit = limitOf(files, "Max realtime priority");
  const bool has = granted.scheduler == "SCHED_FIFO";
  Check check{.name = "scheduler",
              .verdict = has ? Fitness::kOk : Fitness::kInsufficient,
              .found = fmt::format("SCHED_FIFO at priority {} {}; {}", kRealTimePriority, has ? "granted" : "refused",
                                   limitText(files, limit, kOne, kSysNice)),
              .needed = fmt::format("SCHED_FIFO at priority {}", kRealTimePriority)};
  if (!has) {
    // With the limit at 80 only the control group can be in the way: it has no real-time budget.
    check.remedy = limit && *limit >= kRealTimePriority && container.empty()
                       ? "echo 950000 | sudo tee /sys/fs/cgroup/cpu$(sed -n 's/.*cpu[^:]*://p' "
                         "/proc/self/cgroup)/cpu.rt_runtime_us"
                       : remedyIn(container, kPriorityRemedy);
  }
  return check;
}

Check realTimeShareCheck(const MachineFiles& files) {
  const auto runtime_us = files.number("proc/sys/kernel/sched_rt_runtime_us");
  const auto period_us = files.number("proc/sys/kernel/sched_rt_period_us");
  Check check{.name = "real-time share",
              .found = kNotTold,
              .needed = fmt::format("{:.0f} % of a CPU or more", 100 * kEnoughRealTimeShare)};
  if (!runtime_us || (*runtime_us >= 0 && period_us.value_or(0) <= 0)) {
    return check;
  }
  const double share = *runtime_us < 0 ? 1 : static_cast<double>(*runtime_us) / static_cast<double>(*period_us);
  check.found =
      *runtime_us < 0 ? "not limited" : fmt::format("real-time threads may use {:.0f} % of a CPU", 100 * share);
  if (share < kEnoughRealTimeShare) {
    check.verdict = share > 0 ? Fitness::kImprovable : Fitness::kInsufficient;
    check.remedy = fmt::format("sudo sysctl kernel.sched_rt_runtime_us={:.0f}", 0.95 * static_cast<double>(*period_us));
  }
  return check;
}

Check memoryCheck(const MachineFiles& files, const RealTime& granted, const std::string& container) {
  const std::optional<std::uint64_t> limit = limitOf(files, "Max locked memory");
  Check check{.name = "memory lock",
              .found = fmt::format("{}; {}", granted.memory_locked ? "granted" : "refused",
                                   limitText(files, limit, kMiB, kIpcLock)),
              .needed = fmt::format("unlimited, or {} MiB for a small scene", kEnoughMemory_bytes / kMiB.size)};
  if (!granted.memory_locked) {
    check.verdict = Fitness::kInsufficient;
  } else if (!holds(files, kIpcLock) && limit && *limit < kEnoughMemory_bytes) {
    check.verdict = Fitness::kImprovable;  // enough for this small process, not for the loop
  }
  if (check.verdict != Fitness::kOk) {
    check.remedy = remedyIn(container, kMemoryRemedy);
  }
  return check;
}

Check cpuCheck(const MachineFiles& files, std::vector<int> usable) {
  const std::vector<int> online = cpuListOf(files, "sys/devices/system/cpu/online");
  for (const int cpu : cpuListOf(files, "sys/devices/system/cpu/isolated")) {  // there for who asks for them
    if (std::find(usable.begin(), usable.end(), cpu) == usable.end()) {
      usable.push_back(cpu);
    }
  }
  Check check{.name = kCpuCheck, .found = kNotTold, .needed = "2 or more: one for the loop, one for all else"};
  if (usable.empty()) {
    return check;
  }
  check.found = fmt::format("{} for this process", usable.size());
  if (online.size() > usable.size()) {
    check.found += fmt::format(" of {} that are online", online.size());
  }
  if (usable.size() < 2) {
    check.verdict = Fitness::kImprovable;
    check.remedy = online.size() < 2 ? "a machine with more CPUs"
                                     : "start it without taskset, or in a container without --cpuset-cpus";
  }
  return check;
}

Check isolationCheck(const MachineFiles& files, const std::vector<int>& usable, int cpu) {
  const std::string isolated = files.text("sys/devices/system/cpu/isolated").value_or("");
  const std::string tickless = files.text("sys/devices/system/cpu/nohz_full").value_or("");
  const std::vector<int> kept = cpuList(isolated);
  Check check{.name = "isolated CPUs", .needed = "one for the loop alone, with --cpu; or wake-ups in time without it"};
  if (kept.empty()) {
    const int last = cpu != kAnyCpu ? cpu : usable.empty() ? 1 : usable.back();
    check.verdict = Fitness::kImprovable;
    check.found = "none";
    check.remedy = usable.size() == 1
                       ? ""
                       : fmt::format(
                             "echo 'GRUB_CMDLINE_LINUX=\"$GRUB_CMDLINE_LINUX isolcpus={0} nohz_full={0}\"' | sudo tee "
                             "/etc/default/grub.d/haptolith.cfg && sudo update-grub, restart, haptolith run --cpu {0}",
                             last);
    return check;
  }
  const bool no_ticks = !cpuList(tickless).empty();  // "(null)" when there are none
  check.found = fmt::format("isolcpus={}{}", isolated, no_ticks ? fmt::format(" nohz_full={}", tickless) : "");
  if (std::find(kept.begin(), kept.end(), cpu) == kept.end()) {
    check.verdict = Fitness::kImprovable;
    check.found += cpu == kAnyCpu ? ", not used: no --cpu" : fmt::format(", not CPU {}", cpu);
    check.remedy = fmt::format("haptolith run --cpu {}", kept.front());
  }
  return check;
}

/// The CPUs that the loop may come to run on.
std::vector<int> loopCpus(const std::vector<int>& usable, int cpu) {
  return cpu == kAnyCpu ? usable : std::vector<int>{cpu};
}

Check governorCheck(const MachineFiles& files, const std::vector<int>& cpus) {
  Check check{
      .name = "CPU governor", .found = kNotTold, .needed = "performance: else the clock drops between two ticks"};
  for (const int cpu : cpus) {
    const auto governor = files.text(fmt::format("sys/devices/system/cpu/cpu{}/cpufreq/scaling_governor", cpu));
    if (!governor) {
      continue;  // as in most virtual machines: the host decides
    }
    check.found = *governor;
    if (*governor != "performance") {
      check.verdict = Fitness::kImprovable;
      check.found += fmt::format(" on CPU {}", cpu);
      check.remedy = "sudo cpupower frequency-set -g performance (from linux-cpupower)";
      return check;
    }
  }
  return check;
}

/// A thread that sleeps lets its CPU sleep, too, and the deeper the longer it takes to wake.
Check idleCheck(const MachineFiles& files, const std::vector<int>& cpus) {
  std::optional<std::int64_t> slowest_us;
  std::string slowest;
  for (const int cpu : cpus) {
    for (int state = 0;; ++state) {
      const fs::path folder = fmt::format("sys/devices/system/cpu/cpu{}/cpuidle/state{}", cpu, state);
      const auto exit_us = files.number(folder / "latency");
      if (!exit_us) {
        break;
      }
      if (files.number(folder / "disable").value_or(0) == 0 && *exit_us > slowest_us.value_or(-1)) {
        slowest_us = *exit_us;
        slowest = files.text(folder / "name").value_or("the deepest");
      }
    }
  }
  Check check{.name = "idle states",
              .found = kNotTold,
              .needed = fmt::format("at most {:g} us to wake a CPU", kLongIdleExit_us)};
  if (slowest_us) {
    check.found = fmt::format("{} takes {} us to wake from", slowest, *slowest_us);
    if (static_cast<double>(*slowest_us) > kLongIdleExit_us) {
      check.verdict = Fitness::kImprovable;
      check.remedy =
          fmt::format("sudo cpupower idle-set --disable-by-latency {:.0f} (from linux-cpupower)", kLongIdleExit_us);
    }
  }
  return check;
}

Check machineCheck(const MachineFiles& files, const std::string& container) {
  const std::string flags = files.field("proc/cpuinfo", "flags");
  const bool is_virtual = fmt::format(" {} ", flags).find(" hypervisor ") != std::string::npos;
  Check check{.name = "machine",
              .verdict = is_virtual ? Fitness::kImprovable : Fitness::kOk,
              .found = is_virtual ? "virtual" : "no sign of a virtual one",
              .needed = "a real one: the host of a virtual one may take its CPUs away"};
  if (const auto vendor = files.text("sys/class/dmi/id/sys_vendor")) {
    check.found += fmt::format(" ({} {})", *vendor, files.text("sys/class/dmi/id/product_name").value_or(""));
  }
  if (!container.empty()) {
    check.found += fmt::format(", in a container ({})", container);
  }
  if (is_virtual) {
    check.remedy = "run it on the host, or have the host keep CPUs for this machine alone (virsh vcpupin)";
  }
  return check;
}

Check wakeUpCheck(const WakeUps& measured) {
  const Histogram& late_us = measured.late_us;
  Check check{
      .name = kWakeUpCheck,
      .needed = fmt::format("99.9 % within {:g} us, so that {:g} us of a tick are left for its work; none a tick late",
                            kLatestWakeUp_us, 1000 - kLatestWakeUp_us)};
  if (late_us.count() == 0) {
    check.verdict = Fitness::kImprovable;
    check.found = "not measured: interrupted";
    check.remedy = "haptolith doctor";
    return check;
  }
  const double p999_us = late_us.percentile(0.999);
  check.found = fmt::format("99.9 % within {:.0f} us; {} of {} a tick late", p999_us, measured.missed, late_us.count());
  if (p999_us > kLatestWakeUp_us) {
    check.verdict = Fitness::kInsufficient;
  } else if (measured.missed > 0) {
    check.verdict = Fitness::kImprovable;
  }
  if (check.verdict != Fitness::kOk) {
    check.remedy = "fix the points above, end other programs, and run this check again";
  }
  return check;
}

}  // namespace

std::vector<Check> realTimeChecks(const WakeUps& measured, const fs::path& root) {
  const MachineFiles files(root);
  const RealTime& granted = measured.real_time;
  const std::string container = containerOf(files);
  const std::vector<int> usable = cpuList(files.field("proc/self/status", "Cpus_allowed_list"));
  const std::vector<int> loop_cpus = loopCpus(usable, granted.cpu);
  return {kernelCheck(files, container),   schedulerCheck(files, granted, container),
          realTimeShareCheck(files),       memoryCheck(files, granted, container),
          cpuCheck(files, usable),         isolationCheck(files, usable, granted.cpu),
          governorCheck(files, loop_cpus), idleCheck(files, loop_cpus),
          machineCheck(files, container),  wakeUpCheck(measured)};
}

}  // namespace haptolith

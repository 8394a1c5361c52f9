#include "haptolith/machine/real_time_checks.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace haptolith {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
namespace fs = std::filesystem;

/// A machine made up of files.
class Machine : public testing::Test {
 protected:
  Machine() : root_(fs::path(testing::TempDir()) / fmt::format("haptolith_machine_{}", getpid())) {
    fs::remove_all(root_);
    fs::create_directories(root_);
    measured_.real_time = {.scheduler = "SCHED_FIFO", .memory_locked = true};
    for (int i = 0; i < 10'000; ++i) {
      measured_.late_us.add(5);
    }
  }
  ~Machine() override { fs::remove_all(root_); }

  void put(const std::string& name, const std::string& text) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text << '\n';
  }

  void putLimits(const std::string& priority, const std::string& memory) const {
    put("proc/self/limits",
        fmt::format("Limit                     Soft Limit           Hard Limit           Units     \n"
                    "Max locked memory         {0:<20} {0:<20} bytes     \n"
                    "Max realtime priority     {1:<20} {1:<20} \n"
                    "Max realtime timeout      unlimited            unlimited            us",
                    memory, priority));
  }

  void putProcess(const std::string& cpus, const std::string& capabilities) const {
    put("proc/self/status",
        fmt::format("Name:\thaptolith\nCapEff:\t{}\nCpus_allowed:\tf\nCpus_allowed_list:\t{}\nMems_allowed:\t1",
                    capabilities, cpus));
  }

  /// A machine on which all is as it should be.
  void putGoodMachine() {
    put("proc/sys/kernel/osrelease", "6.1.0-18-rt-amd64");
    put("proc/version", "Linux version 6.1.0-18-rt-amd64 (gcc 12) #1 SMP PREEMPT_RT Debian 6.1.76-1");
    put("sys/kernel/realtime", "1");
    putLimits("80", "unlimited");
    putProcess("0-3", "0000000000000000");
    put("proc/sys/kernel/sched_rt_runtime_us", "950000");
    put("proc/sys/kernel/sched_rt_period_us", "1000000");
    put("sys/devices/system/cpu/online", "0-3");
    put("sys/devices/system/cpu/isolated", "3");
    put("sys/devices/system/cpu/nohz_full", "3");
    for (int cpu = 0; cpu < 4; ++cpu) {
      const std::string folder = fmt::format("sys/devices/system/cpu/cpu{}/", cpu);
      put(folder + "cpufreq/scaling_governor", "performance");
      put(folder + "cpuidle/state0/name", "POLL");
      put(folder + "cpuidle/state0/latency", "0");
      put(folder + "cpuidle/state1/name", "C1");
      put(folder + "cpuidle/state1/latency", "2");
      put(folder + "cpuidle/state1/disable", "0");
    }
    put("proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu vme avx2\n");
    put("sys/class/dmi/id/sys_vendor", "LENOVO");
    put("sys/class/dmi/id/product_name", "30E1");
    measured_.real_time.cpu = 3;
  }

  [[nodiscard]] std::vector<Check> checks() const { return realTimeChecks(measured_, root_); }

  [[nodiscard]] Check check(std::string_view name) const {
    for (const Check& check : checks()) {
      if (check.name == name) {
        return check;
      }
    }
    ADD_FAILURE() << "no check of " << name;
    return {};
  }

  fs::path root_;
  WakeUps measured_;
};

TEST_F(Machine, AGoodOneHasNothingToMend) {
  putGoodMachine();
  for (const Check& check : checks()) {
    EXPECT_EQ(check.verdict, Fitness::kOk) << check.name << ": " << check.found;
    EXPECT_EQ(check.remedy, "") << check.name;
    EXPECT_NE(check.found, "") << check.name;
    EXPECT_NE(check.needed, "") << check.name;
  }
  EXPECT_EQ(check("kernel").found, "6.1.0-18-rt-amd64, PREEMPT_RT");
  EXPECT_EQ(check("isolated CPUs").found, "isolcpus=3 nohz_full=3");
  EXPECT_EQ(check("machine").found, "no sign of a virtual one (LENOVO 30E1)");
}

TEST_F(Machine, AnUnreadableOneLacksNothingThatIsNotKnown) {
  for (const Check& check : checks()) {
    EXPECT_NE(check.verdict, Fitness::kInsufficient) << check.name;
    EXPECT_NE(check.found, "") << check.name;
  }
  for (const char* name : {"real-time share", "CPUs", "CPU governor", "idle states"}) {
    EXPECT_EQ(check(name).found, "not reported by this system") << name;
    EXPECT_EQ(check(name).verdict, Fitness::kOk) << name;
  }
}

TEST_F(Machine, RubbishIsTakenForNotTold) {
  putGoodMachine();
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root_)) {
    if (entry.is_regular_file()) {
      files.push_back(fs::relative(entry.path(), root_).string());
    }
  }
  const std::string everything(100'000, '9');
  for (const std::string& rubbish : {std::string("~?"), std::string(), std::string("-"), std::string("0-"),
                                     std::string("3-1"), std::string("1-999999999"), std::string("(null)"), everything,
                                     std::string("CapEff:\nflags\nMax locked memory\nCpus_allowed_list:"),
                                     std::string("\xff\xfe\0\n", 4), std::string("(")}) {
    for (const std::string& file : files) {
      put(file, rubbish);
    }
    for (const Check& check : checks()) {
      EXPECT_NE(check.verdict, Fitness::kInsufficient) << check.name << " of " << rubbish.substr(0, 10);
    }
    EXPECT_EQ(check("CPUs").found, "not reported by this system");
  }
}

TEST_F(Machine, FilesThatAreFoldersAreNotTold) {
  putGoodMachine();
  fs::remove(root_ / "proc/sys/kernel/sched_rt_runtime_us");
  fs::create_directories(root_ / "proc/sys/kernel/sched_rt_runtime_us");
  EXPECT_EQ(check("real-time share").found, "not reported by this system");
}

TEST_F(Machine, KernelWithoutRealTimeCouldBeBetter) {
  putGoodMachine();
  put("sys/kernel/realtime", "0");
  const struct {
    const char *version, *modes, *found;
  } cases[] = {{"#1 SMP PREEMPT_DYNAMIC Debian", "none voluntary (full) lazy", "preemption full"},
               {"#1 SMP PREEMPT_DYNAMIC Debian", "(none) voluntary full", "preemption none"},
               {"#1 SMP PREEMPT_DYNAMIC Debian", "", "preemption chosen at boot"},
               {"#1 SMP PREEMPT Debian", "", "preemption full"},
               {"#1 SMP Debian", "", "preemption not reported by this system"}};
  for (const auto& [version, modes, found] : cases) {
    put("proc/version", version);
    put("sys/kernel/debug/sched/preempt", modes);
    EXPECT_EQ(check("kernel").verdict, Fitness::kImprovable) << version;
    EXPECT_THAT(check("kernel").found, HasSubstr(found));
    EXPECT_THAT(check("kernel").remedy, HasSubstr("apt-get install \"linux-image-rt-"));
  }
  put("run/systemd/container", "lxc");
  EXPECT_THAT(check("kernel").remedy, StartsWith("on the container's host: sudo apt-get"));
  put("proc/version", "#1 SMP PREEMPT_RT Debian");  // newer kernels have no sys/kernel/realtime
  EXPECT_EQ(check("kernel").verdict, Fitness::kOk);
}

TEST_F(Machine, RefusedPriorityIsLackingAndTheRemedyDependsOnWhatRefusesIt) {
  putGoodMachine();
  measured_.real_time.scheduler = "SCHED_OTHER";
  putLimits("0", "unlimited");
  EXPECT_EQ(check("scheduler").verdict, Fitness::kInsufficient);
  EXPECT_EQ(check("scheduler").remedy, kPriorityRemedy);
  EXPECT_EQ(check("scheduler").found, "SCHED_FIFO at priority 80 refused; limit of this user 0");
  putProcess("0-3", "0000000000800000");
  EXPECT_EQ(check("scheduler").found,
            "SCHED_FIFO at priority 80 refused; limit of this user 0, overridden by CAP_SYS_NICE");
  putLimits("99", "unlimited");
  EXPECT_THAT(check("scheduler").remedy, HasSubstr("cpu.rt_runtime_us"));
  put("run/.containerenv", "");
  EXPECT_THAT(check("scheduler").remedy, HasSubstr("--cap-add SYS_NICE"));
  fs::remove(root_ / "proc/self/limits");
  fs::remove(root_ / "run/.containerenv");
  EXPECT_THAT(check("scheduler").found, HasSubstr("not reported"));
  EXPECT_EQ(check("scheduler").remedy, kPriorityRemedy);
}

TEST_F(Machine, RealTimeThreadsNeedMostOfTheirCpu) {
  putGoodMachine();
  const auto at = [this](const char* runtime_us) {
    put("proc/sys/kernel/sched_rt_runtime_us", runtime_us);
    return check("real-time share");
  };
  EXPECT_EQ(at("-1").found, "not limited");
  EXPECT_EQ(at("-1").verdict, Fitness::kOk);
  EXPECT_EQ(at("950000").found, "real-time threads may use 95 % of a CPU");
  EXPECT_EQ(at("500000").verdict, Fitness::kImprovable);
  EXPECT_EQ(at("500000").remedy, "sudo sysctl kernel.sched_rt_runtime_us=950000");
  EXPECT_EQ(at("0").verdict, Fitness::kInsufficient);
  put("proc/sys/kernel/sched_rt_period_us", "0");
  EXPECT_EQ(at("0").found, "not reported by this system");
}

TEST_F(Machine, MemoryMustBeLockedAndStayEnough) {
  putGoodMachine();
  putLimits("80", "8388608");
  EXPECT_EQ(check("memory lock").verdict, Fitness::kImprovable) << "granted to a program that is small";
  EXPECT_THAT(check("memory lock").found, StartsWith("granted; limit of this user 8 MiB"));
  EXPECT_EQ(check("memory lock").remedy, kMemoryRemedy);
  putProcess("0-3", "0000000000004000");
  EXPECT_EQ(check("memory lock").verdict, Fitness::kOk) << "CAP_IPC_LOCK";
  putProcess("0-3", "00000000ffffbfff");
  EXPECT_EQ(check("memory lock").verdict, Fitness::kImprovable) << "all but CAP_IPC_LOCK";
  measured_.real_time.memory_locked = false;
  EXPECT_EQ(check("memory lock").verdict, Fitness::kInsufficient);
  EXPECT_EQ(check("memory lock").remedy, kMemoryRemedy);
  put(".dockerenv", "");
  EXPECT_THAT(check("memory lock").remedy, HasSubstr("--ulimit memlock=-1"));
}

TEST_F(Machine, OneCpuCouldBeBetter) {
  putGoodMachine();
  put("sys/devices/system/cpu/isolated", "");
  putProcess("2", "0");
  EXPECT_EQ(check("CPUs").verdict, Fitness::kImprovable);
  EXPECT_EQ(check("CPUs").found, "1 for this process of 4 that are online");
  EXPECT_THAT(check("CPUs").remedy, HasSubstr("taskset"));
  put("sys/devices/system/cpu/online", "2");
  EXPECT_THAT(check("CPUs").remedy, HasSubstr("a machine"));
  put("sys/devices/system/cpu/isolated", "3");
  putProcess("0,2-3", "0");
  EXPECT_EQ(check("CPUs").found, "3 for this process");
  putProcess("0-2", "0");  // isolcpus=3: nothing runs there of itself
  EXPECT_EQ(check("CPUs").found, "4 for this process");
}

TEST_F(Machine, AnIsolatedCpuIsOfUseOnlyToWhoRunsOnIt) {
  putGoodMachine();
  measured_.real_time.cpu = kAnyCpu;
  EXPECT_EQ(check("isolated CPUs").verdict, Fitness::kImprovable);
  EXPECT_EQ(check("isolated CPUs").remedy, "haptolith run --cpu 3");
  measured_.real_time.cpu = 1;
  EXPECT_THAT(check("isolated CPUs").found, HasSubstr("not CPU 1"));
  put("sys/devices/system/cpu/isolated", "");
  put("sys/devices/system/cpu/nohz_full", "(null)");
  EXPECT_EQ(check("isolated CPUs").found, "none");
  EXPECT_THAT(check("isolated CPUs").remedy, HasSubstr("isolcpus=1 nohz_full=1"));
  measured_.real_time.cpu = kAnyCpu;
  EXPECT_THAT(check("isolated CPUs").remedy, HasSubstr("isolcpus=3 nohz_full=3"));
}

TEST_F(Machine, GovernorCountsOnTheCpusOfTheLoop) {
  putGoodMachine();
  put("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave");
  EXPECT_EQ(check("CPU governor").verdict, Fitness::kOk) << "the loop is on CPU 3";
  measured_.real_time.cpu = kAnyCpu;
  EXPECT_EQ(check("CPU governor").verdict, Fitness::kImprovable);
  EXPECT_EQ(check("CPU governor").found, "powersave on CPU 1");
  EXPECT_THAT(check("CPU governor").remedy, StartsWith("sudo cpupower frequency-set -g performance"));
}

TEST_F(Machine, DeepSleepOfACpuCountsUnlessItIsDisabled) {
  putGoodMachine();
  put("sys/devices/system/cpu/cpu3/cpuidle/state2/name", "C6");
  put("sys/devices/system/cpu/cpu3/cpuidle/state2/latency", "133");
  put("sys/devices/system/cpu/cpu3/cpuidle/state2/disable", "0");
  EXPECT_EQ(check("idle states").verdict, Fitness::kImprovable);
  EXPECT_EQ(check("idle states").found, "C6 takes 133 us to wake from");
  put("sys/devices/system/cpu/cpu3/cpuidle/state2/disable", "1");
  EXPECT_EQ(check("idle states").found, "C1 takes 2 us to wake from");
  EXPECT_EQ(check("idle states").verdict, Fitness::kOk);
}

TEST_F(Machine, AVirtualOneCouldBeBetter) {
  putGoodMachine();
  put("proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu hypervisor avx2\n");
  put("run/systemd/container", "lxc");
  EXPECT_EQ(check("machine").verdict, Fitness::kImprovable);
  EXPECT_EQ(check("machine").found, "virtual (LENOVO 30E1), in a container (lxc)");
  put("proc/cpuinfo", "flags : fpu no_hypervisor_here");
  EXPECT_EQ(check("machine").verdict, Fitness::kOk);
}

TEST_F(Machine, WakeUpsMustBeInTime) {
  const auto after = [](int late, double late_us, std::uint64_t missed) {
    WakeUps measured;
    for (int i = 0; i < 10'000; ++i) {
      measured.late_us.add(i < late ? late_us : 20);
    }
    measured.missed = missed;
    return realTimeChecks(measured, "/no/such/root").back();
  };
  EXPECT_EQ(after(9, 900, 0).verdict, Fitness::kOk) << "less than one in a thousand";
  EXPECT_EQ(after(11, 900, 0).verdict, Fitness::kInsufficient);
  EXPECT_EQ(after(10'000, 190, 0).verdict, Fitness::kOk);
  EXPECT_EQ(after(3, 5000, 3).verdict, Fitness::kImprovable);
  EXPECT_EQ(after(3, 5000, 3).found, "99.9 % within 20 us; 3 of 10000 a tick late");
  EXPECT_THAT(after(3, 5000, 3).remedy, Not(HasSubstr("\n")));

  const Check none = realTimeChecks({}, root_).back();
  EXPECT_EQ(none.name, "wake-up");
  EXPECT_EQ(none.verdict, Fitness::kImprovable);
  EXPECT_THAT(none.found, StartsWith("not measured"));
}

TEST(RealTimeChecks, ReadsThisMachine) {
  const std::vector<Check> checks = realTimeChecks({});
  EXPECT_EQ(checks.size(), 10U);
  EXPECT_THAT(checks[0].found, testing::ContainsRegex("^[0-9]+\\."));
  EXPECT_THAT(checks[4].found, HasSubstr("for this process"));
}

}  // namespace
}  // namespace haptolith

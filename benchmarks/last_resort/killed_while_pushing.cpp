// Checks that no force remains on a haptic device after the program is killed. A process opens a Force Dimension device
// (the mock of tests/device, whose motors outlive the process here) and renders 3 N. It is killed at a random time by
// SIGSEGV, SIGABRT or SIGHUP, sent to the process or to the thread inside the SDK, whose calls take 20 us to 2 ms.
// Prints a table; exit status 1 if a force remained, or if the process did not end by the signal.
//
//     build/release/benchmarks/haptolith_killed_while_pushing [TIMES]

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <random>
#include <string_view>
#include <thread>

#include "haptolith/core/platform/last_resort.h"
#include "haptolith/core/platform/shared_library.h"
#include "haptolith/core/platform/signal_stack.h"
#include "haptolith/device/drivers/force_dimension.h"

#include "force_dimension_stand_in.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

struct Shared {
  StandInMotors motors;
  std::atomic<pid_t> loop{0};  ///< thread of the loop
};

/// Pushes until it is killed. @param crashes  whether to crash inside a call of the SDK, after 50 calls.
[[noreturn]] void push(Shared& shared, int call_us, bool crashes) {
  constexpr rlimit kNoCore{0, 0};
  setrlimit(RLIMIT_CORE, &kNoCore);
  const SharedLibrary library(HAPTOLITH_STAND_IN);
  StandIn* (*const get)() = library.symbol("standIn");
  StandIn& stand_in = *get();
  stand_in.motors = &shared.motors;
  DeviceParameters parameters;
  parameters.kind = DeviceKind::kForceDimension;
  parameters.library = HAPTOLITH_STAND_IN;
  ForceDimension device(parameters);
  const LastResort last_resort(device);
  stand_in.call_us = call_us;
  std::thread loop([&] {
    const SignalStack stack;
    shared.loop = static_cast<pid_t>(syscall(SYS_gettid));
    for (int tick = 0;; ++tick) {
      (void)device.read();
      stand_in.raises = crashes && tick == 50 ? SIGSEGV : 0;
      device.write({{Vec3(0, 0, 3), Vec3::Zero()}});
      std::this_thread::sleep_for(100us);
    }
  });
  loop.join();
  std::abort();
}

struct Death {
  int signal = 0;
  double force_n = 0;
  double after_ms = 0;
};

Death killed(std::minstd_rand& random, int signal, int call_us, bool loop_itself, bool crashes) {
  void* const memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    std::perror("mmap");
    std::exit(2);
  }
  Shared& shared = *new (memory) Shared;
  const pid_t child = fork();
  if (child == 0) {
    push(shared, call_us, crashes);
  }
  while (shared.motors.force_n == 0 && waitpid(child, nullptr, WNOHANG) == 0) {
    std::this_thread::sleep_for(100us);
  }
  std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
  const auto killed_at = std::chrono::steady_clock::now();
  if (loop_itself) {
    syscall(SYS_tgkill, child, shared.loop.load(), signal);
  } else if (!crashes) {
    kill(child, signal);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const Death death{WIFSIGNALED(status) ? WTERMSIG(status) : 0, shared.motors.force_n,
                    std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - killed_at).count()};
  munmap(memory, sizeof(Shared));
  return death;
}

int killMany(int times) {
  std::minstd_rand random(1);  // NOLINT(cert-msc51-cpp): reproducible times
  int wrong = 0;
  std::printf("%-8s %-8s %8s  %6s  %10s  %9s  %12s\n", "signal", "sent to", "call, us", "killed", "force left",
              "other end", "longest, ms");
  for (const int signal : {SIGSEGV, SIGABRT, SIGHUP}) {
    for (const bool loop_itself : {false, true}) {
      for (const int call_us : {20, 200, 2000}) {
        int left = 0;
        int other = 0;
        double longest_ms = 0;
        const int each = std::max(1, times / 18);
        for (int i = 0; i < each; ++i) {
          const Death death = killed(random, signal, call_us, loop_itself, false);
          left += death.force_n != 0 ? 1 : 0;
          other += death.signal != signal ? 1 : 0;
          longest_ms = std::max(longest_ms, death.after_ms);
        }
        wrong += left + other;
        std::printf("SIG%-5s %-8s %8d  %6d  %10d  %9d  %12.1f\n", sigabbrev_np(signal),
                    loop_itself ? "its loop" : "program", call_us, each, left, other, longest_ms);
      }
    }
  }
  // The force is undefined here, because the SDK holds its lock; but the process must end soon.
  const Death inside = killed(random, SIGSEGV, 20, false, true);
  wrong += inside.signal == SIGSEGV ? 0 : 1;
  std::printf("a crash inside the SDK: died of SIG%s%s, for the device's own watchdog\n", sigabbrev_np(inside.signal),
              inside.force_n != 0 ? " with its force on" : "");
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace haptolith

int main(int count, char** arguments) {
  return haptolith::killMany(count > 1 ? std::atoi(arguments[1]) : 200);
}

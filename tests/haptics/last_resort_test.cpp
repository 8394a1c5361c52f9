#include "haptolith/core/platform/last_resort.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

namespace haptolith {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // the sanitizers have their own handlers for these signals
#else
constexpr bool kSanitized = false;
#endif

/// The release is recorded as a character in a pipe: all that a signal handler may do, and it outlives the process.
class Piped final : public HapticDevice {
 public:
  Piped(int pipe, char letter) : pipe_(pipe), letter_(letter) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "piped"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] DeviceInput read() noexcept override { return {}; }
  void write(const DeviceOutput&) noexcept override {}
  void releaseForce() noexcept override { tell(letter_); }
  void releaseForceRegardless() noexcept override { tell('r'); }
  [[nodiscard]] ForceRelease forceRelease() const noexcept override {
    if (--looks_left_ >= 0) {
      return ForceRelease::kUnderWay;
    }
    if (stuck_) {
      return ForceRelease::kStuck;
    }
    tell('.');
    return ForceRelease::kDone;
  }
  void resumeForce() noexcept override {}

  mutable std::atomic<int> looks_left_{0};  ///< number of queries during which a thread is still inside the library
  bool stuck_ = false;                      ///< the thread that asks is

 private:
  void tell(char letter) const noexcept { (void)!::write(pipe_, &letter, 1); }

  int pipe_;
  char letter_;
};

struct Death {
  std::string let_go;  ///< the characters of the released devices, in order
  int signal = 0;      ///< signal that ended the process; 0 when it exited
};

/// Runs `last_words` in a separate process, given the pipe's end.
Death died(const std::function<void(int pipe)>& last_words) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    throw std::runtime_error("no pipe");
  }
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    std::freopen("/dev/null", "w", stderr);  // the output of std::terminate() is irrelevant
    last_words(ends[1]);
    _exit(0);
  }
  close(ends[1]);
  Death death;
  char letter = 0;
  while (read(ends[0], &letter, 1) == 1) {
    death.let_go += letter;
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  death.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  return death;
}

class DeadlySignal : public testing::TestWithParam<int> {};

TEST_P(DeadlySignal, LetsGoOfTheHandAndEndsTheProgramAsEver) {
  if (kSanitized && GetParam() != SIGHUP && GetParam() != SIGQUIT) {
    GTEST_SKIP() << "the sanitizer handles it";
  }
  const Death death = died([](int pipe) {
    Piped hand(pipe, 'a');
    const LastResort last_resort(hand);
    std::raise(GetParam());
  });
  EXPECT_EQ(death.let_go, "a.");
  EXPECT_EQ(death.signal, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, DeadlySignal,
                         testing::Values(SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP, SIGHUP, SIGQUIT,
                                         SIGINT, SIGTERM, SIGXCPU, SIGXFSZ, SIGUSR1, SIGUSR2, SIGALRM, SIGPROF,
                                         SIGVTALRM, SIGIO, SIGPWR, SIGSTKFLT, SIGPIPE, SIGRTMIN, SIGRTMAX),
                         [](const testing::TestParamInfo<int>& test) {
                           const char* name = sigabbrev_np(test.param);
                           return name != nullptr ? std::string(name) : "Number" + std::to_string(test.param);
                         });

class HaltingSignal : public testing::TestWithParam<int> {};

TEST_P(HaltingSignal, LetsGoOfTheHandHaltsTheProgramAndTellsTheLoopWhenItGoesOn) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    setpgid(0, 0);  // as a shell does; a process that could not be continued is not halted
    Piped hand(ends[1], 'a');
    const LastResort last_resort(hand);
    for (int round = 0; round < 2; ++round) {
      std::raise(GetParam());
      if (!LastResort::releasedForceMeanwhile() || LastResort::releasedForceMeanwhile()) {
        _exit(1);
      }
    }
    _exit(0);
  }
  close(ends[1]);
  int status = 0;
  for (int round = 0; round < 2; ++round) {
    ASSERT_EQ(waitpid(child, &status, WUNTRACED), child);
    ASSERT_TRUE(WIFSTOPPED(status));
    EXPECT_EQ(WSTOPSIG(status), GetParam());
    std::array<char, 9> letters{};
    ASSERT_EQ(read(ends[0], letters.data(), 8), 2) << "before it halts";
    EXPECT_STREQ(letters.data(), "a.");
    kill(child, SIGCONT);
  }
  waitpid(child, &status, 0);
  close(ends[0]);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << "the loop is told once";
}

INSTANTIATE_TEST_SUITE_P(All, HaltingSignal, testing::Values(SIGTSTP, SIGTTIN, SIGTTOU),
                         [](const testing::TestParamInfo<int>& test) { return std::string(sigabbrev_np(test.param)); });

TEST(LastResort, WaitsForACallThatIsInsideTheDevicesLibrary) {
  const Death death = died([](int pipe) {
    Piped hand(pipe, 'a');
    hand.looks_left_ = 8;
    const LastResort last_resort(hand);
    std::raise(SIGHUP);
  });
  EXPECT_EQ(death.let_go, "a.");
  EXPECT_EQ(death.signal, SIGHUP);
}

TEST(LastResort, WaitsNotForEverAndThenTriesToGetPastTheCall) {
  const auto began = std::chrono::steady_clock::now();
  const Death hangs = died([](int pipe) {
    Piped hand(pipe, 'a');
    hand.looks_left_ = 1 << 30;
    const LastResort last_resort(hand);
    std::raise(SIGHUP);
  });
  EXPECT_EQ(hangs.let_go, "ar");
  EXPECT_EQ(hangs.signal, SIGHUP);
  const Death crashed_inside = died([](int pipe) {
    Piped hand(pipe, 'a');
    hand.stuck_ = true;
    const LastResort last_resort(hand);
    std::raise(SIGABRT);
  });
  EXPECT_EQ(crashed_inside.let_go, "ar");
  EXPECT_EQ(crashed_inside.signal, SIGABRT);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20));
}

int fallsDeeper(int depth) {
  std::array<volatile char, 4096> frame{};
  frame[0] = static_cast<char>(depth);
  return depth < 0 ? 0 : fallsDeeper(depth + 1) + frame[0];
}

TEST(LastResort, AnOverflowOfTheStackLetsGo) {
  if (kSanitized) {
    GTEST_SKIP() << "the sanitizer handles it";
  }
  const Death own = died([](int pipe) {
    Piped hand(pipe, 'a');
    const LastResort last_resort(hand);
    _exit(fallsDeeper(0));
  });
  EXPECT_EQ(own.let_go, "a.") << "of the thread that made it";
  EXPECT_EQ(own.signal, SIGSEGV);
  const Death other = died([](int pipe) {
    Piped hand(pipe, 'a');
    const LastResort last_resort(hand);
    std::thread([] {
      const SignalStack stack;
      _exit(fallsDeeper(0));
    }).join();
  });
  EXPECT_EQ(other.let_go, "a.");
  EXPECT_EQ(other.signal, SIGSEGV);
}

TEST(LastResort, AnotherThreadThatDiesMeanwhileWaitsUntilTheHandIsLetGo) {
  const Death death = died([](int pipe) {
    Piped hand(pipe, 'a');
    hand.looks_left_ = 8;
    const LastResort last_resort(hand);
    std::thread other([&hand] {
      while (hand.looks_left_ == 8) {
      }
      std::raise(SIGTERM);
    });
    std::raise(SIGHUP);
    other.join();
  });
  EXPECT_EQ(death.let_go, "a.");
  EXPECT_TRUE(death.signal == SIGHUP || death.signal == SIGTERM) << death.signal;
}

TEST(LastResort, WhoHandlesASignalKeepsIt) {
  const Death death = died([](int pipe) {
    std::signal(SIGUSR1, [](int) {});
    Piped hand(pipe, 'a');
    const LastResort last_resort(hand);
    std::raise(SIGUSR1);
  });
  EXPECT_EQ(death.let_go, "");
  EXPECT_EQ(death.signal, 0);
}

TEST(LastResort, AWildPointerLetsGo) {
  if (kSanitized) {
    GTEST_SKIP() << "the sanitizer handles it";
  }
  const Death death = died([](int pipe) {
    Piped hand(pipe, 'a');
    const LastResort last_resort(hand);
    volatile int* nowhere = nullptr;
    *nowhere = 1;
  });
  EXPECT_EQ(death.let_go, "a.");
  EXPECT_EQ(death.signal, SIGSEGV);
}

TEST(LastResort, AnExceptionThatNobodyCatchesLetsGo) {
  if (kSanitized) {
    GTEST_SKIP() << "the sanitizer handles it";
  }
  const Death death = died([](int pipe) {
    Piped hand(pipe, 'a');
    const LastResort last_resort(hand);
    std::thread([] { throw std::runtime_error("nobody catches this"); }).join();
  });
  EXPECT_EQ(death.let_go, "a.");
  EXPECT_EQ(death.signal, SIGABRT);
}

TEST(LastResort, AfterItsEndSignalsAreAsEver) {
  const Death death = died([](int pipe) {
    Piped hand(pipe, 'a');
    { const LastResort last_resort(hand); }
    std::raise(SIGHUP);
  });
  EXPECT_EQ(death.let_go, "");
  EXPECT_EQ(death.signal, SIGHUP);
}

TEST(LastResort, ASecondOneTakesOverUntilItGoes) {
  const Death inner = died([](int pipe) {
    Piped first(pipe, 'a'), second(pipe, 'b');
    const LastResort outer(first);
    const LastResort one_more(second);
    std::raise(SIGHUP);
  });
  EXPECT_EQ(inner.let_go, "b.");
  const Death outer = died([](int pipe) {
    Piped first(pipe, 'a'), second(pipe, 'b');
    const LastResort outermost(first);
    { const LastResort one_more(second); }
    std::raise(SIGHUP);
  });
  EXPECT_EQ(outer.let_go, "a.");
  EXPECT_EQ(outer.signal, SIGHUP);
}

TEST(LastResort, ASignalThatSomebodyWantsToBeHarmlessStaysSo) {  // nohup
  const Death death = died([](int pipe) {
    std::signal(SIGHUP, SIG_IGN);
    Piped hand(pipe, 'a');
    const LastResort last_resort(hand);
    std::raise(SIGHUP);
  });
  EXPECT_EQ(death.let_go, "");
  EXPECT_EQ(death.signal, 0);
}

}  // namespace
}  // namespace haptolith

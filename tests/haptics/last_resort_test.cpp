#include "haptolith/haptics/last_resort.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

namespace haptolith {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // the sanitizers have handlers of their own for these signals
#else
constexpr bool kSanitized = false;
#endif

/// Letting go is a letter in a pipe: all that a handler of signals may do, and it outlives the process.
class Piped final : public HapticDevice {
 public:
  Piped(int pipe, char letter) : pipe_(pipe), letter_(letter) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "piped"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return {}; }
  [[nodiscard]] DeviceInput read() noexcept override { return {}; }
  void write(const DeviceOutput&) noexcept override {}
  void letGo() noexcept override { (void)!::write(pipe_, &letter_, 1); }
  void takeUp() noexcept override {}

 private:
  int pipe_;
  char letter_;
};

struct Death {
  std::string let_go;  ///< the letters of the devices that were let go, in order
  int signal = 0;      ///< that ended the process; 0 when it ended by itself
};

/// Does `last_words` in a process of its own, given the pipe's end.
Death died(const std::function<void(int pipe)>& last_words) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    throw std::runtime_error("no pipe");
  }
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    std::freopen("/dev/null", "w", stderr);  // what std::terminate() says is not of interest
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
  EXPECT_EQ(death.let_go, "a");
  EXPECT_EQ(death.signal, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, DeadlySignal,
                         testing::Values(SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGHUP, SIGQUIT, SIGXCPU,
                                         SIGXFSZ),
                         [](const testing::TestParamInfo<int>& test) { return std::string(sigabbrev_np(test.param)); });

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
  EXPECT_EQ(death.let_go, "a");
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
  EXPECT_EQ(death.let_go, "a");
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
  EXPECT_EQ(inner.let_go, "b");
  const Death outer = died([](int pipe) {
    Piped first(pipe, 'a'), second(pipe, 'b');
    const LastResort outermost(first);
    { const LastResort one_more(second); }
    std::raise(SIGHUP);
  });
  EXPECT_EQ(outer.let_go, "a");
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

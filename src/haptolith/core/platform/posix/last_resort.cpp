#include "haptolith/core/platform/last_resort.h"

#include <pthread.h>
#include <semaphore.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>

#include "haptolith/core/platform/clock.h"
#include "haptolith/core/platform/start_thread.h"

namespace haptolith {

namespace {

/// A call of a device's library takes 2 ms at most when all is well, and a tick has some ten of them.
constexpr std::int64_t kPatience_ns = 50'000'000;
constexpr long kBetweenLooks_ns = 50'000;

constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP};
constexpr std::array kHalting{SIGTSTP, SIGTTIN, SIGTTOU};
/// Signals without effect unless handled, or that cannot be handled.
constexpr std::array kLeftAlone{SIGCHLD, SIGCONT, SIGURG, SIGWINCH, SIGKILL, SIGSTOP};

constexpr int kSignals = 65;  // Linux has 1 to 64
constexpr int kFinish = -1;   // commands to the helper, in addition to signals
constexpr int kTryRegardless = -2;

template <std::size_t kCount>
constexpr bool isOneOf(int signal, const std::array<int, kCount>& signals) noexcept {
  return std::find(signals.begin(), signals.end(), signal) != signals.end();
}

// All that a handler of signals touches may be touched in one: lock-free atomics, and what POSIX names.
static_assert(std::atomic<ForceSource*>::is_always_lock_free && std::atomic<int>::is_always_lock_free);
std::atomic<ForceSource*> hand_at{nullptr};
std::atomic<bool> dying{false};               ///< a signal that ends the program has come
std::atomic<bool> done{false};                ///< and what can be done for the hand has been
std::atomic<bool> helped{false};              ///< zero has been sent regardless
std::atomic<bool> has_released_force{false};  ///< see releasedForceMeanwhile()
std::atomic<int> helpers_command{0};          ///< command to the helper
sem_t call;                                   ///< semaphore of the helper
std::array<struct sigaction, kSignals> usual_actions;
std::array<bool, kSignals> handled{};

void onSignal(int signal, siginfo_t* info, void* context);

void handle(int signal) noexcept {
  struct sigaction action {};
  action.sa_sigaction = onSignal;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  sigfillset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

/// Takes the default action of the signal. Returns when a halted program continues.
void takeEffect(int signal) noexcept {
  sigaction(signal, &usual_actions[static_cast<std::size_t>(signal)], nullptr);
  sigset_t only;
  sigset_t before;
  sigemptyset(&only);
  sigaddset(&only, signal);
  (void)std::raise(signal);
  pthread_sigmask(SIG_UNBLOCK, &only, &before);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  handle(signal);
}

template <class Condition>
bool within(std::int64_t timeout_ns, const Condition& met) noexcept {
  const std::int64_t until_ns = monotonicNs() + timeout_ns;
  while (!met()) {
    if (monotonicNs() > until_ns) {
      return false;
    }
    const timespec moment{0, kBetweenLooks_ns};
    nanosleep(&moment, nullptr);
  }
  return true;
}

/// Waits until the device has been released, or this thread finds that it holds the lock itself.
ForceRelease waitFor(const ForceSource& device) noexcept {
  ForceRelease how = ForceRelease::kUnderWay;
  (void)within(kPatience_ns, [&] { return (how = device.forceRelease()) != ForceRelease::kUnderWay; });
  return how;
}

void callHelper(int what) noexcept {
  helpers_command.store(what);
  sem_post(&call);
}

/// Whether the thread that was interrupted caused the signal: when it is sent back, it does so again or is lost.
bool causedHere(int signal, const siginfo_t& info) noexcept {
  const bool sent = info.si_code <= 0;  // by kill(), raise() and the like, not by the kernel
  return sent ? info.si_code == SI_TKILL && info.si_pid == getpid() : isOneOf(signal, kCrashes);
}

void onSignal(int signal, siginfo_t* info, void* /*context*/) {
  const int error = errno;
  const bool halts = isOneOf(signal, kHalting);
  if (halts ? dying.load() : dying.exchange(true)) {  // another thread is at it
    if (!halts) {
      (void)within(3 * kPatience_ns, [] { return done.load(); });
      takeEffect(signal);
    }
    errno = error;
    return;
  }
  ForceSource* const device = hand_at.load();
  if (device != nullptr) {
    device->releaseForce();
    const ForceRelease how = waitFor(*device);
    if (how == ForceRelease::kStuck && !causedHere(signal, *info)) {
      callHelper(signal);
      errno = error;
      return;
    }
    if (how != ForceRelease::kDone) {
      callHelper(kTryRegardless);
      (void)within(kPatience_ns, [] { return helped.load(); });
    }
  }
  done = !halts;
  takeEffect(signal);
  has_released_force = true;
  errno = error;
}

void help() noexcept {
  while (true) {
    while (sem_wait(&call) != 0) {
    }
    const int what = helpers_command.load();
    if (what == kFinish) {
      return;
    }
    ForceSource* const device = hand_at.load();
    if (device == nullptr) {
      continue;
    }
    if (what == kTryRegardless) {
      device->releaseForceRegardless();
      helped = true;
      continue;
    }
    (void)waitFor(*device);
    done = !isOneOf(what, kHalting);
    takeEffect(what);
    has_released_force = true;
  }
}

void handleAll() noexcept {
  for (int signal = 1; signal < kSignals; ++signal) {
    const auto at = static_cast<std::size_t>(signal);
    handled[at] = false;
    if (isOneOf(signal, kLeftAlone) ||
        sigaction(signal, nullptr, &usual_actions[at]) != 0) {  // glibc keeps two to itself
      continue;
    }
    const bool is_default = (usual_actions[at].sa_flags & SA_SIGINFO) == 0 && usual_actions[at].sa_handler == SIG_DFL;
    const bool is_ignored = (usual_actions[at].sa_flags & SA_SIGINFO) == 0 && usual_actions[at].sa_handler == SIG_IGN;
    if (is_default || (isOneOf(signal, kCrashes) && !is_ignored)) {
      handled[at] = true;
      handle(signal);
    }
  }
}

/// Restores the default action, unless another handler has been installed.
void handleAsUsual() noexcept {
  for (int signal = 1; signal < kSignals; ++signal) {
    const auto at = static_cast<std::size_t>(signal);
    struct sigaction now {};
    if (handled[at] && sigaction(signal, nullptr, &now) == 0 && now.sa_sigaction == onSignal) {
      sigaction(signal, &usual_actions[at], nullptr);
    }
  }
}

/// A thread that no signal ever interrupts.
std::thread startHelper() {
  sem_init(&call, 0, 0);
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    std::thread helper = startThread("the helper that sets the force to zero when the program ends", help);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return helper;
  } catch (...) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    throw;
  }
}

}  // namespace

LastResort::LastResort(ForceSource& device) : before_(hand_at.load()) {
  if (before_ == nullptr) {
    dying = done = helped = has_released_force = false;
    helper_ = startHelper();
  }
  hand_at = &device;
  if (before_ == nullptr) {
    handleAll();
  }
}

LastResort::~LastResort() {
  if (before_ == nullptr) {
    handleAsUsual();
  }
  hand_at = before_;
  if (helper_.joinable()) {
    callHelper(kFinish);
    helper_.join();
  }
}

bool LastResort::releasedForceMeanwhile() noexcept {
  return has_released_force.exchange(false);
}

}  // namespace haptolith

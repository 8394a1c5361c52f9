#include "haptolith/haptics/last_resort.h"

#include <array>
#include <atomic>
#include <csignal>

namespace haptolith {

namespace {

/// Signals that end a program unless somebody handles them; SIGINT and SIGTERM are handled in good order elsewhere.
constexpr std::array kDeadly{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGHUP, SIGQUIT, SIGXCPU, SIGXFSZ};

std::atomic<HapticDevice*> hand_at{nullptr};
std::array<struct sigaction, kDeadly.size()> usual;

void letGoAndDie(int signal) {
  if (HapticDevice* device = hand_at.exchange(nullptr)) {
    device->letGo();
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void handleDeadlySignals() noexcept {
  struct sigaction action {};
  action.sa_handler = letGoAndDie;
  for (std::size_t i = 0; i < kDeadly.size(); ++i) {
    sigaction(kDeadly[i], &action, &usual[i]);
    if (usual[i].sa_handler == SIG_IGN) {  // somebody wants it to be harmless
      sigaction(kDeadly[i], &usual[i], nullptr);
    }
  }
}

void handleAsUsual() noexcept {
  for (std::size_t i = 0; i < kDeadly.size(); ++i) {
    sigaction(kDeadly[i], &usual[i], nullptr);
  }
}

}  // namespace

LastResort::LastResort(HapticDevice& device) noexcept : before_(hand_at.exchange(&device)) {
  if (before_ == nullptr) {
    handleDeadlySignals();
  }
}

LastResort::~LastResort() {
  hand_at = before_;
  if (before_ == nullptr) {
    handleAsUsual();
  }
}

}  // namespace haptolith

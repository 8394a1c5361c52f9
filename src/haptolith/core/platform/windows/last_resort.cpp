#include "haptolith/core/platform/last_resort.h"

#include <windows.h>

#include <atomic>
#include <csignal>
#include <cstdlib>

#include "haptolith/core/platform/clock.h"

namespace haptolith {

namespace {

/// A call of a device's library takes 2 ms at most when all is well, and a tick has some ten of them.
constexpr std::int64_t kPatience_ns = 50'000'000;

std::atomic<ForceSource*> hand_at{nullptr};
PVOID first_handler = nullptr;
void (*usual_abort)(int) = SIG_DFL;

/// Waits until a thread inside the device's library has come out, and past that tries regardless.
void release() noexcept {
  ForceSource* const device = hand_at.load();
  if (device == nullptr) {
    return;
  }
  device->releaseForce();
  const std::int64_t until_ns = monotonicNs() + kPatience_ns;
  ForceRelease how = device->forceRelease();
  while (how == ForceRelease::kUnderWay && monotonicNs() < until_ns) {
    Sleep(1);
    how = device->forceRelease();
  }
  if (how != ForceRelease::kDone) {
    device->releaseForceRegardless();
  }
}

/// Whether nothing but the end of the program follows. Others are part of a program's ordinary life: C++ exceptions,
/// names of threads, messages to a debugger.
bool isCrash(DWORD code) noexcept {
  switch (code) {
    case EXCEPTION_ACCESS_VIOLATION:
    case EXCEPTION_ARRAY_BOUNDS_EXCEEDED:
    case EXCEPTION_DATATYPE_MISALIGNMENT:
    case EXCEPTION_FLT_DIVIDE_BY_ZERO:
    case EXCEPTION_FLT_INVALID_OPERATION:
    case EXCEPTION_ILLEGAL_INSTRUCTION:
    case EXCEPTION_IN_PAGE_ERROR:
    case EXCEPTION_INT_DIVIDE_BY_ZERO:
    case EXCEPTION_PRIV_INSTRUCTION:
    case EXCEPTION_STACK_OVERFLOW: return true;
    default: return false;
  }
}

LONG CALLBACK onException(EXCEPTION_POINTERS* info) {
  if (isCrash(info->ExceptionRecord->ExceptionCode)) {
    release();
  }
  return EXCEPTION_CONTINUE_SEARCH;
}

/// Ctrl-C, the window closed, the user logged off: in a thread of the system's.
BOOL WINAPI onConsole(DWORD /*event*/) {
  release();
  return FALSE;
}

void onAbort(int /*signal*/) {
  release();
}

}  // namespace

LastResort::LastResort(ForceSource& device) : before_(hand_at.exchange(&device)) {
  if (before_ == nullptr) {
    first_handler = AddVectoredExceptionHandler(1, onException);
    usual_abort = std::signal(SIGABRT, onAbort);
    SetConsoleCtrlHandler(onConsole, TRUE);
  }
}

LastResort::~LastResort() {
  if (before_ == nullptr) {
    RemoveVectoredExceptionHandler(first_handler);
    std::signal(SIGABRT, usual_abort);
    SetConsoleCtrlHandler(onConsole, FALSE);
  }
  hand_at = before_;
}

// Windows halts no program by a signal.
bool LastResort::releasedForceMeanwhile() noexcept {
  return false;
}

}  // namespace haptolith

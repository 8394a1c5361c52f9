#include "haptolith/core/platform/terminal.h"

#include <io.h>
#include <windows.h>

namespace haptolith {

namespace {

HANDLE handleOf(int descriptor) noexcept {
  return reinterpret_cast<HANDLE>(_get_osfhandle(descriptor));
}

}  // namespace

// Other devices, such as NUL, are no consoles.
bool isTerminal(int descriptor) noexcept {
  DWORD mode = 0;
  return _isatty(descriptor) != 0 && GetConsoleMode(handleOf(descriptor), &mode) != 0;
}

std::size_t terminalColumns(int descriptor) noexcept {
  CONSOLE_SCREEN_BUFFER_INFO info{};
  const bool known = GetConsoleScreenBufferInfo(handleOf(descriptor), &info) != 0;
  const int columns = info.srWindow.Right - info.srWindow.Left + 1;
  return known && columns > 0 ? static_cast<std::size_t>(columns) : 0;
}

void prepareTerminals() noexcept {
  SetConsoleOutputCP(CP_UTF8);
  for (const int descriptor : {1, 2}) {
    DWORD mode = 0;
    if (isTerminal(descriptor) && GetConsoleMode(handleOf(descriptor), &mode) != 0) {
      SetConsoleMode(handleOf(descriptor), mode | ENABLE_PROCESSED_OUTPUT | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
    }
  }
}

}  // namespace haptolith

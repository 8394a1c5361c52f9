#include "haptolith/core/platform/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

namespace haptolith {

bool isTerminal(int descriptor) noexcept {
  return isatty(descriptor) == 1;
}

std::size_t terminalColumns(int descriptor) noexcept {
  winsize size{};
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

void prepareTerminals() noexcept {}

}  // namespace haptolith

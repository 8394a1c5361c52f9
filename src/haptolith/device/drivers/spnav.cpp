#include "haptolith/device/drivers/spnav.h"

#include <fmt/format.h>

#include "haptolith/core/error.h"

namespace haptolith {

const Spnav& Spnav::get() {
  try {
    static const Spnav& spnav = *new Spnav;  // for ever
    return spnav;
  } catch (const Failure& failure) {
    throw Failure(fmt::format("{}; install libspnav: sudo apt-get install libspnav0", failure.what()));
  }
}

}  // namespace haptolith

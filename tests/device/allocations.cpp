#include "allocations.h"

#include "../counted_new.h"

namespace haptolith {

long allocationsOfThisThread() noexcept {
  return allocations_of_thread;
}

}  // namespace haptolith

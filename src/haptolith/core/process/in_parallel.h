#pragma once

#include <cstddef>
#include <functional>

namespace haptolith {

/// Runs work(0) to work(count - 1) on up to `threads` threads, each piece on one; the order is open, so pieces must not
/// share anything they write. @throws what the first failing piece threw, after the running ones have ended.
void inParallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace haptolith

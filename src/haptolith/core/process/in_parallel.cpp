#include "haptolith/core/process/in_parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "haptolith/core/process/async.h"

namespace haptolith {

void inParallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto serve = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        failure = failure ? failure : std::current_exception();
        next = count;
      }
    }
  };
  {
    std::vector<std::jthread> others;
    const std::size_t most = kHasThreads ? static_cast<std::size_t>(std::max(1, threads)) : 1;
    for (std::size_t i = 1; i < std::min(count, most); ++i) {
      others.emplace_back(serve);
    }
    serve();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
}

}  // namespace haptolith

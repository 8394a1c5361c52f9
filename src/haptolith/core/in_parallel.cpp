#include "haptolith/core/in_parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

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
    for (std::size_t i = 1; i < std::min(count, static_cast<std::size_t>(std::max(1, threads))); ++i) {
      others.emplace_back(serve);
    }
    serve();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
}

struct SharedProgress::State {
  std::mutex mutex;
  std::vector<double> shares;
};

SharedProgress::SharedProgress(const LabConditions& conditions, std::size_t count)
    : conditions_(conditions), state_(std::make_unique<State>()) {
  state_->shares.resize(count);
}

SharedProgress::~SharedProgress() = default;

LabConditions SharedProgress::conditionsOf(std::size_t index) {
  LabConditions piece = conditions_;
  piece.threads = 1;
  if (conditions_.progress) {
    piece.progress = [this, index](std::string_view what, double share) {
      const std::scoped_lock lock(state_->mutex);
      std::vector<double>& shares = state_->shares;
      shares[index] = std::max(shares[index], share);  // pieces have phases; the whole never goes back
      const double all = std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
      return conditions_.progress(what, all);
    };
  }
  return piece;
}

}  // namespace haptolith

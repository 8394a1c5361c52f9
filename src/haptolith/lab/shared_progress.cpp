#include "haptolith/lab/shared_progress.h"

#include <algorithm>
#include <mutex>
#include <string_view>
#include <vector>

#include "haptolith/core/statistics.h"

namespace haptolith {

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
      shares[index] = std::max(shares[index], share);  // a piece restarts at 0 for each phase
      return conditions_.progress(what, mean(shares));
    };
  }
  return piece;
}

}  // namespace haptolith

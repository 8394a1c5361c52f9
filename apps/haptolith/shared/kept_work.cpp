#include "shared/kept_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/process/in_parallel.h"
#include "haptolith/core/stop_asked.h"

#include "shared/output.h"

namespace haptolith {

KeptWork::KeptWork(std::vector<double> lengths_s, int threads, StatusLine& status)
    : lengths_s_(std::move(lengths_s)),
      fractions_(lengths_s_.size(), 1),
      threads_(threads),
      threads_each_(threads),
      status_(status) {}

void KeptWork::run(const std::vector<std::size_t>& missing, const std::filesystem::path& kept,
                   const std::function<void(std::size_t)>& piece) {
  done_ = lengths_s_.size() - missing.size();
  double missing_s = 0;
  for (const std::size_t index : missing) {
    fractions_[index] = 0;
    missing_s += lengths_s_[index];
  }
  progress_.emplace(status_, fractionDone());
  progress_->expect(missing_s, threads_);
  if (done_ > 0) {
    post(fmt::format("{} of {} results are already available\n", done_, lengths_s_.size()));
  }
  const std::size_t at_once = std::clamp<std::size_t>(missing.size(), 1, static_cast<std::size_t>(threads_));
  threads_each_ = threads_ / static_cast<int>(at_once);
  try {
    inParallel(missing.size(), static_cast<int>(at_once), [&](std::size_t i) {
      try {
        piece(missing[i]);
      } catch (...) {
        gives_up_ = true;  // stops the other pieces, which may take minutes
        throw;
      }
    });
  } catch (const Failure&) {
    if (!stopAsked()) {
      throw;
    }
    throw Failure(
        fmt::format("interrupted: {} of {} results are saved in {}; repeat the command with --resume to continue",
                    done_, lengths_s_.size(), kept.string()));
  }
}

bool KeptWork::ends() const {
  return stopAsked() || gives_up_;
}

double KeptWork::fractionDone() const {
  return std::inner_product(lengths_s_.begin(), lengths_s_.end(), fractions_.begin(), 0.0) /
         std::accumulate(lengths_s_.begin(), lengths_s_.end(), 0.0);
}

LabProgress KeptWork::progressOf(std::size_t index, std::string title) {
  return [this, index, title = std::move(title)](std::string_view what, double share) {
    const std::scoped_lock lock(mutex_);
    fractions_[index] = std::max(fractions_[index], share);
    (void)progress_->tell(fmt::format("{} of {} done; {}: {}", done_, lengths_s_.size(), title, what), fractionDone());
    return !ends();
  };
}

void KeptWork::finish(std::size_t index, const std::function<std::string()>& keep) {
  const std::scoped_lock lock(mutex_);
  fractions_[index] = 1;
  ++done_;
  const std::string text = keep();
  progress_->advance(fractionDone());
  status_.clear();
  post(fmt::format("[{}/{}] {}{}\n", done_, lengths_s_.size(), text, progress_->leftText()));
}

}  // namespace haptolith

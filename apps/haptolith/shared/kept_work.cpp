#include "shared/kept_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/in_parallel.h"

#include "shared/output.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

KeptWork::KeptWork(std::size_t pieces, int threads, StatusLine& status)
    : pieces_(pieces), threads_(threads), threads_each_(threads), status_(status) {}

void KeptWork::run(const std::vector<std::size_t>& missing, const std::filesystem::path& kept,
                   const std::function<void(std::size_t)>& piece) {
  done_ = pieces_ - missing.size();
  if (done_ > 0) {
    post(fmt::format("{} of {} results are there already\n", done_, pieces_));
  }
  at_once_ = std::clamp<std::size_t>(missing.size(), 1, static_cast<std::size_t>(threads_));
  threads_each_ = threads_ / static_cast<int>(at_once_);
  try {
    inParallel(missing.size(), static_cast<int>(at_once_), [&](std::size_t i) {
      try {
        {
          const std::scoped_lock lock(mutex_);
          running_.insert(missing[i]);
        }
        piece(missing[i]);
      } catch (...) {
        gives_up_ = true;  // the others need not go on for minutes
        throw;
      }
    });
  } catch (const Failure&) {
    if (!stopAsked()) {
      throw;
    }
    throw Failure(fmt::format("interrupted: {} of {} results are kept in {}; the same command with --resume goes on",
                              done_, pieces_, kept.string()));
  }
}

bool KeptWork::ends() const {
  return stopAsked() || gives_up_;
}

LabProgress KeptWork::progressOf(std::size_t index, std::string title) {
  return [this, index, title = std::move(title)](std::string_view what, double share) {
    if (status_.visible()) {
      const std::scoped_lock lock(mutex_);
      if (index == *running_.begin()) {  // one of those at work is enough to look at
        status_.update(fmt::format("{} of {} done; {}: {}: {:.0f} %", done_, pieces_, title, what, 100 * share));
      }
    }
    return !ends();
  };
}

void KeptWork::finish(std::size_t index, const std::function<std::string()>& keep) {
  const std::scoped_lock lock(mutex_);
  running_.erase(index);
  ++done_;
  const std::string text = keep();
  status_.clear();
  post(fmt::format("[{}/{}] {}\n", done_, pieces_, text));
}

}  // namespace haptolith

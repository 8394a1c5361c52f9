#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/laboratory.h"

#include "shared/progress.h"

namespace haptolith {

/// Hours of work in pieces, several at the same time, each of which is kept as soon as it is done. Not for the tick.
class KeptWork {
 public:
  /// @param lengths_s  seconds that each piece takes on one thread, about; those included that were done before.
  /// @param threads  to be shared out among the pieces.
  KeptWork(std::vector<double> lengths_s, int threads, StatusLine& status);

  /// Does each of `missing`; tells first how many are there already.
  /// @param kept  where what is done lies, for whoever interrupts.
  /// @throws what a piece throws; Failure when somebody ends it before.
  void run(const std::vector<std::size_t>& missing, const std::filesystem::path& kept,
           const std::function<void(std::size_t)>& piece);

  [[nodiscard]] int threadsEach() const { return threads_each_; }
  [[nodiscard]] bool ends() const;

  /// Of a piece under way: shown as progress of all pieces together, which end where somebody asks for it.
  [[nodiscard]] LabProgress progressOf(std::size_t index, std::string title);

  /// Calls `keep`, one piece at a time, and prints what it says of the piece, with the time left.
  void finish(std::size_t index, const std::function<std::string()>& keep);

 private:
  [[nodiscard]] double fractionDone() const;

  std::vector<double> lengths_s_, fractions_;
  std::size_t done_ = 0;
  int threads_, threads_each_;
  StatusLine& status_;
  std::optional<Progress> progress_;
  std::mutex mutex_;
  std::atomic<bool> gives_up_ = false;
};

}  // namespace haptolith

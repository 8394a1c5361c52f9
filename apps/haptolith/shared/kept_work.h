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

/// Long work in pieces, several in parallel. Each is saved as soon as it is done. Not for the tick.
class KeptWork {
 public:
  /// @param lengths_s  approximate duration of each piece on one thread, in s; includes finished pieces.
  /// @param threads  number of threads, divided among the pieces.
  KeptWork(std::vector<double> lengths_s, int threads, StatusLine& status);

  /// Runs the pieces `missing`; first prints the number of finished pieces.
  /// @param kept  location of the results, printed on interruption.
  /// @throws the exception of a piece; Failure when interrupted.
  void run(const std::vector<std::size_t>& missing, const std::filesystem::path& kept,
           const std::function<void(std::size_t)>& piece);

  [[nodiscard]] int threadsEach() const { return threads_each_; }
  [[nodiscard]] bool ends() const;

  /// Returns the progress of a running piece, shown as that of all pieces; cancels them when interrupted.
  [[nodiscard]] LabProgress progressOf(std::size_t index, std::string title);

  /// Calls `keep`, one piece at a time, and prints its text with the remaining time.
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

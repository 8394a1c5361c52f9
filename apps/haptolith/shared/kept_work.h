#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "haptolith/lab/laboratory.h"

namespace haptolith {

class StatusLine;

/// Hours of work in pieces, several at the same time, each of which is kept as soon as it is done. Not for the tick.
class KeptWork {
 public:
  /// @param pieces  how many there are, those included that were done before.
  /// @param threads  to be shared out among the pieces.
  KeptWork(std::size_t pieces, int threads, StatusLine& status);

  /// Does each of `missing`; tells first how many are there already.
  /// @param kept  where what is done lies, for whoever interrupts.
  /// @throws what a piece throws; Failure when somebody ends it before.
  void run(const std::vector<std::size_t>& missing, const std::filesystem::path& kept,
           const std::function<void(std::size_t)>& piece);

  [[nodiscard]] std::size_t atOnce() const { return at_once_; }
  [[nodiscard]] int threadsEach() const { return threads_each_; }
  [[nodiscard]] bool ends() const;

  /// Of a piece under way: one of them is shown, and all are ended where somebody asks for it.
  [[nodiscard]] LabProgress progressOf(std::size_t index, std::string title);

  /// Calls `keep`, one piece at a time, and prints what it says of the piece.
  void finish(std::size_t index, const std::function<std::string()>& keep);

 private:
  std::size_t pieces_, done_ = 0, at_once_ = 1;
  int threads_, threads_each_;
  StatusLine& status_;
  std::mutex mutex_;
  std::set<std::size_t> running_;
  std::atomic<bool> gives_up_ = false;
};

}  // namespace haptolith

#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace hand_in_the_loop {

/// A child that dies with its parent, and whose output goes to a file.
class Program {
 public:
  Program(const std::vector<std::string>& command, const std::string& folder, const std::string& log);
  /// Kills it if it is still there.
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void signal(int number) const;
  /// Its exit status once it has ended; 128 + n: it died of signal n.
  [[nodiscard]] std::optional<int> ended();

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
};

}  // namespace hand_in_the_loop

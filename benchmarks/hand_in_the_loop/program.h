#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace hand_in_the_loop {

/// Child process that ends with its parent; its output is written to a file.
class Program {
 public:
  Program(const std::vector<std::string>& command, const std::string& folder, const std::string& log);
  /// Kills the process if it is still running.
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void signal(int number) const;
  /// Returns the exit status after its end; 128 + n: ended by signal n.
  [[nodiscard]] std::optional<int> ended();

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
};

}  // namespace hand_in_the_loop

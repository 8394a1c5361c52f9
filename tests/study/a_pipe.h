#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <optional>
#include <vector>

namespace haptolith {

/// Messages of a child: it writes a number only after the call has returned.
class Pipe {
 public:
  Pipe() { EXPECT_EQ(pipe(ends_.data()), 0); }
  ~Pipe() {
    close(ends_[0]);
    closeWriting();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  void tell(int number) const { EXPECT_EQ(write(ends_[1], &number, sizeof(number)), ssize_t{sizeof(number)}); }
  void closeWriting() {
    if (ends_[1] >= 0) {
      close(ends_[1]);
      ends_[1] = -1;
    }
  }
  /// Waits for the next number; empty when the writer is gone.
  [[nodiscard]] std::optional<int> listen() const {
    int number = 0;
    return read(ends_[0], &number, sizeof(number)) == ssize_t{sizeof(number)} ? std::optional(number) : std::nullopt;
  }
  [[nodiscard]] std::vector<int> told() const {
    std::vector<int> numbers;
    while (const std::optional<int> number = listen()) {
      numbers.push_back(*number);
    }
    return numbers;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

}  // namespace haptolith

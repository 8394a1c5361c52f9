#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// Two blocks, in both orders; a form with a personal item.
inline const std::string kTwoBlocks = R"toml(
title = "A study"
order = "latin-square"
[[demographics]]
key = "name"
label = "Name"
personal = true
[[demographics]]
key = "age"
label = "Age"
kind = "number"
low = 18
high = 99
required = true
[[block]]
name = "friction"
question = "Was the second more resistant?"
answers = ["less", "more"]
varies = "preset"
reference = "P3"
levels = ["P1", "P2", "P4", "P5", "P6"]
[[block]]
name = "gravity"
question = "Was the second heavier?"
answers = ["lighter", "heavier"]
varies = "body"
reference = "Moon"
levels = ["Ceres", "Pluto", "Europa", "Mars", "Earth"]
log_axis = true
)toml";

/// A study of kTwoBlocks in a separate folder.
class AStudy : public testing::Test {
 public:
  ~AStudy() override { std::filesystem::remove_all(folder_); }

 protected:
  AStudy() : folder_(std::filesystem::path(testing::TempDir()) / fmt::format("haptolith_study_{}", getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    file_ = folder_ / "a.study";
    StudyStore::create(file_, loadProtocolText(kTwoBlocks, "two.toml"), kTwoBlocks, 42);
  }

  /// The `index`-th trial of the first block.
  static TrialBegun trial(std::int64_t participant, int index, int attempt = 0) {
    return {.participant = participant,
            .block = 0,
            .position = 1,
            .index = index,
            .attempt = attempt,
            .kind = TrialKind::kMain,
            .block_name = "friction",
            .level = "P1",
            .reference = "P3",
            .value = 1.21,
            .reference_value = 0.835,
            .test_first = index % 2 == 1,
            .seed = (std::uint64_t{1} << 53) - 1,
            .recording = "S01-friction"};
  }

  static TrialAnswer answer(double reaction_s) {
    TrialAnswer answer{.positive = true, .correct = true, .reaction_s = reaction_s};
    answer.summaries[0].duration_s = 3.25;
    answer.summaries[0].peak_force_n = 7.5;
    answer.summaries[1].work_j = -0.5;
    answer.summaries[1].deadline_misses = 3;
    return answer;
  }

  std::filesystem::path folder_, file_;
};

/// The message of what `work` throws.
template <class Error, class Work>
std::string messageOf(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace haptolith

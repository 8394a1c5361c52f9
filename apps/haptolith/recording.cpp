#include "recording.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <ctime>
#include <filesystem>
#include <utility>

#include "haptolith/core/error.h"

namespace haptolith {

namespace {

/// An hour at 1 kHz, about 0.9 GB: somebody has forgotten it.
constexpr std::uint64_t kMostTicks = 3'600'000;

std::string newName() {
  const std::string stem = fmt::format("haptolith-{:%Y%m%d-%H%M%S}", fmt::localtime(std::time(nullptr)));
  std::string name = stem + ".csv";
  for (int again = 2; std::filesystem::exists(name); ++again) {
    name = fmt::format("{}-{}.csv", stem, again);
  }
  return name;
}

}  // namespace

void Recording::start() {
  stop();
  std::string name = newName();
  file_ = std::make_unique<TraceFile>(name);
  name_ = std::move(name);
  ticks_ = 0;
}

void Recording::stop() {
  name_.clear();
  if (const std::unique_ptr<TraceFile> ended = std::move(file_)) {
    ended->commit();
  }
}

void Recording::write(const TickRecord& record) {
  if (!file_) {
    return;
  }
  try {
    file_->write(record);
    if (++ticks_ >= kMostTicks) {
      spdlog::warn("the recording {} has ended: it is an hour long", name_);
      stop();
    }
  } catch (const Failure& failure) {
    spdlog::warn("the recording has ended: {}", failure.what());
    file_.reset();
    name_.clear();
  }
}

}  // namespace haptolith

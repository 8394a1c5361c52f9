#include "haptolith/recording/recording_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/start_thread.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/recording/recording_file.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostWaiting = std::size_t{64} << 20;  // bytes
constexpr std::size_t kMostWaitingForFrames = std::size_t{32}
                                              << 20;  // so that ticks, of which none may be missing, fit

// Added data waits for at most the sum of both, well below the promised half second.
constexpr auto kLookEvery = 25ms;
constexpr auto kOldest = 200ms;

}  // namespace

class RecordingWriter::Thread {
 public:
  Thread(const std::filesystem::path& path, const RecordingHeader& header, const RecordingOptions& options)
      : path_(path.string()), wait_when_full_(options.wait_when_full), robot_(options.robot) {
    std::promise<void> made;
    std::future<void> making = made.get_future();
    thread_ = startThread("the recording",
                          [&, made = std::move(made)]() mutable { work(path, header, options.overwrite, made); });
    try {
      making.get();
    } catch (...) {
      thread_.join();
      throw;
    }
  }

  void add(std::span<const TickRecord> ticks) {
    add(ticks.size_bytes(), kMostWaiting,
        [&] { waiting_.ticks.insert(waiting_.ticks.end(), ticks.begin(), ticks.end()); });
  }

  void add(const ParticleFrame& frame) {
    add(sizeof(frame) + frame.position_m.size() * sizeof(frame.position_m[0]), kMostWaitingForFrames,
        [&] { waiting_.frames.push_back(frame); });
  }

  void add(const RecordingEvent& event) {
    add(sizeof(event) + event.kind.size() + event.text.size(), kMostWaiting, [&] { waiting_.events.push_back(event); });
  }

  void add(const RobotRow& report) {
    if (robot_) {
      add(sizeof(report), kMostWaiting, [&] { waiting_.reports.push_back(report); });
    }
  }

  void add(const SiteRow& seen) {
    if (robot_) {
      add(sizeof(seen), kMostWaiting, [&] { waiting_.site.push_back(seen); });
    }
  }

  void finish(std::uint64_t lost) noexcept {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
      lost_ = std::max(lost_, lost);
    }
    changed_.notify_all();
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  [[nodiscard]] std::string problem() const {
    const std::lock_guard lock(mutex_);
    return problem_;
  }

  [[nodiscard]] Written written() const {
    const std::lock_guard lock(mutex_);
    return written_;
  }

  [[nodiscard]] std::uint64_t framesLeftOut() const {
    const std::lock_guard lock(mutex_);
    return left_out_;
  }

 private:
  /// Lets `copy` put something into the batch that waits, when there is room.
  template <class Copy>
  void add(std::size_t bytes, std::size_t most, Copy copy) {
    std::unique_lock lock(mutex_);
    const auto has_room = [&] { return !takes() || waiting_bytes_ == 0 || waiting_bytes_ + bytes <= most; };
    if (wait_when_full_) {
      changed_.wait(lock, has_room);
    }
    if (!takes()) {
      return;
    }
    if (has_room()) {
      copy();
      waiting_bytes_ += bytes;
    } else if (most == kMostWaitingForFrames) {
      ++left_out_;
    } else {
      stop(fmt::format("the disk is too slow: {} MiB are waiting to be written", waiting_bytes_ >> 20));
    }
  }

  /// With the lock held.
  void count(const hdf5::RecordingFile& file) {
    written_ = {.ticks = file.ticks(),
                .frames = file.frames(),
                .events = file.events(),
                .bytes = file.bytes(),
                .missing = file.missing()};
  }

  [[nodiscard]] bool takes() const noexcept { return problem_.empty() && !ending_; }

  /// With the lock held.
  void stop(const std::string& why) {
    if (problem_.empty()) {
      problem_ = fmt::format("the recording {} has ended: {}; it contains {}, {} of the particles and {}", path_, why,
                             pluralise(written_.ticks, "tick"), pluralise(written_.frames, "frame"),
                             pluralise(written_.events, "event"));
    }
    waiting_ = {};
    waiting_bytes_ = 0;
    changed_.notify_all();
  }

  void work(const std::filesystem::path& path, const RecordingHeader& header, bool overwrite,
            std::promise<void>& made) {
    std::unique_ptr<hdf5::RecordingFile> file;
    try {
      file = std::make_unique<hdf5::RecordingFile>(path, header, overwrite, robot_);
      made.set_value();
    } catch (...) {
      made.set_exception(std::current_exception());
      return;
    }
    try {
      writeAll(*file);
      file->close();
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      count(*file);
      file->abandon();
      stop(error.what());
    }
  }

  /// Until the owner has no more. @throws Failure when the disk takes no more.
  void writeAll(hdf5::RecordingFile& file) {
    Clock::time_point oldest = Clock::now();  // time of the oldest data not yet in the file
    for (bool last = false; !last;) {
      hdf5::Batch batch;
      std::uint64_t lost = 0;
      {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, kLookEvery, [&] { return ending_ || !problem_.empty(); });
        last = ending_ || !problem_.empty();
        lost = lost_;
        std::swap(batch, waiting_);
        waiting_bytes_ = 0;
      }
      changed_.notify_all();
      if (!file.hasUnwritten()) {
        oldest = Clock::now() - kLookEvery;
      }
      file.take(batch);
      if (last) {
        file.countLost(lost);
      }
      if (last || Clock::now() - oldest >= kOldest) {
        file.writeAll();
      } else if (file.writeWholeChunks()) {
        oldest = Clock::now() - kLookEvery;
      }
      const std::lock_guard lock(mutex_);
      count(file);
    }
  }

  const std::string path_;
  const bool wait_when_full_, robot_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  hdf5::Batch waiting_;
  std::size_t waiting_bytes_ = 0;
  bool ending_ = false;
  std::uint64_t lost_ = 0;
  std::string problem_;
  Written written_;
  std::uint64_t left_out_ = 0;

  std::thread thread_;
};

void RecordingWriter::requireFree(const std::filesystem::path& path, bool overwrite) {
  hdf5::requireFree(path, overwrite);
}

RecordingWriter::RecordingWriter(const std::filesystem::path& path, const RecordingHeader& header,
                                 const RecordingOptions& options)
    : thread_(std::make_unique<Thread>(path, header, options)) {}

RecordingWriter::~RecordingWriter() {
  finish();
}

void RecordingWriter::add(std::span<const TickRecord> ticks) {
  thread_->add(ticks);
}

void RecordingWriter::add(const ParticleFrame& frame) {
  thread_->add(frame);
}

void RecordingWriter::add(const RecordingEvent& event) {
  thread_->add(event);
}

void RecordingWriter::add(const RobotRow& report) {
  thread_->add(report);
}

void RecordingWriter::add(const SiteRow& seen) {
  thread_->add(seen);
}

void RecordingWriter::finish(std::uint64_t lost) noexcept {
  thread_->finish(lost);
}

std::string RecordingWriter::problem() const {
  return thread_->problem();
}

RecordingWriter::Written RecordingWriter::written() const {
  return thread_->written();
}

std::uint64_t RecordingWriter::framesLeftOut() const {
  return thread_->framesLeftOut();
}

}  // namespace haptolith

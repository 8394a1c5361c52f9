// Batches: many scenes on several threads.

#include <haptolith/haptolith.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/handles.h"
#include "haptolith/c_api/scene_object.h"
#include "haptolith/core/platform/start_thread.h"

namespace haptolith::library {

/// Threads that share a set of scenes: each takes the next free one.
class Batch {
 public:
  /// @throws Failure when the system grants no thread.
  Batch(std::vector<hapto_scene*> scenes, std::vector<std::uint32_t> tools, std::size_t threads)
      : scenes_(std::move(scenes)), tools_(std::move(tools)) {
    for (const std::uint32_t own : tools_) {
      tools_before_.push_back(all_tools_);
      all_tools_ += own;
    }
    const std::size_t helpers = std::min(threads, scenes_.size()) - 1;
    try {
      for (std::size_t i = 0; i < helpers; ++i) {
        helpers_.push_back(startThread("a batch of scenes", [this] { help(); }));
      }
    } catch (...) {
      end();
      throw;
    }
  }
  ~Batch() { end(); }
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;

  struct Work {
    bool all_tools = false;  ///< poses for all tools, not only for the first of each scene
    std::uint64_t ticks = 0;
    const hapto_pose* poses = nullptr;
    const hapto_twist* twists = nullptr;
    hapto_wrench* felt = nullptr;
    std::int32_t* status = nullptr;
  };

  /// Number of tools of all scenes together.
  [[nodiscard]] std::uint64_t tools() const noexcept { return all_tools_; }

  std::int32_t step(const Work& work) {
    {
      const std::lock_guard lock(mutex_);
      work_ = work;
      next_.store(0, std::memory_order_relaxed);
      first_failure_.store(kNobody, std::memory_order_relaxed);
      working_ = helpers_.size();
      ++rounds_;
    }
    begin_.notify_all();
    takeScenes();
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return working_ == 0; });
    const std::uint64_t failure = first_failure_.load(std::memory_order_relaxed);
    return failure == kNobody ? HAPTO_OK : static_cast<std::int32_t>(failure & kStatus);
  }

 private:
  static constexpr std::uint64_t kNobody = ~std::uint64_t{0};
  static constexpr std::uint64_t kStatus = 0xFF;

  void help() {
    std::uint64_t round = 0;
    while (true) {
      {
        std::unique_lock lock(mutex_);
        begin_.wait(lock, [&] { return ended_ || rounds_ != round; });
        if (ended_) {
          return;
        }
        round = rounds_;
      }
      takeScenes();
      const std::lock_guard lock(mutex_);
      if (--working_ == 0) {
        done_.notify_one();
      }
    }
  }

  void takeScenes() noexcept {
    for (std::size_t i = next_.fetch_add(1); i < scenes_.size(); i = next_.fetch_add(1)) {
      const std::int32_t status = steps(i);
      if (work_.status != nullptr) {
        work_.status[i] = status;
      }
      if (status != HAPTO_OK) {  // the error of the first failing scene wins
        const std::uint64_t own = std::uint64_t{i} << 8U | static_cast<std::uint64_t>(status);
        std::uint64_t first = first_failure_.load(std::memory_order_relaxed);
        while (own < first && !first_failure_.compare_exchange_weak(first, own, std::memory_order_relaxed)) {
        }
      }
    }
  }

  [[nodiscard]] std::int32_t steps(std::size_t i) noexcept {
    const std::uint64_t first = work_.ticks * (work_.all_tools ? tools_before_[i] : i);
    const hapto_twist* const twists = work_.twists == nullptr ? nullptr : work_.twists + first;
    hapto_wrench* const felt = work_.felt == nullptr ? nullptr : work_.felt + first;
    return work_.all_tools
               ? hapto_scene_steps_tools(scenes_[i], work_.ticks, work_.poses + first, twists, tools_[i], felt, nullptr)
               : hapto_scene_steps(scenes_[i], work_.ticks, work_.poses + first, twists, felt, nullptr);
  }

  void end() noexcept {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    begin_.notify_all();
    for (std::thread& helper : helpers_) {
      helper.join();
    }
  }

  const std::vector<hapto_scene*> scenes_;
  const std::vector<std::uint32_t> tools_;   ///< tools of each scene
  std::vector<std::uint64_t> tools_before_;  ///< tools of the scenes before each
  std::uint64_t all_tools_ = 0;
  Work work_;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::uint64_t> first_failure_{kNobody};  ///< number of the scene and its status
  std::mutex mutex_;
  std::condition_variable begin_, done_;
  std::uint64_t rounds_ = 0;
  std::size_t working_ = 0;
  bool ended_ = false;
  std::vector<std::thread> helpers_;
};

}  // namespace haptolith::library

struct hapto_batch : haptolith::library::HandleOf<haptolith::library::Batch> {
  static constexpr std::uint32_t kKind = 0x48614261;
};

using namespace haptolith;
using namespace haptolith::library;

namespace {

std::int32_t stepped(Batch& batch, const Batch::Work& work) {
  const std::int32_t worst = batch.step(work);
  return worst == HAPTO_OK ? worst : wrongArgument(worst, "scenes");
}

}  // namespace

std::int32_t hapto_batch_create(hapto_scene* const* scenes, std::uint32_t count, std::uint32_t threads,
                                hapto_batch** out) {
  if (scenes == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, scenes == nullptr ? "scenes" : "out");
  }
  return guarded([&]() -> std::int32_t {
    constexpr Range kScenes{1, 1e6};
    constexpr Range kThreads{0, 256};
    requireInRange("count", count, kScenes);
    requireInRange("threads", threads, kThreads);
    std::vector<std::uint32_t> tools;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (const Claim claim(scenes[i]); claim.status() != HAPTO_OK) {
        return wrongArgument(claim.status(), "scenes");
      } else {
        tools.push_back(static_cast<std::uint32_t>(claim->scene().tools()));
      }
      if (std::find(scenes, scenes + i, scenes[i]) != scenes + i) {
        throw InvalidParameter("scenes", fmt::format("number {} twice", i), "each scene once");
      }
    }
    const std::size_t wanted = threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
    *out = Places<hapto_batch>::take(
        std::make_unique<Batch>(std::vector(scenes, scenes + count), std::move(tools), wanted));
    return HAPTO_OK;
  });
}

std::int32_t hapto_batch_step(hapto_batch* batch, std::uint64_t ticks, const hapto_pose* poses,
                              const hapto_twist* twists, hapto_wrench* felt, std::int32_t* status) {
  const Claim claim(batch);
  if (claim.status() != HAPTO_OK || poses == nullptr) {
    return wrongArgument(claim.status() != HAPTO_OK ? claim.status() : HAPTO_NULL,
                         claim.status() != HAPTO_OK ? "batch" : "poses");
  }
  return guarded([&] { return stepped(*claim, {false, ticks, poses, twists, felt, status}); });
}

std::int32_t hapto_batch_step_tools(hapto_batch* batch, std::uint64_t ticks, const hapto_pose* poses,
                                    const hapto_twist* twists, std::uint64_t count, hapto_wrench* felt,
                                    std::int32_t* status) {
  const Claim claim(batch);
  if (claim.status() != HAPTO_OK || poses == nullptr) {
    return wrongArgument(claim.status() != HAPTO_OK ? claim.status() : HAPTO_NULL,
                         claim.status() != HAPTO_OK ? "batch" : "poses");
  }
  return guarded([&] {
    const std::uint64_t tools = claim->tools();
    if (count % tools != 0 || count / tools != ticks) {
      return failed(HAPTO_WRONG_TOOL,
                    fmt::format("{} poses do not fit: the scenes of this batch have {} tools, so {} ticks need {}",
                                count, tools, ticks, tools * ticks),
                    "count", fmt::format("{}", count), fmt::format("{}", tools * ticks));
    }
    return stepped(*claim, {true, ticks, poses, twists, felt, status});
  });
}

std::int32_t hapto_batch_destroy(hapto_batch* batch) {
  Claim claim(batch);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "batch");
  }
  claim.destroy();
  return HAPTO_OK;
}

#pragma once

#include <functional>
#include <vector>

#include "haptolith/session/session.h"
#include "haptolith/study/results/tick_summary.h"
#include "haptolith/study/run/rig.h"

namespace haptolith {

/// Rig on a running session: a person at a device, or the virtual hand for a participant in a browser.
class SessionRig final : public Rig {
 public:
  /// Functions that write recordings; empty: no recordings.
  struct Recorder {
    std::function<void(const std::filesystem::path&)> start;
    std::function<void()> stop;
  };

  /// Keeps the tool out of the soil until feel(). @param session  started, and keeps records.
  SessionRig(Session& session, Recorder recorder);

  /// Adds all records of the loop since the last call.
  void follow(const std::vector<TickRecord>& ticks);

  /// Makes the stimulus' bed, which the session caches.
  void prepare(const StudyBlock& block, const Stimulus& stimulus) override { show(block, stimulus); }
  void show(const StudyBlock& block, const Stimulus& stimulus) override;
  [[nodiscard]] bool ready() override;
  /// As in Rig; the tool stays out of the soil in a block without force.
  void feel() override;
  TrialSummary rest() override;
  void pause() override;
  void resume() override;
  void startRecording(const std::filesystem::path& file) override;
  void stopRecording() override;
  [[nodiscard]] double force() const override;
  [[nodiscard]] std::uint32_t buttons() const override { return buttons_; }
  [[nodiscard]] bool pageMayHold() const override;
  [[nodiscard]] std::string deviceName() const override { return std::string(session_.deviceName()); }

 private:
  Session& session_;
  Recorder recorder_;
  bool feels_ = false, touches_ = true, squeezed_ = false;
  TickSummary felt_;
  std::uint32_t buttons_ = 0;
};

}  // namespace haptolith

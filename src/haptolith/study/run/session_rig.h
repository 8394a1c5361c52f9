#pragma once

#include <functional>
#include <vector>

#include "haptolith/session/session.h"
#include "haptolith/study/results/tick_summary.h"
#include "haptolith/study/run/rig.h"

namespace haptolith {

/// A study on a session that runs: a person at a device, or the virtual hand for a participant in a browser.
class SessionRig final : public Rig {
 public:
  /// Who writes recordings; without functions nothing is.
  struct Recorder {
    std::function<void(const std::filesystem::path&)> start;
    std::function<void()> stop;
  };

  /// The tool stays out of the soil until feel(). @param session  keeps records, and has been started.
  SessionRig(Session& session, Recorder recorder);

  /// Everything that the loop has recorded since the last call.
  void follow(const std::vector<TickRecord>& ticks);

  /// Makes its bed, which the session keeps.
  void prepare(const StudyBlock& block, const Stimulus& stimulus) override { show(block, stimulus); }
  void show(const StudyBlock& block, const Stimulus& stimulus) override;
  [[nodiscard]] bool ready() override;
  /// Where nothing is to be felt, the tool stays out of the soil.
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

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/protocol/button_answer.h"
#include "haptolith/study/protocol/sequence.h"
#include "haptolith/study/run/criteria.h"
#include "haptolith/study/run/rig.h"
#include "haptolith/study/run/study_steps.h"
#include "haptolith/study/store/store.h"

namespace haptolith {

/// A trial as the experimenter sees it.
struct ShownTrial {
  TrialKind kind = TrialKind::kMain;
  const StudyBlock* block = nullptr;
  const Stimulus* test = nullptr;
  bool test_first = false;
};

/// The state of the study now, for the pages that show it.
struct StudyState {
  StudyPhase phase = StudyPhase::kWaiting;
  bool paused = false;
  std::string participant = {};
  std::string group = {};  ///< which the participant is never told; empty: none, or not decided yet
  std::string title = {}, text = {};
  std::string button = {};  ///< what goes on says; empty: it cannot be gone on now
  const std::vector<FormItem>* form = nullptr;
  const StudyBlock* block = nullptr;     ///< that is under way; none between blocks
  std::size_t position = 0, blocks = 0;  ///< of the block in the participant's order
  int trial = 0, trials = 0;             ///< from 1; trials 0: the answers decide how many
  int interval = 0;                      ///< 1 or 2 while a stimulus is prepared or felt, else 0
  int soil = 0, soils = 0;               ///< before a block's first trial: which of how many is prepared; else 0
  std::optional<double> remaining_s = {};
  std::optional<bool> right = {};  ///< feedback; of work for a robot, whether it was done in time
  std::string work = {};           ///< how much of it is seen to be done; empty: there is none
  std::optional<ShownTrial> now = {}, next = {};
  std::string problem = {};
};

struct ConductorOptions {
  std::function<double()> now_s;          ///< a clock that only goes forward
  std::filesystem::path recordings = {};  ///< a folder; each trial is recorded into it when the protocol wants it
};

/// Leads one participant through a study, step by step: consent, forms, blocks of trials, breaks. Every step that is
/// done is in the store before the next begins, so that a participant who comes back after a crash continues at the
/// trial that was cut off. All calls from one thread; none waits. What a participant or an experimenter asks for and
/// may not have throws InvalidParameter with the reason. When the store or the rig fails, the study pauses with a
/// problem(), keeps what has not been written yet, and tries again on resume().
class Conductor {
 public:
  Conductor(StudyStore& store, Rig& rig, ConductorOptions options);

  /// A new participant; an empty code is the next that is free. @throws InvalidParameter for a code that is taken.
  void begin(std::string_view code);
  /// One who has not finished goes on where they were. @throws InvalidParameter when there is none with that code; an
  /// empty one is the participant who began last.
  void resumeParticipant(std::string_view code);

  /// Moves on what time, the rig and the device's buttons decide: call it a hundred times a second.
  void poll();

  [[nodiscard]] StudyState state() const;
  /// Trials of this participant, in the order in which they began.
  [[nodiscard]] const std::vector<TrialRow>& trials() const noexcept { return rows_; }
  /// At a question: what was done and felt in the two intervals.
  [[nodiscard]] std::array<TrialSummary, 2> summaries() const {
    return trial_ ? trial_->summaries : std::array<TrialSummary, 2>{};
  }
  [[nodiscard]] const StudyStore& store() const noexcept { return store_; }
  [[nodiscard]] const Rig& rig() const noexcept { return rig_; }
  [[nodiscard]] bool over() const noexcept {
    return phase_ == StudyPhase::kFinished || phase_ == StudyPhase::kWithdrawn;
  }
  /// Whether stop() has ended the participant's day.
  [[nodiscard]] bool stopped() const noexcept { return stopped_.has_value(); }
  /// Counts up whenever state() changes, other than the time that remains.
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }

  // --- what a participant does

  void proceed();  ///< agrees, has read, has felt enough, comes back from a break
  void fill(const std::map<std::string, std::string>& values);  ///< the form that is shown
  void answer(int choice);                                      ///< 0 or 1, as the block's answers stand
  void withdraw();

  // --- what an experimenter does

  void pause();
  void resume();
  /// Which trial is done once more: the one under way, or else the one answered last; or that one whatever is under
  /// way, which is then done again, too.
  enum class Again { kNow, kLast };
  /// Within its block. @param reason  not empty.
  void repeat(Again which, std::string_view reason);
  void note(std::string_view text);
  /// The same for what the program has noticed.
  void remark(std::string_view text);
  /// Ends here for today: the trial under way is done again when the participant comes back. state() then reports how
  /// far they came.
  void stop();

 private:
  struct Trial {
    PlannedTrial plan = {};
    int index = 0;
    std::int64_t id = 0;
    int interval = 0;
    std::array<TrialSummary, 2> summaries = {};
    std::string recording = {};
    bool recording_runs = false;
  };
  struct Unsaved {
    std::int64_t id = 0;
    TrialAnswer answer = {};
    bool practice = false;
  };

  void start(ParticipantRow participant);
  void planSteps();
  void assignBefore(std::size_t step);
  [[nodiscard]] const StudyStep& step() const { return steps_[step_]; }
  [[nodiscard]] const StudyBlock& block() const;
  void finishStep();
  void enterStep();
  void enter(StudyPhase phase);

  [[nodiscard]] std::optional<Trial> nextTrial() const;
  [[nodiscard]] std::optional<Trial> plannedTrial(int but) const;
  [[nodiscard]] std::optional<Trial> nextAdaptive() const;
  [[nodiscard]] std::optional<Trial> upcoming() const;
  [[nodiscard]] std::vector<const TrialRow*> answered() const;
  [[nodiscard]] BlockScores scores() const;
  [[nodiscard]] int plannedTrials() const;
  [[nodiscard]] std::vector<const Stimulus*> stimuli() const;
  void prepareSoils();
  void prepareNextSoils();
  void goToNextTrial();
  void beginTrial();
  void prepareInterval(int interval);
  void endInterval();
  void saveWhatWaits();
  void finishTrial();
  void stopRecording();
  [[nodiscard]] std::filesystem::path recordingFile(std::string_view trial, int interval) const;
  [[nodiscard]] std::string freeRecordingName(const std::string& name) const;
  void dropTrial(TrialState state, std::string_view reason);
  [[nodiscard]] bool underWay() const noexcept { return trial_.has_value() && trial_->id != 0; }
  [[nodiscard]] const Stimulus& stimulus(int interval) const;
  [[nodiscard]] double restTime() const;
  [[nodiscard]] std::optional<double> remaining() const;
  [[nodiscard]] double elapsed() const { return options_.now_s() - since_s_; }
  void readRows();
  void halt(std::string_view problem);
  template <class Work>
  void guarded(Work work);

  StudyStore& store_;
  Rig& rig_;
  ConductorOptions options_;

  std::optional<ParticipantRow> participant_;
  std::optional<StudyState> stopped_;  ///< how far the participant came until stop()
  std::vector<PlannedBlock> sequence_;
  std::vector<StudyStep> steps_;
  std::size_t step_ = 0;
  std::vector<TrialRow> rows_;

  StudyPhase phase_ = StudyPhase::kWaiting;
  double since_s_ = 0;  ///< when this phase began
  bool paused_ = false;
  std::optional<Trial> trial_;
  std::optional<Unsaved> unsaved_;
  std::optional<bool> right_;
  int since_break_ = 0;                  ///< trials
  std::optional<std::size_t> soil_;      ///< of stimuli(), that is being prepared
  std::optional<std::size_t> prepared_;  ///< place of the block whose soils are ready
  ButtonAnswer buttons_;
  std::string problem_;
  std::uint64_t changes_ = 0;
};

}  // namespace haptolith

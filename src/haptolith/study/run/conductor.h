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

/// Trial as shown to the experimenter.
struct ShownTrial {
  TrialKind kind = TrialKind::kMain;
  const StudyBlock* block = nullptr;
  const Stimulus* test = nullptr;
  bool test_first = false;
};

/// Current state of the study, for the pages.
struct StudyState {
  StudyPhase phase = StudyPhase::kWaiting;
  bool paused = false;
  std::string participant = {};
  std::string group = {};  ///< never shown to the participant; empty: no group, or not assigned yet
  std::string title = {}, text = {};
  std::string button = {};  ///< label of the button to continue; empty: continuing is not possible now
  const std::vector<FormItem>* form = nullptr;
  const StudyBlock* block = nullptr;     ///< current block; null between blocks
  std::size_t position = 0, blocks = 0;  ///< position of the block in the participant's order; number of blocks
  int trial = 0, trials = 0;             ///< counted from 1; trials 0: the number depends on the responses
  int interval = 0;                      ///< 1 or 2 while a stimulus is prepared or presented, else 0
  int soil = 0, soils = 0;               ///< before a block's first trial: number and count of prepared soils; else 0
  std::optional<double> remaining_s = {};
  std::optional<bool> right = {};  ///< feedback; for a robot's task, whether it was done in time
  std::string work = {};           ///< observed progress of the robot's task; empty: no task
  std::optional<ShownTrial> now = {}, next = {};
  std::string problem = {};
};

struct ConductorOptions {
  std::function<double()> now_s;          ///< monotonic clock
  std::filesystem::path recordings = {};  ///< folder for the recordings of trials, if the protocol enables recording
};

/// Leads one participant through a study, step by step: consent, forms, blocks of trials, breaks. Each finished step is
/// stored before the next begins, so that after a crash a participant continues at the interrupted trial. All calls
/// from one thread; none blocks. A request that is not allowed at present throws InvalidParameter with the reason. If
/// the store or the rig fails, the study pauses with a problem(), keeps unwritten data, and retries on resume().
class Conductor {
 public:
  Conductor(StudyStore& store, Rig& rig, ConductorOptions options);

  /// Begins a new participant; an empty code selects the next free one. @throws InvalidParameter for a code in use.
  void begin(std::string_view code);
  /// Resumes an unfinished participant; an empty code selects the one who began last. @throws InvalidParameter if there
  /// is no unfinished participant with this code.
  void resumeParticipant(std::string_view code);

  /// Advances the study according to time, rig and the device's buttons. To be called at about 100 Hz.
  void poll();

  [[nodiscard]] StudyState state() const;
  /// Returns the trials of this participant, in the order of their beginnings.
  [[nodiscard]] const std::vector<TrialRow>& trials() const noexcept { return rows_; }
  /// Returns the summaries of the two intervals; valid at a question.
  [[nodiscard]] std::array<TrialSummary, 2> summaries() const {
    return trial_ ? trial_->summaries : std::array<TrialSummary, 2>{};
  }
  [[nodiscard]] const StudyStore& store() const noexcept { return store_; }
  [[nodiscard]] const Rig& rig() const noexcept { return rig_; }
  [[nodiscard]] bool over() const noexcept {
    return phase_ == StudyPhase::kFinished || phase_ == StudyPhase::kWithdrawn;
  }
  /// Whether stop() has ended the participant's session.
  [[nodiscard]] bool stopped() const noexcept { return stopped_.has_value(); }
  /// Returns a counter that increases with every change of state(), except of the remaining time.
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }

  // --- actions of a participant

  void proceed();  ///< continues: after consent, instructions, an interval or a break
  void fill(const std::map<std::string, std::string>& values);  ///< answers the current form
  void answer(int choice);                                      ///< 0 or 1, index of the block's answers
  void withdraw();

  // --- actions of an experimenter

  void pause();
  void resume();
  /// Trial to be repeated. kNow: the current one, or else the last answered one. kLast: the last answered one; a
  /// current trial is then also repeated.
  enum class Again { kNow, kLast };
  /// Repeats a trial of the current block. @param reason  not empty.
  void repeat(Again which, std::string_view reason);
  void note(std::string_view text);
  /// Adds a note by the program.
  void remark(std::string_view text);
  /// Ends the participant's session. The current trial is repeated when the participant resumes; state() then reports
  /// the progress.
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
  std::optional<StudyState> stopped_;  ///< progress at stop()
  std::vector<PlannedBlock> sequence_;
  std::vector<StudyStep> steps_;
  std::size_t step_ = 0;
  std::vector<TrialRow> rows_;

  StudyPhase phase_ = StudyPhase::kWaiting;
  double since_s_ = 0;  ///< time at which this phase began
  bool paused_ = false;
  std::optional<Trial> trial_;
  std::optional<Unsaved> unsaved_;
  std::optional<bool> right_;
  int since_break_ = 0;                  ///< trials since the last break
  std::optional<std::size_t> soil_;      ///< index in stimuli() of the soil being prepared
  std::optional<std::size_t> prepared_;  ///< position of the block whose soils are ready
  ButtonAnswer buttons_;
  std::string problem_;
  std::uint64_t changes_ = 0;
};

}  // namespace haptolith

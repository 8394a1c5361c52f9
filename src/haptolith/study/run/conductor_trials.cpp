// Trials of a block: preparation of soils, selection of the next trial, and the course of a trial.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/study/results/adaptive_results.h"
#include "haptolith/study/run/conductor.h"

namespace haptolith {

namespace {

std::size_t levelOf(const StudyBlock& block, double value) {
  const auto nearer = [value](const Stimulus& a, const Stimulus& b) {
    return std::abs(a.value - value) < std::abs(b.value - value);
  };
  return static_cast<std::size_t>(std::ranges::min_element(block.levels, nearer) - block.levels.begin());
}

}  // namespace

// --- soils

/// Returns all stimuli of this block, each once.
std::vector<const Stimulus*> Conductor::stimuli() const {
  std::vector<const Stimulus*> all{&block().reference};
  for (const std::vector<Stimulus>* levels : {&block().levels, &block().practice_levels, &block().catch_levels}) {
    for (const Stimulus& level : *levels) {
      if (std::ranges::find(all, level.name, &Stimulus::name) == all.end()) {
        all.push_back(&level);
      }
    }
  }
  return all;
}

/// Prepares every bed of a block before its first trial, so that the length of a pause gives no cue about the soil.
void Conductor::prepareSoils() {
  soil_.reset();
  if (prepared_ == step().position) {
    return goToNextTrial();
  }
  enter(StudyPhase::kPreparing);
  soil_ = 0;
  rig_.prepare(block(), block().reference);
  prepareNextSoils();
}

/// Requests the next soils, until one is not ready yet.
void Conductor::prepareNextSoils() {
  const std::vector<const Stimulus*> all = stimuli();
  while (rig_.ready()) {
    ++changes_;
    if (++*soil_ == all.size()) {
      prepared_ = step().position;
      return prepareSoils();
    }
    rig_.prepare(block(), *all[*soil_]);
  }
}

// --- trials

/// Returns the answered trials of the current block, in their order.
std::vector<const TrialRow*> Conductor::answered() const {
  std::vector<const TrialRow*> done;
  for (const TrialRow& row : rows_) {
    if (row.position == step().position && row.state == TrialState::kAnswered) {
      done.push_back(&row);
    }
  }
  return done;
}

BlockScores Conductor::scores() const {
  return scoresOf(store_.protocol(), rows_, sequence_[step().position].block, participant_->id);
}

/// Returns the number of trials of the block if no further round of practice is needed.
int Conductor::plannedTrials() const {
  const int of_a_round = block().practice_trials;
  const BlockScores now = scores();
  const int practice =
      now.practice_is_over ? now.practised : (now.practised / std::max(of_a_round, 1) + 1) * of_a_round;
  return static_cast<int>(sequence_[step().position].trials.size()) - block().practice_rounds * of_a_round + practice;
}

/// Returns the next trial of this block; none if it is complete.
std::optional<Conductor::Trial> Conductor::nextTrial() const {
  return block().procedure == ProcedureKind::kConstant ? plannedTrial(-1) : nextAdaptive();
}

/// Returns the first unanswered trial of the predefined list, except the one with index `but`.
std::optional<Conductor::Trial> Conductor::plannedTrial(int but) const {
  const std::vector<const TrialRow*> done = answered();
  const std::vector<PlannedTrial>& planned = sequence_[step().position].trials;
  const bool practised = scores().practice_is_over;
  for (int index = 0; index < static_cast<int>(planned.size()); ++index) {
    if (practised && planned[static_cast<std::size_t>(index)].kind == TrialKind::kPractice) {
      continue;
    }
    if (index != but && std::ranges::none_of(done, [index](const TrialRow* row) { return row->index == index; })) {
      return Trial{.plan = planned[static_cast<std::size_t>(index)], .index = index};
    }
  }
  return std::nullopt;
}

/// Returns the trial after the current one; none if it depends on responses that are not given yet.
std::optional<Conductor::Trial> Conductor::upcoming() const {
  if (trial_ && !underWay()) {
    return trial_;
  }
  const bool another_round_may_come =
      block().practice_rounds > 1 && trial_ && trial_->plan.kind == TrialKind::kPractice;
  if (block().procedure != ProcedureKind::kConstant || another_round_may_come) {
    return std::nullopt;
  }
  return plannedTrial(trial_ ? trial_->index : -1);
}

std::optional<Conductor::Trial> Conductor::nextAdaptive() const {
  const std::vector<const TrialRow*> done = answered();
  const std::size_t number = sequence_[step().position].block;
  const std::unique_ptr<AdaptiveProcedure> procedure =
      procedureOf(block(), procedureSeed(store_.seed(), participant_->number, number));
  const bool practice_is_over = scores().practice_is_over;
  const int index = static_cast<int>(done.size());
  int practised = 0, caught = 0, main_trials = 0;
  for (const TrialRow* row : done) {
    practised += row->kind == TrialKind::kPractice ? 1 : 0;
    caught += row->kind == TrialKind::kCatch ? 1 : 0;
    if (row->kind == TrialKind::kMain) {
      ++main_trials;
      procedure->answer(row->value, row->answer->positive);
    }
  }
  for (const PlannedTrial& planned : sequence_[step().position].trials) {
    const bool practice = planned.kind == TrialKind::kPractice;
    if (practice && practice_is_over) {
      continue;
    }
    int& before = practice ? practised : caught;
    if (before-- <= 0 && (practice || planned.before_main <= main_trials)) {
      return Trial{.plan = planned, .index = index};
    }
  }
  const std::optional<double> value = procedure->next();
  if (!value) {
    return std::nullopt;
  }
  return Trial{.plan = adaptiveTrial(store_.protocol(), number, store_.seed(), participant_->number, main_trials,
                                     levelOf(block(), *value)),
               .index = index};
}

void Conductor::goToNextTrial() {
  right_.reset();
  trial_ = nextTrial();
  if (!trial_) {
    finishStep();
  } else if (block().break_every_trials > 0 && since_break_ >= block().break_every_trials) {
    enter(StudyPhase::kBreak);
  } else {
    beginTrial();
  }
}

void Conductor::beginTrial() {
  enter(StudyPhase::kPreparing);  // after a failure, the trial is begun again
  const StudyBlock& now = block();
  const Stimulus& test = testOf(now, trial_->plan);
  const auto same = [this](const TrialRow& row) {
    return row.position == step().position && row.index == trial_->index;
  };
  TrialBegun begun;
  begun.participant = participant_->id;
  begun.block = sequence_[step().position].block;
  begun.position = step().position;
  begun.index = trial_->index;
  begun.attempt = static_cast<int>(std::ranges::count_if(rows_, same));
  begun.kind = trial_->plan.kind;
  begun.block_name = now.name;
  begun.level = test.name;
  begun.reference = now.teleop ? "" : now.reference.name;
  begun.value = test.value;
  begun.reference_value = now.reference.value;
  begun.test_first = trial_->plan.test_first;
  begun.seed = trial_->plan.seed;
  if (store_.protocol().record && !options_.recordings.empty()) {
    begun.recording = trial_->recording = freeRecordingName(
        fmt::format("{}-{}-{:03}-{}", participant_->code, now.name, begun.index + 1, begun.attempt + 1));
  }
  trial_->id = store_.beginTrial(begun);
  readRows();
  prepareInterval(1);
}

std::filesystem::path Conductor::recordingFile(std::string_view trial, int interval) const {
  return options_.recordings / fmt::format("{}-{}.h5", trial, interval == 1 ? "first" : "second");
}

/// Returns `name`, or "name-2" and so on if such recordings exist, because recordings are never overwritten.
std::string Conductor::freeRecordingName(const std::string& name) const {
  const auto taken = [this](std::string_view trial) {
    return std::filesystem::exists(recordingFile(trial, 1)) || std::filesystem::exists(recordingFile(trial, 2));
  };
  std::string found = name;
  for (int next = 2; taken(found); ++next) {
    found = fmt::format("{}-{}", name, next);
  }
  return found;
}

const Stimulus& Conductor::stimulus(int interval) const {
  const bool test = (interval == 1) == trial_->plan.test_first;
  return test ? testOf(block(), trial_->plan) : block().reference;
}

void Conductor::prepareInterval(int interval) {
  trial_->interval = interval;
  enter(StudyPhase::kPreparing);
  rig_.show(block(), stimulus(interval));
}

void Conductor::endInterval() {
  const TeleopSummary work = rig_.work();
  trial_->summaries[static_cast<std::size_t>(trial_->interval - 1)] = rig_.rest();
  stopRecording();
  if (block().teleop) {
    enter(StudyPhase::kQuestion);  // not shown: the result waits in this phase until it is written
    TrialAnswer given{
        .reaction_s = std::numeric_limits<double>::quiet_NaN(), .summaries = trial_->summaries, .teleop = work};
    unsaved_ = Unsaved{trial_->id, given, trial_->plan.kind == TrialKind::kPractice};
    finishTrial();
  } else if (trial_->interval == 1) {
    prepareInterval(2);
  } else {
    enter(StudyPhase::kQuestion);
  }
}

void Conductor::stopRecording() {
  if (trial_->recording_runs) {
    trial_->recording_runs = false;
    try {
      rig_.stopRecording();
    } catch (const Failure& failure) {  // saving the response is more important
      problem_ = fmt::format("the recording of this trial is incomplete: {}", failure.what());
      store_.addNote(participant_->id, problem_, "problem");
    }
  }
}

/// Ends the current trial without a response; it is repeated.
void Conductor::dropTrial(TrialState state, std::string_view reason) {
  if (!underWay() || !isTrialPhase(phase_)) {
    return;
  }
  if (phase_ == StudyPhase::kInterval) {
    (void)rig_.rest();
    stopRecording();
  }
  store_.voidTrial(trial_->id, state, reason);
  trial_.reset();
  readRows();
}

/// Writes the pending response, if there is one. If this throws, nothing has been written and it remains pending.
void Conductor::saveWhatWaits() {
  if (unsaved_) {
    store_.answerTrial(unsaved_->id, unsaved_->answer);
    unsaved_.reset();
    trial_.reset();  // no current trial, even if the next call fails
  }
}

void Conductor::finishTrial() {
  const Unsaved done = *unsaved_;
  saveWhatWaits();
  ++since_break_;
  enter(StudyPhase::kFeedback);
  readRows();
  const bool tells = done.practice ? block().practice_feedback : block().feedback;
  if (done.answer.teleop) {
    right_ = done.answer.teleop->done == 1;
  } else if (done.answer.correct && tells) {
    right_ = done.answer.correct;
  } else {
    goToNextTrial();
  }
}

void Conductor::readRows() {
  rows_ = store_.trials(participant_->id);
  ++changes_;
}

}  // namespace haptolith

#include "haptolith/study/run/conductor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/study/protocol/groups.h"

namespace haptolith {

namespace {

constexpr double kFeedback_s = 1.5;

/// Minimum duration of an interval, so that a late press of a device's button does not end the next phase. Pages have a
/// separate guard.
constexpr double kShortestInterval_s = 0.3;

[[noreturn]] void refuse(const char* asked, const std::string& why) {
  throw RefusedAction(asked, why);
}

}  // namespace

Conductor::Conductor(StudyStore& store, Rig& rig, ConductorOptions options)
    : store_(store), rig_(rig), options_(std::move(options)) {}

// --- beginning and resuming a participant

void Conductor::begin(std::string_view code) {
  start(store_.addParticipant(code));
}

void Conductor::resumeParticipant(std::string_view code) {
  const std::vector<ParticipantRow> all = store_.participants();
  const auto wanted = [code](const ParticipantRow& row) {
    return row.state == "running" && (code.empty() || row.code == code);
  };
  const auto found = std::find_if(all.rbegin(), all.rend(), wanted);
  if (found == all.rend()) {
    refuse("participant", code.empty()
                              ? "cannot resume: no participant has an unfinished session"
                              : fmt::format("cannot resume {}: not a participant with an unfinished session", code));
  }
  for (const TrialRow& row : store_.trials(found->id)) {
    if (row.state == TrialState::kBegun) {
      store_.voidTrial(row.id, TrialState::kLost, "the program ended before the response");
    }
  }
  store_.addNote(found->id, "came back", "resume");
  start(*found);
}

void Conductor::start(ParticipantRow participant) {
  participant_ = std::move(participant);
  stopped_.reset();
  planSteps();
  prepared_.reset();
  readRows();
  const std::set<std::string> done = store_.steps(participant_->id);
  step_ = 0;
  while (step_ < steps_.size() && done.contains(steps_[step_].name)) {
    ++step_;
  }
  guarded([this] { assignBefore(step_); });
  if (step_ < steps_.size() && steps_[step_].phase == StudyPhase::kPreparing && (!done.empty() || !rows_.empty())) {
    steps_.insert(steps_.begin() + static_cast<std::ptrdiff_t>(step_), {.phase = StudyPhase::kInstructions,
                                                                        .name = {},
                                                                        .title = "Welcome back",
                                                                        .text = "You continue where you were."});
  }
  guarded([this] { enterStep(); });
}

/// Plans the steps of a participant; without a group, the steps before the assignment.
void Conductor::planSteps() {
  const StudyProtocol& protocol = store_.protocol();
  const std::optional<Assignment>& assignment = participant_->assignment;
  if (protocol.groups.empty()) {
    sequence_ = sequenceFor(protocol, store_.seed(), participant_->number);
  } else if (assignment) {
    sequence_ = sequenceIn(groupNamed(protocol, assignment->group), assignment->row, protocol, store_.seed(),
                           participant_->number);
  } else {
    sequence_.clear();
  }
  steps_ = stepsOf(protocol, sequence_);
}

/// Assigns the group before `step` if all steps that it depends on (consent, demographics with strata) are done.
void Conductor::assignBefore(std::size_t step) {
  const StudyProtocol& protocol = store_.protocol();
  const auto decides = [&protocol](const StudyStep& of) {
    const bool has_strata = of.phase == StudyPhase::kForm && !protocol.assignment.strata.empty();
    return of.phase == StudyPhase::kConsent || (has_strata && of.form == &protocol.demographics);
  };
  const auto from = steps_.begin() + static_cast<std::ptrdiff_t>(step);
  if (!protocol.groups.empty() && !participant_->assignment && std::none_of(from, steps_.end(), decides)) {
    participant_->assignment = store_.assignGroup(participant_->id);
    planSteps();
  }
}

const StudyBlock& Conductor::block() const {
  return store_.protocol().blocks[sequence_[step().position].block];
}

void Conductor::enter(StudyPhase phase) {
  phase_ = phase;
  since_s_ = options_.now_s();
  buttons_.ask();
  ++changes_;
}

void Conductor::enterStep() {
  assignBefore(step_);
  if (step_ == steps_.size()) {
    store_.endParticipant(participant_->id, "finished");
    enter(StudyPhase::kFinished);
  } else if (step().phase == StudyPhase::kPreparing) {
    since_break_ = 0;
    prepareSoils();
  } else {
    enter(step().phase);
  }
}

void Conductor::finishStep() {
  if (step().phase == StudyPhase::kConsent) {
    store_.giveConsent(participant_->id);
  }
  if (!step().name.empty()) {
    store_.markStep(participant_->id, step().name);
  }
  assignBefore(step_ + 1);
  ++step_;
  enterStep();
}

// --- time

void Conductor::poll() {
  if (!participant_ || paused_ || over()) {
    return;
  }
  guarded([this] {
    const std::optional<double> left_s = remaining();
    const std::optional<int> pressed = buttons_.step(rig_.buttons(), options_.now_s());
    switch (phase_) {
      case StudyPhase::kPreparing:
        if (soil_) {
          prepareNextSoils();
        } else if (underWay() && rig_.ready() && elapsed() >= restTime()) {
          if (!trial_->recording.empty()) {
            rig_.startRecording(recordingFile(trial_->recording, trial_->interval));
            trial_->recording_runs = true;
          }
          rig_.feel();
          enter(StudyPhase::kInterval);
        }
        break;
      case StudyPhase::kInterval:
        if ((block().teleop && rig_.workIsDone()) || (left_s && *left_s <= 0) ||
            (pressed && !block().teleop && elapsed() > kShortestInterval_s)) {
          endInterval();
        }
        break;
      case StudyPhase::kQuestion:
        if (pressed) {
          answer(*pressed);
        } else if (left_s && *left_s <= 0) {
          dropTrial(TrialState::kLost, fmt::format("no response within {:g} s", block().answer_limit_s));
          goToNextTrial();
        }
        break;
      case StudyPhase::kFeedback:
        if (elapsed() >= kFeedback_s) {
          goToNextTrial();
        }
        break;
      default: break;
    }
  });
}

/// Returns the pause of the hand before the prepared interval, in s.
double Conductor::restTime() const {
  return trial_->interval == 2 ? block().between_intervals_s : block().between_trials_s;
}

std::optional<double> Conductor::remaining() const {
  double limit_s = 0;
  if (phase_ == StudyPhase::kInterval) {
    limit_s = block().interval_s;
  } else if (phase_ == StudyPhase::kQuestion) {
    limit_s = block().answer_limit_s;
  } else if (phase_ == StudyPhase::kBreak) {
    limit_s = block().break_s;
  }
  return limit_s > 0 ? std::optional(std::max(0.0, limit_s - elapsed())) : std::nullopt;
}

/// Runs `work`; on failure pauses the study and reports the reason.
template <class Work>
void Conductor::guarded(Work work) {
  try {
    work();
  } catch (const InvalidParameter& error) {
    halt(error.what());
  } catch (const std::runtime_error& error) {  // a Failure, or no thread for a bed or a recording
    halt(error.what());
  } catch (const std::bad_alloc& error) {
    halt(error.what());
  }
}

void Conductor::halt(std::string_view problem) {
  problem_ = problem;
  paused_ = true;
  ++changes_;
  rig_.pause();
}

// --- actions of a participant

void Conductor::proceed() {
  if (paused_) {
    refuse("go", "cannot continue: the study is paused");
  }
  switch (phase_) {
    case StudyPhase::kConsent:
    case StudyPhase::kInstructions: return guarded([this] { finishStep(); });
    case StudyPhase::kInterval:
      if (block().teleop) {
        refuse("go", "cannot continue: the task ends when its goal is reached or its time is over");
      }
      return guarded([this] { endInterval(); });
    case StudyPhase::kBreak:
      if (remaining().value_or(0) > 0) {
        refuse("go", fmt::format("cannot continue: the break lasts another {:.0f} s", std::ceil(*remaining())));
      }
      since_break_ = 0;
      return guarded([this] { beginTrial(); });
    default: refuse("go", "\"Continue\" is not available now");
  }
}

void Conductor::fill(const std::map<std::string, std::string>& values) {
  if (paused_ || phase_ != StudyPhase::kForm) {
    refuse("fill", "no form is open");
  }
  // The store and its exports identify a form by its block, independent of its position in this participant's order.
  const std::string& form = step().of_block ? block().name : step().name;
  store_.setAnswers(participant_->id, form, *step().form, values);  // throws for invalid values
  guarded([this] { finishStep(); });
}

void Conductor::answer(int choice) {
  if (paused_ || phase_ != StudyPhase::kQuestion || unsaved_) {
    refuse("answer", "no question is open");
  }
  if (choice != 0 && choice != 1) {
    throw InvalidParameter("choice", fmt::format("{}", choice), "0 or 1");
  }
  const Stimulus& test = testOf(block(), trial_->plan);
  TrialAnswer given;
  given.positive = (choice == 1) != trial_->plan.test_first;
  if (test.value != block().reference.value) {
    given.correct = given.positive == (test.value > block().reference.value);
  }
  given.reaction_s = elapsed();
  given.summaries = trial_->summaries;
  unsaved_ = Unsaved{trial_->id, given, trial_->plan.kind == TrialKind::kPractice};
  guarded([this] { finishTrial(); });
}

void Conductor::withdraw() {
  if (!participant_ || over()) {
    refuse("quit", "cannot quit: no session is running");
  }
  guarded([this] {
    saveWhatWaits();
    dropTrial(TrialState::kLost, "the participant withdrew");
    store_.endParticipant(participant_->id, "withdrawn");
    problem_.clear();
    if (paused_) {
      paused_ = false;
      rig_.resume();
    }
    enter(StudyPhase::kWithdrawn);
  });
}

// --- actions of an experimenter

void Conductor::pause() {
  if (!participant_ || paused_ || over()) {
    refuse("pause", paused_ ? "the study is already paused" : "cannot pause: no session is running");
  }
  guarded([this] {
    dropTrial(TrialState::kRepeated, "paused");
    store_.addNote(participant_->id, "", "pause");
  });
  paused_ = true;
  ++changes_;
  rig_.pause();
}

void Conductor::resume() {
  if (!paused_) {
    refuse("resume", "cannot resume: the study is not paused");
  }
  problem_.clear();
  paused_ = false;
  ++changes_;
  rig_.resume();
  guarded([this] {
    if (unsaved_) {
      finishTrial();
      return;
    }
    store_.addNote(participant_->id, "", "resume");
    if (underWay()) {
      dropTrial(TrialState::kLost, "something failed");
    }
    if (isTrialPhase(phase_) || phase_ == StudyPhase::kWaiting || step_ == steps_.size()) {
      enterStep();
    }
  });
}

void Conductor::repeat(Again which, std::string_view reason) {
  if (reason.empty()) {
    refuse("reason", "the reason is missing: enter a text");
  }
  if (!participant_ || over() || unsaved_ || step_ == steps_.size() || step().phase != StudyPhase::kPreparing) {
    refuse("repeat", "cannot repeat a trial: no block is running");
  }
  guarded([this, which, reason] {
    const bool under_way = underWay() && isTrialPhase(phase_);
    if (which == Again::kLast || !under_way) {
      dropTrial(TrialState::kLost, "the one before it is repeated");
      if (const auto done = answered(); !done.empty()) {
        store_.voidTrial(done.back()->id, TrialState::kRepeated, reason);
        readRows();
      }
    } else {
      dropTrial(TrialState::kRepeated, reason);
    }
    if (!paused_ && !soil_) {
      goToNextTrial();
    }
  });
}

void Conductor::note(std::string_view text) {
  if (text.empty()) {
    refuse("text", "the note is empty: enter a text");
  }
  store_.addNote(participant_ ? participant_->id : 0, text, "note");
  ++changes_;
}

void Conductor::remark(std::string_view text) {
  guarded([this, text] {
    store_.addNote(participant_ ? participant_->id : 0, text, "program");
    ++changes_;
  });
}

void Conductor::stop() {
  if (participant_ && !over()) {
    guarded([this] {
      saveWhatWaits();
      dropTrial(TrialState::kLost, "stopped for today");
      store_.addNote(participant_->id, "stopped for today", "stop");
    });
  }
  if (participant_) {
    const StudyState far = state();
    stopped_ = StudyState{.phase = over() ? phase_ : StudyPhase::kStopped,
                          .participant = far.participant,
                          .group = far.group,
                          .title = far.title,
                          .text = over() ? far.text : "",
                          .position = far.position,
                          .blocks = far.blocks,
                          .trial = std::max(0, far.trial - (phase_ == StudyPhase::kFeedback ? 0 : 1)),
                          .trials = far.trials};
  }
  participant_.reset();
  trial_.reset();
  paused_ = false;
  enter(StudyPhase::kWaiting);
}

// --- state

StudyState Conductor::state() const {
  if (stopped_) {
    return *stopped_;
  }
  StudyState now;
  now.phase = phase_;
  now.paused = paused_;
  now.problem = problem_;
  now.title = store_.protocol().title;
  now.blocks = sequence_.size();
  if (!participant_) {
    return now;
  }
  now.participant = participant_->code;
  now.group = participant_->assignment ? participant_->assignment->group : "";
  if (phase_ == StudyPhase::kFinished || phase_ == StudyPhase::kWithdrawn || step_ == steps_.size()) {
    now.text = phase_ == StudyPhase::kFinished ? store_.protocol().thanks : "";
    now.position = sequence_.size();
    return now;
  }
  now.title = step().title;
  now.text = step().text;
  now.form = phase_ == StudyPhase::kForm ? step().form : nullptr;
  now.position = step().position;
  now.remaining_s = remaining();
  now.right = right_;
  if (step().of_block) {
    now.block = &block();
  }
  if (step().phase == StudyPhase::kPreparing) {
    const bool known = block().procedure == ProcedureKind::kConstant;
    now.trials = known ? plannedTrials() : 0;
    if (soil_) {
      now.soils = static_cast<int>(stimuli().size());
      now.soil = static_cast<int>(*soil_) + 1;
    }
    now.trial = static_cast<int>(answered().size()) + (phase_ == StudyPhase::kFeedback ? 0 : 1);
    const auto shown = [this](const Trial& trial) {
      return ShownTrial{trial.plan.kind, &block(), &testOf(block(), trial.plan), trial.plan.test_first};
    };
    if (underWay()) {
      now.now = shown(*trial_);
      now.interval = phase_ == StudyPhase::kPreparing || phase_ == StudyPhase::kInterval ? trial_->interval : 0;
    }
    if (const std::optional<Trial> next = upcoming()) {
      now.next = shown(*next);
    }
  }
  switch (phase_) {
    case StudyPhase::kConsent: now.button = "I agree and take part"; break;
    case StudyPhase::kInstructions: now.button = "Continue"; break;
    case StudyPhase::kInterval:
      now.button = block().teleop ? "" : now.interval == 1 ? "I am done" : "I am done: answer";
      now.work = block().teleop ? rig_.workText() : "";
      break;
    case StudyPhase::kBreak: now.button = now.remaining_s.value_or(0) > 0 ? "" : "Continue"; break;
    default: break;
  }
  return now;
}

}  // namespace haptolith

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/session/session.h"
#include "haptolith/study/run/conductor.h"
#include "haptolith/study/run/criteria.h"
#include "haptolith/study/run/simulated_participant.h"
#include "haptolith/study/run/study_pages.h"
#include "haptolith/study/store/provenance.h"
#include "haptolith/study/store/study_files.h"
#include "haptolith/teleop/operator/learning_model.h"
#include "haptolith/viewer/live_view.h"

#include "commands.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/scene_options.h"
#include "shared/session_driver.h"
#include "shared/stop_on_signal.h"
#include "shared/web_options.h"
#include "study/teleop_rig.h"
#include "teleop/operator_report.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

constexpr const char* kStudyRunExamples = R"(Examples:
  haptolith study new friction.study --protocol icra2021-friction
  haptolith study run friction.study                            the next participant, with the mouse
  haptolith study run try.study --trial-run                     try a built-in protocol yourself
  haptolith study run friction.study --device force-dimension   with a haptic device
  haptolith study resume friction.study                         continue an interrupted session

The command prints two addresses: the page of the participant and the page of the experimenter.
Ctrl-C interrupts the session; no responses are lost.)";

struct StudyRunOptions {
  std::string file, participant;
  bool resumes = false, trial_run = false;
  DeviceOptions device;
  WebOptions web;
  double frames_per_s = 0;
};

bool works(const StudyProtocol& protocol) {
  return std::ranges::any_of(protocol.blocks, [](const StudyBlock& block) { return block.teleop.has_value(); });
}

bool learns(const StudyProtocol& protocol) {
  return std::ranges::any_of(protocol.blocks, [](const StudyBlock& block) {
    return block.teleop && block.teleop->force == TeleopForce::kLearning;
  });
}

SceneFile sceneFor(const StudyRunOptions& options, const StudyProtocol& protocol) {
  if (!options.resumes && !options.trial_run) {
    requireFilledIn(protocol);
  }
  SceneFile scene = learns(protocol) ? readyToLearn(protocol.scene) : protocol.scene;
  options.device.applyTo(scene.device);
  scene.hand.motion = HandMotion::kStill;  // without a device the participant moves it
  scene.loop.duration_s = 0;
  scene.loop.real_time = true;
  validate(scene);
  return scene;
}

/// Checks that no earlier participant is unfinished, and that participants are not mixed with simulated ones.
void requireRoom(const StudyStore& store, const StudyRunOptions& options) {
  if (options.participant.starts_with(kSimulatedCode)) {
    throw InvalidParameter("participant", options.participant,
                           fmt::format("a code that does not begin with {}", kSimulatedCode));
  }
  for (const ParticipantRow& row : store.participants()) {
    if (row.code.starts_with(kSimulatedCode)) {
      throw Failure(fmt::format("{} contains simulated responses: use another study file", options.file));
    }
    if (row.state == "running" && options.participant.empty()) {
      throw Failure(
          fmt::format("{} has not finished: continue with 'haptolith study resume {}', or name another participant "
                      "with --participant",
                      row.code, options.file));
    }
  }
}

/// Connects the view with the study's pages, for the lifetime of the pages.
LiveView::Extension extensionOf(StudyPages& pages) {
  return {
      .handle =
          [&pages](std::uint32_t client, std::string_view message) {
            pages.handleMessages(client, message);
            return std::string();
          },
      .joined =
          [&pages](std::uint32_t client, std::size_t entrance) {
            pages.join(client, entrance == kExperimenters ? StudyRole::kExperimenter : StudyRole::kParticipant);
          },
      .left = [&pages](std::uint32_t client) { pages.leave(client); },
      .refuse =
          [&pages](std::uint32_t client, const Command& asked) {
            using Wish = StudyPages::Wish;
            const bool looks =
                std::holds_alternative<command::Colour>(asked) || std::holds_alternative<command::Release>(asked);
            const auto* hold = std::get_if<command::Hold>(&asked);
            if (hold != nullptr && hold->tool) {
              return std::string("a study's pages hold the first tool");
            }
            return pages.refusal(client, looks ? Wish::kLook : hold != nullptr ? Wish::kHoldTool : Wish::kChangeScene);
          }};
}

/// Study with its scene and pages, from the first page to the end.
class StudyRun {
 public:
  StudyRun(const StudyRunOptions& options, const WebServerOptions& web)
      : options_(options),
        store_(options.file, StudyStore::Access::kRun),
        recording_(recordingFor(options.frames_per_s, works(store_.protocol()))),
        session_(sceneFor(options, store_.protocol()), true, settlingIn(status_)),
        rig_(session_, recording_,
             {.start = [this](const std::filesystem::path& file) { recording_.start(session_, file.string(), false); },
              .stop = [this] { stopRecording(); }}),
        conductor_(store_, rig_, {.now_s = &StudyRun::now, .recordings = recordings()}),
        pages_(conductor_),
        view_(session_, web, HAPTOLITH_VERSION, {}, extensionOf(pages_)) {
    status_.clear();
  }

  void run() {
    begin();
    RecordTaker taker(session_.loop(), recording_, RecordTaker::Keep::kForTake, true);
    session_.start(stopAsked());
    if (const std::string& advice = session_.realTime().advice; !advice.empty()) {
      spdlog::warn("{}", advice);
    }
    SessionDriver driver(session_, recording_, status_, &view_, &taker);
    driver.run(
        [&](const SessionDriver::News& news) {
          rig_.follow(news.ticks);
          if (!news.trip.empty()) {
            conductor_.remark(news.trip);
          }
          tellOfLost(taker.lost());
          conductor_.poll();
          showRobot();
          showPages();
          showStatus();
          return !stopAsked() && !conductor_.stopped();
        },
        4ms);
    finish();
    driver.tellTheRest();
  }

 private:
  static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  [[nodiscard]] std::filesystem::path recordings() const {
    if (!store_.protocol().record) {
      return {};
    }
    std::filesystem::path folder = recordingsFolder(options_.file);
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
      throw Failure(fmt::format("cannot make {}: {}", folder.string(), error.message()));
    }
    return folder;
  }

  /// @throws Failure also if it has already ended.
  void stopRecording() {
    recording_.stop();
    if (!recording_.problem().empty()) {
      throw Failure(recording_.problem());
    }
  }

  /// Reports lost ticks. Recordings report theirs; the force summary of a trial would also lack these ticks.
  void tellOfLost(std::uint64_t lost) {
    if (lost > told_lost_) {
      const std::string text =
          fmt::format("the program was interrupted: {} missing", pluralise(lost - told_lost_, "tick is", "ticks are"));
      told_lost_ = lost;
      spdlog::warn("{}", text);
      conductor_.remark(text);
    }
  }

  void begin() {
    if (options_.resumes) {
      conductor_.resumeParticipant(options_.participant);
    } else {
      requireRoom(store_, options_);
      if (const int enough = store_.protocol().planned_participants;
          enough > 0 && finishedParticipants(store_.participants()) >= enough) {
        spdlog::warn("the protocol ends the study after {}, and this number has finished",
                     pluralise(enough, "participant"));
      }
      conductor_.begin(options_.participant);
    }
    code_ = conductor_.state().participant;
    beginSession();
    printNotice(
        fmt::format("{} participates\n  participant's page   {}&study=participant{}\n  experimenter's page  "
                    "{}&study=experimenter\n",
                    code_, view_.url(kParticipants), languageInAddress(), view_.url(kExperimenters)));
  }

  /// Selects the words of the participant's page; English needs none.
  [[nodiscard]] std::string languageInAddress() const {
    const std::string& language = store_.protocol().language;
    const bool is_tag = std::ranges::all_of(language, [](unsigned char c) { return std::isalnum(c) != 0 || c == '-'; });
    return language == "en" || !is_tag ? "" : "&lang=" + language;
  }

  void beginSession() {
    const std::vector<ParticipantRow> all = store_.participants();
    const auto participant = std::ranges::find(all, code_, &ParticipantRow::code);
    recorded_session_ = store_.beginSession(
        participant->id,
        {.kind = options_.resumes ? "resume" : "run",
         .program_version = HAPTOLITH_VERSION,
         .device = fmt::format("{} ({})", session_.deviceName(), wordFor(kDeviceWords, session_.shown().device.kind)),
         .machine = thisMachine(),
         .loop_rate_hz = 1 / session_.shown().loop.tick_s});
  }

  void endSession() {
    const LoopStatistics& counted = session_.loop().statistics();
    store_.endSession(recorded_session_, SessionCounts{.ticks = counted.ticks(),
                                                       .missed_ticks = counted.deadlineMisses(),
                                                       .safety_trips = session_.snapshot().trips});
  }

  /// Shows the robot's state without the learned soil, which would reveal the condition to the participant.
  void showRobot() {
    std::optional<RobotShown> shown;
    if (rig_.lead() != nullptr) {
      shown = robotShown(*rig_.lead());
      shown->learned.reset();
    }
    view_.setRobot(std::move(shown));
  }

  void showPages() {
    const StudyPages::News news = pages_.news(rig_.force());
    if (news.lets_go) {
      view_.releaseTools();
    }
    if (!news.problem.empty()) {
      spdlog::warn("the experimenter's page is not updated: {}", news.problem);
    }
    for (const auto& [client, message] : news.messages) {
      view_.send(client, message);
    }
  }

  void showStatus() {
    if (!status_.visible()) {
      return;
    }
    const StudyState now = conductor_.state();
    status_.update(fmt::format("{}  block {} of {}  trial {}{}  {}{:.2f} N", now.participant,
                               std::min(now.position + 1, now.blocks), now.blocks, now.trial,
                               now.trials > 0 ? fmt::format(" of {}", now.trials) : "", now.paused ? "PAUSED  " : "",
                               rig_.force()));
  }

  /// Shows the end of the session on the pages; they then close their connections.
  void sayGoodbye() {
    showPages();
    for (int i = 0; i < 100 && view_.clients() > 0; ++i) {
      std::this_thread::sleep_for(10ms);
    }
  }

  void finish() {
    status_.clear();
    const bool over = conductor_.over();
    conductor_.stop();
    sayGoodbye();
    stopAsked() = true;
    const LoopEnd end = session_.join();
    session_.update();
    endSession();
    std::size_t responses = 0;
    for (const TrialRow& row : store_.trials()) {
      responses += row.state == TrialState::kAnswered ? 1 : 0;
    }
    printText(fmt::format("{}: {} in {}\n", store_.title(), pluralise(responses, "response"), options_.file));
    if (!over) {
      printText(fmt::format("{} continues with: haptolith study resume {}\n", code_, options_.file));
    }
    if (end != LoopEnd::kStopped) {
      throw Failure(fmt::format("the scene has ended: {}", text(end)));
    }
  }

  const StudyRunOptions& options_;
  StudyStore store_;
  StatusLine status_;
  SessionRecording recording_;
  Session session_;
  TeleopRig rig_;
  Conductor conductor_;
  StudyPages pages_;
  LiveView view_;
  std::uint64_t told_lost_ = 0;
  std::string code_;
  std::int64_t recorded_session_ = 0;  ///< id in the store
};

void addRunOptions(CLI::App& command, const std::shared_ptr<StudyRunOptions>& options) {
  command.footer(kStudyRunExamples);
  command.add_option("study", options->file, "Study file (haptolith study new)")->required()->option_text("FILE");
  options->device.addTo(command);
  command.add_option("--record-frames", options->frames_per_s, "Recorded frames of all particles per second [0]")
      ->check(numberIn({0, 60}))
      ->option_text("N");
  options->web.addToStudy(command);
  command.callback([options] {
    const StopOnSignal stop_on_signal;
    makeNewFilesPrivate();  // only the experimenter may read recordings of participants
    StudyRun(*options, options->web.forStudy()).run();
  });
}

}  // namespace

void addStudyRunCommands(CLI::App& study) {
  const auto run_options = std::make_shared<StudyRunOptions>();
  CLI::App* run = study.add_subcommand("run", "Run a study with the next participant, in the browser");
  run->add_option("--participant", run_options->participant, "Code of the participant [the next of S01, S02, ...]")
      ->option_text("CODE");
  run->add_flag("--trial-run", run_options->trial_run,
                "Try the study without participants; the consent page can have text in [BRACKETS]");
  addRunOptions(*run, run_options);
  const auto resume_options = std::make_shared<StudyRunOptions>();
  resume_options->resumes = true;
  CLI::App* resume = study.add_subcommand("resume", "Continue an interrupted session of a participant");
  resume
      ->add_option("--participant", resume_options->participant,
                   "Code of the participant [the one that has not finished]")
      ->option_text("CODE");
  addRunOptions(*resume, resume_options);
}

}  // namespace haptolith

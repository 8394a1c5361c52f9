#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/recording/replay.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/progress.h"
#include "shared/scene_options.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kReplayExamples = R"(Examples:
  haptolith run --record run.h5 --duration-s 60     make a recording
  haptolith replay run.h5                           replay it
  haptolith replay run.h5 --verify --threads 2      check that every tick is bit-identical
  haptolith replay run.h5 --verify --until-s 12     check the first 12 s

Exit status: 1 when --verify finds a difference or ticks are missing in the recording.)";

struct ReplayOptions {
  std::string file;
  bool verify = false, json = false;
  std::optional<int> threads;
  std::optional<double> until_s;
};

/// Which particles of the next frame differ, and by how much.
std::string particlesText(const ReplayDifference& difference) {
  if (!difference.frame) {
    return "  particles  unknown: no frame within 1 s after it\n";
  }
  const ComparedFrame& frame = *difference.frame;
  if (frame.different == 0) {
    return fmt::format("  particles  all equal in the next frame, at {:.3f} s\n", frame.time_s);
  }
  return fmt::format("  particles  {} in the frame at {:.3f} s, the first number {}, {:.3g} m away\n",
                     pluralise(frame.different, "differs", "differ"), frame.time_s, frame.particle, frame.distance_m);
}

std::string gapText(const ReplayGap& gap) {
  return gap.ticks == 0 ? fmt::format("the ticks after {:.3f} s are not in order", gap.time_s)
                        : fmt::format("{} after {:.3f} s: later ticks cannot be replayed", pluralise(gap.ticks, "tick"),
                                      gap.time_s);
}

std::string summary(const ReplayOptions& options, const RecordingReader& recording, const Replay& replay,
                    const ReplayResult& result) {
  const int threads = replay.sceneFile().bed.threads;
  std::string text =
      fmt::format("{}\n  replayed   {} of {}, {} and {} compared ({}, {})\n", replay.sceneFile().title, result.ticks,
                  pluralise(recording.ticks(), "tick"), pluralise(result.hashes, "hash", "hashes"),
                  pluralise(result.frames, "frame"), instructionSetName(simdTarget()), pluralise(threads, "thread"));
  if (result.difference) {
    text += fmt::format("  differs    in tick {} at {:.3f} s: {}\n", result.difference->tick, result.difference->time_s,
                        result.difference->what);
    text += particlesText(*result.difference);
  } else if (result.gap) {
    text += fmt::format("  missing    {}\n", gapText(*result.gap));
  } else if (options.verify) {
    text +=
        "  verified   hashes, tool pose, wrenches, energy, trips and flags of every tick, and frames, bit-identical\n";
  }
  if (!result.end.empty()) {
    text += fmt::format("  end        as recorded, {}\n", result.end);
  }
  return text + (result.ended_early.empty() ? "" : fmt::format("  ended      {}\n", result.ended_early));
}

Json summaryJson(const RecordingReader& recording, const Replay& replay, const ReplayResult& result) {
  Json difference;
  if (result.difference) {
    difference = {
        {"tick", result.difference->tick}, {"time_s", result.difference->time_s}, {"what", result.difference->what}};
    if (const std::optional<ComparedFrame>& frame = result.difference->frame) {
      difference["frame_s"] = frame->time_s;
      difference["different_particles"] = frame->different;
      difference["first_particle"] = frame->different > 0 ? Json(frame->particle) : Json();
    }
  }
  return {{"title", replay.sceneFile().title},
          {"recorded_ticks", recording.ticks()},
          {"replayed_ticks", result.ticks},
          {"hashes", result.hashes},
          {"frames", result.frames},
          {"difference", difference},
          {"end", result.end},
          {"missing_ticks", result.gap ? result.gap->ticks : 0},
          {"ended_early", result.ended_early},
          {"recorded_simd", recording.header().instruction_set},
          {"simd", simdTarget()},
          {"recorded_arithmetic", recording.header().arithmetic},
          {"arithmetic", arithmetic()},
          {"threads", replay.sceneFile().bed.threads}};
}

void replay(const ReplayOptions& options) {
  const StopOnSignal stop_on_signal;
  const RecordingReader recording(options.file);
  if (const std::string why = whyOtherBits(recording.header()); options.verify && !why.empty()) {
    spdlog::warn("results will not be bit-identical: {}", why);
  }
  StatusLine status;
  Replay replay(recording, options.threads, settlingIn(status));
  Progress progress(status);
  const double all_s = static_cast<double>(recording.ticks()) * recording.header().tick_s;
  const double end_s = std::min(options.until_s.value_or(all_s), all_s);
  const ReplayResult result = replay.run(
      [&](const TickRecord& was, const TickRecord&) { return progress.tell("replaying", was.time_s / end_s); },
      options.until_s.value_or(std::numeric_limits<double>::infinity()));
  status.clear();
  options.json ? printJson(summaryJson(recording, replay, result))
               : printText(summary(options, recording, replay, result));
  if (options.verify && result.difference) {
    throw Failure("the replay differs from the recording");
  }
  if (options.verify && result.gap) {
    throw Failure(fmt::format("cannot verify the recording: it is incomplete; missing are {}", gapText(*result.gap)));
  }
  if (options.verify && result.ticks == 0) {
    throw Failure("no tick could be compared");
  }
  throwIfStopped();
}

}  // namespace

void addReplayCommand(CLI::App& app) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand("replay", "Replay a recording and compare it tick by tick");
  command->footer(kReplayExamples);
  command->add_option("file", options->file, "Recording of a complete run (.h5)")->required()->option_text("FILE.h5");
  command->add_flag("--verify", options->verify, "Fail unless every hash and force is bit-identical");
  command->add_option("--threads", options->threads, "Number of threads [as recorded]")
      ->check(wholeNumberIn(BedRanges::threads))
      ->option_text("N");
  command->add_option("--until-s", options->until_s, "Only the first T seconds [all]")
      ->check(numberIn({1e-3, 1e9}))
      ->option_text("T");
  addJson(*command, options->json);
  command->callback([options] { replay(*options); });
}

}  // namespace haptolith

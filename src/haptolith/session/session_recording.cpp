#include "haptolith/session/session_recording.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/new_file_name.h"
#include "haptolith/core/pluralise.h"

namespace haptolith {

namespace {

/// An hour at 1 kHz, about 0.8 GB: a forgotten recording.
constexpr std::uint64_t kMostTicks = 3'600'000;

RecordingHeader headerOf(const Session& session, const std::string& program_version) {
  const SceneFile& scene_file = session.shown();
  RecordingHeader header;
  header.scene_file = sceneFileText(scene_file);
  header.title = scene_file.title;
  header.program_version = program_version;
  header.instruction_set = simdTarget();
  header.arithmetic = arithmetic();
  header.device = session.deviceName();
  header.device_limits = limitsText(session.device().limits(), session.device().simulated());
  std::vector<RecordedTool> tools;
  const std::vector<std::string_view> names = toolNames(scene_file);
  const ToolSet parameters = toolSet(scene_file);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const HapticDevice& device = session.device(i);
    tools.push_back({std::string(names[i]), std::string(device.name()), limitsText(device.limits(), device.simulated()),
                     parameters.all()[i].joint.any()});
  }
  if (tools.size() > 1 || tools.front().has_joint) {
    header.tools = toolsText(tools);
  }
  header.seed = scene_file.bed.seed;
  header.threads = static_cast<std::uint64_t>(scene_file.bed.threads);
  header.hashed_parts = session.loop().hashedParts();
  header.tick_s = scene_file.loop.tick_s;
  stampNow(header);
  return header;
}

}  // namespace

void SessionRecording::start(const Session& session) {
  requireNoWholeRun();
  stop();
  begin(session, newFileName("haptolith", ".h5"), false);
  endless_ = false;
}

void SessionRecording::start(const Session& session, const std::string& file, bool overwrite) {
  begin(session, file, overwrite);
  endless_ = true;
}

void SessionRecording::begin(const Session& session, const std::string& file, bool overwrite) {
  RecordingHeader header = headerOf(session, options_.program_version);
  header.start_tick = session.loopTicks();
  auto writer = std::make_unique<RecordingWriter>(
      file, header,
      RecordingOptions{
          .overwrite = overwrite, .wait_when_full = !session.shown().loop.real_time, .robot = options_.robot});
  name_ = file;
  problem_.clear();
  next_frame_s_ = 0;
  loop_ = &session.loop();
  lost_before_ = loop_->lostRecords();
  const std::lock_guard lock(mutex_);
  writer_ = std::move(writer);
  ticks_ = 0;
  begun_s_.reset();
}

std::optional<double> SessionRecording::begun() {
  const std::lock_guard lock(mutex_);
  return begun_s_;
}

std::unique_ptr<RecordingWriter> SessionRecording::takeWriter() {
  const std::lock_guard lock(mutex_);
  return std::move(writer_);
}

void SessionRecording::stop() {
  const std::string name = std::exchange(name_, {});
  const std::unique_ptr<RecordingWriter> ended = takeWriter();
  if (!ended) {
    return;
  }
  ended->finish(loop_->lostRecords() - lost_before_);
  problem_ = ended->problem();
  if (!problem_.empty()) {
    throw Failure(problem_);
  }
  if (const std::uint64_t missing = ended->written().missing; missing > 0) {
    problem_ = fmt::format("{} missing in {}: the program was interrupted for too long",
                           pluralise(missing, "tick is", "ticks are"), name);
    options_.warn(problem_);
  }
}

/// A viewer cannot end a recording that was asked for at the start.
void SessionRecording::requireNoWholeRun() const {
  if (!name_.empty() && endless_) {
    throw Failure(fmt::format("cannot change the recording: the complete run is recorded to {}", name_));
  }
}

void SessionRecording::stopPart() {
  requireNoWholeRun();
  const bool any = !name_.empty();
  stop();
  if (any && !problem_.empty()) {
    throw Failure(problem_);
  }
}

void SessionRecording::check() {
  if (name_.empty()) {
    return;
  }
  bool too_long = false;
  {
    const std::lock_guard lock(mutex_);
    problem_ = writer_->problem();
    too_long = !endless_ && ticks_ >= kMostTicks;
  }
  if (!problem_.empty()) {
    options_.warn(problem_);
    takeWriter().reset();
    name_.clear();
  } else if (too_long) {
    options_.warn(fmt::format("the recording {} has ended: its limit is one hour", name_));
    stop();
  }
}

void SessionRecording::add(const std::vector<TickRecord>& ticks) {
  const std::lock_guard lock(mutex_);
  if (writer_ && !ticks.empty()) {
    writer_->add(ticks);
    ticks_ +=
        static_cast<std::uint64_t>(std::ranges::count_if(ticks, [](const TickRecord& tick) { return tick.tool == 0; }));
    begun_s_ = begun_s_ ? begun_s_ : ticks.front().time_s;
  }
}

void SessionRecording::add(const SceneSnapshot& snapshot) {
  if (!name_.empty() && options_.frames_per_s > 0 && snapshot.time_s >= next_frame_s_) {
    writer_->add(particleFrame(snapshot));
    next_frame_s_ = std::max(next_frame_s_ + 1 / options_.frames_per_s, snapshot.time_s);
  }
}

void SessionRecording::add(const RobotRow& report) {
  if (!name_.empty()) {
    writer_->add(report);
  }
}

void SessionRecording::add(const SiteRow& seen) {
  if (!name_.empty()) {
    writer_->add(seen);
  }
}

void SessionRecording::note(const std::string& kind, double time_s, const std::string& text) {
  if (!name_.empty()) {
    const std::lock_guard lock(mutex_);
    writer_->add(RecordingEvent{.time_s = time_s, .tick = ticks_, .kind = kind, .text = text});
  }
}

}  // namespace haptolith

#include "haptolith/recording/recorded_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/bed/measure/contact_load.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr std::uint64_t kBlock = 4096;  ///< rows that are read at a time
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

std::vector<FrameRow> rowsWithParticles(const RecordingReader& recording) {
  std::vector<FrameRow> rows;
  for (std::uint64_t first = 0; first < recording.frames(); first += kBlock) {
    std::ranges::copy_if(recording.readFrameRows(first, kBlock), std::back_inserter(rows),
                         [](const FrameRow& row) { return row.count > 0; });
  }
  return rows;
}

std::optional<SceneFile> sceneOf(const RecordingReader& recording) {
  try {
    return loadSceneFileText(recording.header().scene_file, "the recorded scene");
  } catch (const InvalidParameter&) {
    return std::nullopt;
  } catch (const Failure&) {
    return std::nullopt;
  }
}

std::array<float, 3> xyz(const Float4& v) {
  return {v.x, v.y, v.z};
}

std::vector<std::array<float, 3>> xyz(std::span<const Float4> records) {
  std::vector<std::array<float, 3>> values(records.size());
  std::ranges::transform(records, values.begin(), [](const Float4& record) { return xyz(record); });
  return values;
}

ScenePicture pictureAt(const FrameRow& row) {
  ScenePicture picture;
  picture.time_s = row.time_s;
  picture.tick = row.tick;
  return picture;
}

/// Radii and contact forces of particles; w of a position is by how much the radius exceeds the mean.
void addContacts(ScenePicture& picture, const BedParameters& bed, std::span<const Float4> position) {
  picture.radius_m.resize(position.size());
  std::ranges::transform(position, picture.radius_m.begin(),
                         [&](const Float4& p) { return static_cast<float>(bed.soil.radius_m) + p.w; });
  const bool finite = std::ranges::all_of(position, [](const Float4& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.w);
  });
  picture.contact_force_n = finite ? contactLoads(bed, position) : std::vector<float>(position.size(), kUnknown);
}

/// Opening of the jaws in the device's hand.
double openingOf(const SceneFile& scene_file, const TickRecord& tick) {
  if (scene_file.tool.shape != ToolShape::kJaws) {
    return 0;
  }
  const double share = scene_file.handling.mapping.gripper ? tick.device.gripper_open : 1;
  return scene_file.tool.opening_m * (std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 1);
}

std::string whyItEnded(const ReplayResult& result) {
  if (result.difference) {
    return fmt::format("after {:.12g} s the replay differs from the recording ({})", result.difference->time_s,
                       result.difference->what);
  }
  if (result.gap) {
    return fmt::format("after {:.12g} s ticks are missing in the recording", result.gap->time_s);
  }
  return result.ended_early.empty() ? "there are frames after the last tick" : result.ended_early;
}

}  // namespace

RecordedPictures::RecordedPictures(const RecordingReader& recording, Options options)
    : recording_(recording),
      options_(std::move(options)),
      rows_(rowsWithParticles(recording)),
      scene_file_(sceneOf(recording)) {
  if (options_.replay && !rows_.empty()) {
    prepareReplay();
  }
}

void RecordedPictures::prepareReplay() {
  const bool is_whole = header().start_tick == 0;  // otherwise it cannot be replayed anywhere, as reported below
  why_not_replayed_ = is_whole ? whyOtherBits(header()) : "";
  if (!why_not_replayed_.empty()) {
    return;
  }
  try {
    replay_.emplace(recording_, std::nullopt, options_.settling);
  } catch (const InvalidParameter& error) {
    why_not_replayed_ = error.what();
  } catch (const Failure& failure) {
    goOn(0);
    why_not_replayed_ = failure.what();
  }
}

std::uint64_t RecordedPictures::numberOf(double time_s) const noexcept {
  return tickNumber(time_s, header().tick_s);
}

void RecordedPictures::goOn(double time_s) const {
  if (options_.reached && !options_.reached(time_s)) {
    throw Failure("interrupted");
  }
}

void RecordedPictures::forEach(const Take& take) {
  next_ = replayed_ = 0;
  if (replay_) {
    takeReplayed(take);
  }
  takeRecorded(take);
}

void RecordedPictures::takeReplayed(const Take& take) {
  const auto take_next = [&](bool has_tick) {
    take(replayedPicture(rows_[next_], has_tick));
    ++next_;
    ++replayed_;
  };
  while (next_ < rows_.size() && numberOf(rows_[next_].time_s) == 0) {
    take_next(false);
  }
  const ReplayResult result = replay_->run([&](const TickRecord& was, const TickRecord&) {
    goOn(was.time_s);
    while (next_ < rows_.size() && numberOf(rows_[next_].time_s) == numberOf(was.time_s)) {
      take_next(true);
    }
    return next_ < rows_.size();
  });
  if (next_ < rows_.size()) {
    why_not_replayed_ = whyItEnded(result);
  }
}

void RecordedPictures::takeRecorded(const Take& take) {
  bool scene_known = scene_file_.has_value();
  const auto take_next = [&](std::span<const TickRecord> of_tools) {
    goOn(rows_[next_].time_s);
    take(recordedPicture(rows_[next_], of_tools, scene_known));
    ++next_;
  };
  const std::size_t tools = recording_.tools().size();
  std::vector<TickRecord> of_tools;  // all in one tick
  for (std::uint64_t first = 0; first < recording_.ticks() && next_ < rows_.size(); first += kBlock) {
    std::vector<std::vector<TickRecord>> ticks;
    for (std::size_t tool = 0; tool < tools; ++tool) {
      ticks.push_back(recording_.readTicks(first, kBlock, tool));
    }
    for (std::size_t row = 0; row < ticks.front().size(); ++row) {
      const TickRecord& tick = ticks.front()[row];
      const std::uint64_t number = numberOf(tick.time_s);
      while (next_ < rows_.size() && numberOf(rows_[next_].time_s) < number) {
        take_next({});
      }
      scene_known = scene_known && (tick.flags & kTickSceneChanged) == 0;
      of_tools.clear();
      for (const std::vector<TickRecord>& of_tool : ticks) {
        if (row < of_tool.size()) {
          of_tools.push_back(of_tool[row]);
        }
      }
      while (next_ < rows_.size() && numberOf(rows_[next_].time_s) == number) {
        take_next(of_tools.size() == tools ? of_tools : std::span<const TickRecord>());
      }
    }
  }
  while (next_ < rows_.size()) {
    take_next({});
  }
}

ScenePicture RecordedPictures::replayedPicture(const FrameRow& row, bool has_tick) {
  const Scene& scene = replay_->loop().shownScene().scene;
  const std::span<const Float4> position(scene.bed().state().position.data(), scene.bed().particles());
  ScenePicture picture = pictureAt(row);
  picture.position_m = xyz(position);
  picture.velocity_m_s = xyz({scene.bed().state().velocity.data(), scene.bed().particles()});
  addContacts(picture, scene.bed().parameters(), position);
  const Stones& stones = scene.bed().stones();
  for (std::size_t stone = 0; stone < stones.size(); ++stone) {
    picture.stones.push_back({stones.pose(stone), stones.shape(stone)});
  }
  for (std::size_t i = 0; has_tick && i < scene.tools(); ++i) {
    picture.tools.push_back({.pose = scene.turnedToolPose(i),
                             .opening_m = scene.opening(i),
                             .soil = scene.soilWrench(i),
                             .hub = scene.toolPose(i),
                             .joint = scene.joint(i)});
  }
  return picture;
}

ScenePicture RecordedPictures::recordedPicture(const FrameRow& row, std::span<const TickRecord> of_tools,
                                               bool scene_known) {
  ScenePicture picture = pictureAt(row);
  picture.position_m = recording_.readFrame(row).position_m;
  const std::size_t count = picture.position_m.size();
  if (replays()) {
    picture.velocity_m_s.assign(count, {kUnknown, kUnknown, kUnknown});
  }
  if (!scene_known) {
    picture.radius_m.assign(count, kUnknown);
    picture.contact_force_n.assign(count, kUnknown);
    return picture;
  }
  const std::vector<float>& excess_m = radiusExcesses(picture.position_m);
  std::vector<Float4> position(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [x, y, z] = picture.position_m[i];
    position[i] = {x, y, z, i < excess_m.size() ? excess_m[i] : kUnknown};
  }
  addContacts(picture, scene_file_->bed, position);
  if (of_tools.size() <= toolCount(*scene_file_)) {
    for (std::size_t i = 0; i < of_tools.size(); ++i) {
      picture.tools.push_back(picturedTool(i, of_tools[i]));
    }
  }
  return picture;
}

PicturedTool RecordedPictures::picturedTool(std::size_t number, const TickRecord& tick) {
  exchangeFirst(*scene_file_, number);
  const Joint& joint = scene_file_->tool.joint;
  const PicturedTool tool{
      .pose = joint.any() ? turned(tick.scene_T_tool, joint, tick.joint.angle_rad) : tick.scene_T_tool,
      .opening_m = openingOf(*scene_file_, tick),
      .soil = tick.soil,
      .hub = tick.scene_T_tool,
      .joint = tick.joint};
  exchangeFirst(*scene_file_, number);
  return tool;
}

/// A bed that is packed or rains draws its grains' radii by its seed and their number alone, wherever they lie. Which
/// grain is how large in one that is graded, repeated from a settled tile or has stones in it follows from how it was
/// made, so that bed is made once more.
const std::vector<float>& RecordedPictures::radiusExcesses(const std::vector<std::array<float, 3>>& position_m) {
  const SoilParameters& soil = scene_file_->bed.soil;
  const BedParameters& made_of = scene_file_->bed;
  const bool all_alike = soil.friction != FrictionModel::kContact || soil.size_spread == 0;
  const bool has_own_sizes = made_of.start == BedStart::kSettled || made_of.start == BedStart::kGiven;
  const bool by_seed = grainClasses(made_of) == 1 && (all_alike || (!has_own_sizes && !made_of.stones.any()));
  const auto take_from = [&](const Bed& bed) {
    for (std::size_t i = 0; i < bed.particles() && bed.particles() == position_m.size(); ++i) {
      radius_excess_m_->push_back(bed.state().position[i].w);
    }
  };
  if (!by_seed && !radius_excess_m_) {
    radius_excess_m_.emplace();
    try {
      if (replay_) {
        take_from(replay_->loop().shownScene().scene.bed());
      } else if (whyOtherBits(header()).empty()) {  // otherwise it settles differently
        take_from(Bed(scene_file_->bed, options_.settling));
      }
    } catch (const Failure&) {
      goOn(0);
    }
  } else if (!by_seed) {
    return *radius_excess_m_;
  } else if (all_alike) {
    radius_excess_m_.emplace(position_m.size(), 0.0F);
  } else if (!radius_excess_m_) {
    radius_excess_m_.emplace();
    std::vector<Vec3> centres_m;
    centres_m.reserve(position_m.size());
    for (const auto& [x, y, z] : position_m) {
      centres_m.emplace_back(x, y, z);
    }
    try {
      take_from(Bed(scene_file_->bed, centres_m));
    } catch (const InvalidParameter&) {
      radius_excess_m_->clear();  // no such bed can be made: radii stay unknown
    }
  }
  return *radius_excess_m_;
}

}  // namespace haptolith

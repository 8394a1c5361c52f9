#include "haptolith/viewer/film.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/bed/grain_classes.h"
#include "haptolith/core/error.h"
#include "haptolith/viewer/frame.h"
#include "haptolith/viewer/messages.h"

namespace haptolith {

namespace {

enum class MessageKind : std::uint8_t { kText = 1, kFrame = 2 };

/// A message with its length and kind before it.
std::string packed(MessageKind kind, std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little, "the file format is little-endian");
  const auto size = static_cast<std::uint32_t>(bytes.size());
  std::string message(reinterpret_cast<const char*>(&size), sizeof size);
  message += static_cast<char>(kind);
  message += bytes;
  return message;
}

/// Grains of how many sizes stand one after the other; all of one where their sizes are not known.
std::vector<Bed::GrainRun> runsOf(const ScenePicture& picture, double radius_m) {
  std::vector<Bed::GrainRun> runs;
  for (const float r_m : picture.radius_m) {
    const double halvings = std::isfinite(r_m) && r_m > 0 ? std::log2(radius_m / r_m) : 0;
    const int grain_class = std::max(0, static_cast<int>(std::lround(halvings)));
    if (runs.empty() || runs.back().grain_class != grain_class) {
      runs.push_back({grain_class, 0});
    }
    ++runs.back().count;
  }
  return runs;
}

/// As high as most of the highest grains are: half of those that nothing lies above.
double surfaceOf(const ScenePicture& picture, const BedParameters& bed) {
  const double cell_m = 2 * bed.soil.radius_m;
  const auto columns = static_cast<std::size_t>(bed.width_m / cell_m) + 1;
  const auto rows = static_cast<std::size_t>(bed.length_m / cell_m) + 1;
  std::vector<double> highest_m(columns * rows, 0);
  for (const auto& [x, y, z] : picture.position_m) {
    const auto at = [cell_m](double coordinate_m, double width_m, std::size_t cells) {
      const double cell = std::clamp((coordinate_m + width_m / 2) / cell_m, 0.0, static_cast<double>(cells - 1));
      return static_cast<std::size_t>(cell);
    };
    double& top_m = highest_m[at(y, bed.length_m, rows) * columns + at(x, bed.width_m, columns)];
    top_m = std::max(top_m, static_cast<double>(z) + bed.soil.radius_m);
  }
  const auto middle = highest_m.begin() + static_cast<std::ptrdiff_t>(highest_m.size() / 2);
  std::nth_element(highest_m.begin(), middle, highest_m.end());
  return *middle;
}

/// Copies a recording's picture to the page's snapshot; values absent from the picture stay unchanged.
void show(SceneSnapshot& snapshot, const ScenePicture& picture) {
  snapshot.time_s = picture.time_s;
  snapshot.ticks = picture.tick;
  snapshot.position.resize(picture.position_m.size());
  for (std::size_t i = 0; i < snapshot.position.size(); ++i) {
    const auto& [x, y, z] = picture.position_m[i];
    snapshot.position[i] = {x, y, z, 0};
  }
  snapshot.asleep.assign(snapshot.position.size() / kGroup + 1, 0);
  snapshot.awake = snapshot.position.size();
  snapshot.tools.resize(picture.tools.size());
  for (std::size_t i = 0; i < picture.tools.size(); ++i) {
    const PicturedTool& tool = picture.tools[i];
    snapshot.tools[i] = {.scene_T_tool = tool.hub,
                         .turned = tool.pose,
                         .opening_m = tool.opening_m,
                         .joint = tool.joint,
                         .soil_wrench = tool.soil,
                         .device_wrench_in_scene = tool.soil};  // the device wrench is not in pictures
  }
  if (!picture.tools.empty()) {
    const ShownTool& first = snapshot.tools.front();
    snapshot.scene_T_tool = first.scene_T_tool;
    snapshot.opening_m = first.opening_m;
    snapshot.device_wrench_in_scene = first.device_wrench_in_scene;
  }
  if (!picture.stones.empty()) {
    snapshot.stones.clear();
    for (const PicturedStone& stone : picture.stones) {
      snapshot.stones.push_back(stone.scene_T_stone);
    }
  }
}

}  // namespace

void exportFilm(RecordedPictures& pictures, std::string_view version,
                const std::function<void(std::string_view)>& write) {
  if (!pictures.sceneFile()) {
    throw Failure("cannot read the recorded scene: there is nothing to show");
  }
  const SceneFile& scene_file = *pictures.sceneFile();
  std::optional<FrameEncoder> encoder;
  SceneSnapshot snapshot;
  const std::vector<BesideTool> beside(showsEveryTool(scene_file) ? toolCount(scene_file) : 0);
  pictures.forEach([&](const ScenePicture& picture) {
    if (!encoder) {
      const double surface_m = surfaceOf(picture, scene_file.bed);
      const FrameSpace space = shownSpace(scene_file.bed, surface_m);
      SceneLookedAt shown{.scene_file = scene_file,
                          .soil = scene_file.bed.soil,
                          .grains = runsOf(picture, scene_file.bed.soil.radius_m),
                          .surface_m = surface_m,
                          .motion = scene_file.hand.motion,
                          .low_m = space.low_m,
                          .high_m = space.high_m};
      for (const PicturedStone& stone : picture.stones) {
        shown.stones.push_back(stone.shape);
      }
      write(kFilmMagic);
      const std::string hello = helloMessages(version, true, false).whole;
      constexpr std::string_view kClient = "\"$client\"";
      const std::size_t client_at = hello.find(kClient);
      write(packed(MessageKind::kText, hello.substr(0, client_at) + "1" + hello.substr(client_at + kClient.size())));
      write(packed(MessageKind::kText, sceneMessages(shown, space).whole));
      encoder.emplace(1, picture.position_m.size(), space);
    }
    if (picture.position_m.size() != snapshot.position.size() && !snapshot.position.empty()) {
      return;  // another bed
    }
    const std::uint32_t before = encoder->number();
    show(snapshot, picture);
    encoder->take(snapshot, {.load_n = picture.contact_force_n, .tools = beside});
    write(packed(MessageKind::kFrame, *encoder->frameSince(before)));
  });
}

}  // namespace haptolith

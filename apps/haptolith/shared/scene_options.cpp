#include "shared/scene_options.h"

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/core/former_names.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/recording/recording_format.h"
#include "haptolith/scene_file/scene_words.h"
#include "haptolith/tool/tool_mesh.h"

#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/packet_key_file.h"
#include "shared/stop_on_signal.h"

namespace haptolith {

namespace {

template <class Value, std::size_t kWords>
std::map<std::string, Value> choicesOf(const std::array<SceneWord<Value>, kWords>& words) {
  std::map<std::string, Value> choices;
  for (const auto& [name, value] : words) {
    choices.emplace(name, value);
  }
  return choices;
}

/// Returns the values of --motion: every motion except "poses", which has a separate option.
std::map<std::string, HandMotion> motionChoices() {
  auto choices = choicesOf(kHandMotionWords);
  std::erase_if(choices, [](const auto& choice) { return choice.second == HandMotion::kPoses; });
  return choices;
}

/// Prints the size of the mesh, which shows a wrong unit, and the changes made to it.
void tellOfMesh(const SceneFile& scene_file) {
  const ToolMesh& mesh = *scene_file.tool.mesh;
  const Vec3 size_mm = 1e3 * (mesh.field.corners().high_m - mesh.field.corners().low_m);
  spdlog::info("{}: {:.3g} x {:.3g} x {:.3g} mm, walls and corners to {:.2g} mm", scene_file.mesh.name, size_mm.x(),
               size_mm.y(), size_mm.z(), 1e3 * mesh.field.spacing());
  constexpr std::size_t kMostRecordedBytes = kLongestHeaderText / 10 * 7;  // the scene's text contains it in base64
  if (scene_file.mesh.bytes->size() > kMostRecordedBytes) {
    spdlog::warn("{}: a file of more than {} kB cannot be recorded", scene_file.mesh.name, kMostRecordedBytes / 1000);
  }
  for (const std::string& done : mesh.report) {
    spdlog::info("{}: {}", scene_file.mesh.name, done);
  }
}

}  // namespace

CLI::Option* DeviceOptions::addTo(CLI::App& command, std::vector<std::string>* of_tools) {
  CLI::Option* named =
      of_tools == nullptr
          ? command.add_option("--device", kind, "Haptic device (haptolith devices) [virtual-hand]")
                ->transform(wordOf(choicesOf(kDeviceWords)))
                ->option_text("NAME")
          : command
                .add_option(
                    "--device", *of_tools,
                    "Haptic device (haptolith devices) [virtual-hand]; can be repeated, with the names of tools: "
                    "left=force-dimension:0, right=network:9051")
                ->allow_extra_args(false)
                ->option_text("[TOOL=]NAME[:WHICH]");
  command.add_option("--device-id", id, "Device to use when several are connected")->option_text("ID");
  command.add_option("--device-library", library, "Folder or file of the device's SDK")->option_text("PATH");
  command.add_option("--device-address", address, "Address of the device's service, or address to listen on")
      ->option_text("ADDRESS");
  command
      .add_option(
          "--device-key-file", key_file,
          "For device network: file with the key of the packets, 64 hexadecimal digits; or HAPTOLITH_DEVICE_KEY")
      ->option_text("FILE");
  command.add_flag("--device-insecure", insecure,
                   "For device network: listen beyond this machine without a key; only on a trusted network");
  return named;
}

void DeviceOptions::applyTo(DeviceParameters& device) const {
  device.kind = kind.value_or(device.kind);
  device.id = id.value_or(device.id);
  device.library = library.value_or(device.library);
  device.address = address.value_or(device.address);
  device.insecure = insecure;
  device.key = device.kind == DeviceKind::kNetwork ? keyFrom(key_file, "HAPTOLITH_DEVICE_KEY") : "";
}

namespace {

/// "left=network:9051", taken apart.
struct ToolDevice {
  std::string tool;  ///< empty: the first
  DeviceKind kind = DeviceKind::kVirtualHand;
  std::string which;
};

ToolDevice toolDeviceOf(const std::string& text) {
  ToolDevice device;
  const std::size_t equals = text.find('=');
  std::string rest = text;
  if (equals != std::string::npos) {
    device.tool = text.substr(0, equals);
    rest = text.substr(equals + 1);
  }
  const std::size_t colon = rest.find(':');
  const std::string word(currentName(NameKind::kWord, rest.substr(0, colon)));
  device.which = colon == std::string::npos ? "" : rest.substr(colon + 1);
  const std::vector<std::string_view> words = namesOf(kDeviceWords);
  const auto same_letter = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  const auto found =
      std::ranges::find_if(words, [&](std::string_view name) { return std::ranges::equal(name, word, same_letter); });
  if (found == words.end() || (colon != std::string::npos && device.which.empty())) {
    throw InvalidParameter("--device", inQuotes(text),
                           fmt::format("a device, or TOOL=DEVICE[:WHICH]; devices are {}", anyOf(words)));
  }
  device.kind = valueOf(kDeviceWords, *found);
  return device;
}

/// Sets the address on which a network device listens (HOST:PORT, or the port alone), or the number or serial of
/// another.
void setWhich(DeviceParameters& device, const std::string& which) {
  if (which.empty()) {
    return;
  }
  if (device.kind == DeviceKind::kNetwork || device.kind == DeviceKind::kInverse3) {
    const bool is_port = which.find_first_not_of("0123456789") == std::string::npos;
    device.address = is_port && device.kind == DeviceKind::kNetwork ? "127.0.0.1:" + which : which;
  } else {
    device.id = which;
  }
}

void giveDevices(const SceneOptions& options, SceneFile& scene_file) {
  std::vector<std::string> given;
  for (const std::string& text : options.devices) {
    const ToolDevice device = toolDeviceOf(text);
    const std::vector<std::string_view> names = toolNames(scene_file);
    const auto found = device.tool.empty() ? names.begin() : std::ranges::find(names, device.tool);
    if (found == names.end()) {
      throw InvalidParameter("--device", inQuotes(text),
                             fmt::format("for a tool of the scene: {}", fmt::join(names, ", ")));
    }
    if (std::ranges::find(given, *found) != given.end()) {
      throw InvalidParameter("--device", inQuotes(text), fmt::format("given once: {} has a device already", *found));
    }
    given.emplace_back(*found);
    const auto tool = static_cast<std::size_t>(found - names.begin());
    exchangeFirst(scene_file, tool);
    scene_file.device.kind = device.kind;
    setWhich(scene_file.device, device.which);
    exchangeFirst(scene_file, tool);
  }
  for (std::size_t tool = 0; tool < toolCount(scene_file); ++tool) {
    exchangeFirst(scene_file, tool);
    if (tool == 0) {
      options.device.applyTo(scene_file.device);
    } else {
      DeviceOptions shared;
      shared.key_file = options.device.key_file;
      shared.library = options.device.library;
      shared.insecure = options.device.insecure;
      shared.applyTo(scene_file.device);
    }
    exchangeFirst(scene_file, tool);
  }
}

}  // namespace

std::string SceneOptions::scene() const {
  if (!name_or_file.empty()) {
    return std::string(currentNameReported(NameKind::kScene, name_or_file));
  }
  return preset ? "icra2021" : usual;
}

void SceneOptions::addTo(CLI::App& command) {
  command
      .add_option(
          "scenario", name_or_file,
          fmt::format(
              "Scene: a name (haptolith scenes) or a file (docs/reference/scenes.md) [{}; with --preset icra2021]",
              usual))
      ->option_text("NAME|FILE");
  command
      .add_option("--set", overrides,
                  "Set a key of the scene, for example bed.depth_mm=60; can be repeated (docs/reference/scenes.md)")
      ->allow_extra_args(false)
      ->option_text("TABLE.KEY=VALUE");
  CLI::Option* by_preset = command.add_option("--preset", preset, "Soil of the ICRA 2021 paper: P1 to P6");
  by_preset->option_text("NAME");
  command.add_option("--soil", soil, "Soil: a name (haptolith soil list) or a file (docs/reference/soils.md)")
      ->option_text("NAME|FILE")
      ->excludes(by_preset);
  command.add_option("--friction-model", friction, "Friction model [the soil's]")
      ->transform(wordOf(choicesOf(kFrictionWords)))
      ->option_text("icra2021|contact");
  command.add_option("--body", body, kBodyHelp)->option_text("NAME");
  CLI::Option* by_motion = command.add_option("--motion", motion, "Motion of the virtual hand");
  by_motion->transform(wordOf(motionChoices()))->option_text("still|press|stir|scoop|carry|shake|cut|furrows");
  command
      .add_option("--poses", poses_file, "Motion of the virtual hand as a CSV of poses: t_s,x_m,y_m,z_m,qw,qx,qy,qz")
      ->option_text("FILE")
      ->excludes(by_motion);
  command.add_option("--threads", threads, kThreadsHelp)->check(wholeNumberIn(BedRanges::threads))->option_text("N");
  command.add_option("--seed", seed, "Seed of a bed that starts as rain or settled")
      ->check(wholeNumberIn(BedRanges::seed))
      ->option_text("N");
  device.addTo(command, &devices)->excludes(by_motion);
}

SceneFile sceneFileFor(const SceneOptions& options) {
  const std::string scene = options.scene();
  SceneFile scene_file = findSceneFile(scene, options.overrides);
  const std::string title = scene_file.title, before = sceneInWords(scene_file);
  BedParameters& bed = scene_file.bed;
  if (options.preset) {
    changePreset(scene_file, *options.preset);
  }
  if (options.soil) {
    changeSoil(scene_file, *options.soil);
  }
  bed.soil.friction = options.friction.value_or(bed.soil.friction);
  if (options.body) {
    changeBody(scene_file, *options.body);
  }
  if (options.motion) {
    scene_file.hand.motion = *options.motion;
  }
  if (options.poses_file) {
    scene_file.hand.motion = HandMotion::kPoses;
    scene_file.hand.poses_file = *options.poses_file;
  }
  bed.threads = options.threads.value_or(bed.threads);
  bed.seed = options.seed.value_or(bed.seed);
  giveDevices(options, scene_file);
  retitle(scene_file, before);
  // A title from the user is kept.
  const std::vector<std::string> built_in = sceneNames();
  const bool titled =
      std::ranges::any_of(options.overrides, [](std::string_view text) { return text.starts_with("title"); }) ||
      std::ranges::find(built_in, scene) == built_in.end();
  scene_file.title = titled ? title : scene_file.title;
  makeToolMesh(scene_file);
  if (scene_file.tool.shape == ToolShape::kMesh) {
    tellOfMesh(scene_file);
  }
  for (const std::string& idle : idleKeys(scene, scene_file, options.overrides)) {
    spdlog::warn("{}", idle);
  }
  return scene_file;
}

SettleProgress settlingIn(StatusLine& status) {
  return [&status](double time_s, double speed_m_s) {
    status.tell(
        [&] { return fmt::format("the bed is settling: {:.1f} s, fastest particle {:.4f} m/s", time_s, speed_m_s); });
    return !stopAsked();
  };
}

}  // namespace haptolith

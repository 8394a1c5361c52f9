#include "haptolith/identify/training/training_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <span>

#include "haptolith/bed/bed_parameters.h"
#include "haptolith/core/error.h"
#include "haptolith/core/files/input_file.h"
#include "haptolith/core/files/json_reader.h"
#include "haptolith/identify/training/built_in_trainings.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20;
constexpr std::size_t kMostRuns = 10000, kMostWindows = 10000;

/// Number of a soil sample, with its key in the file.
struct SampleKey {
  std::string name;
  Range valid;
  double SoilParameters::*of_soil;
  double SoilSample::*of_sample = nullptr;  ///< null for a member of the soil

  [[nodiscard]] double& in(SoilSample& sample) const {
    return of_sample == nullptr ? sample.soil.*of_soil : sample.*of_sample;
  }
};

const std::vector<SampleKey>& sampleKeys() {
  static const std::vector<SampleKey> kKeys = [] {
    std::vector<SampleKey> keys;
    for (const SoilNumber& number : soilNumbersBy(&SoilNumber::training_place)) {
      keys.push_back({std::string(number.key), number.valid, number.member});
    }
    keys.push_back({"tool_friction", ToolRanges::friction, nullptr, &SoilSample::tool_friction});
    keys.push_back({"tool_adhesion_n", ToolRanges::adhesion_n, nullptr, &SoilSample::tool_adhesion_n});
    keys.push_back({"surface_error_m", {-1, 1}, nullptr, &SoilSample::surface_error_m});
    keys.push_back({"stone_size_m", {0, 1}, nullptr, &SoilSample::stone_size_m});
    return keys;
  }();
  return kKeys;
}

/// Rounds a number to six digits for the file.
double rounded(double value) {
  return std::stod(fmt::format("{:.6g}", value));
}

double force(double value_n) {
  return std::stod(fmt::format("{:.4g}", std::abs(value_n) < 5e-4 ? 0 : value_n));
}

// --- reading --------------------------------------------------------------------------------------------------------

ShearStrength strengthFrom(const JsonValue& node) {
  const auto [angle_deg, cohesion_pa] = node.numbers<2>({-1e6, 1e6});
  requireInRange(node.path(), angle_deg, {0, 89});
  return {angle_deg, cohesion_pa};
}

TrainingRun runFrom(const JsonValue& node, std::size_t windows) {
  TrainingRun run;
  run.number = static_cast<std::uint64_t>(node.at("number").number(BedRanges::seed));
  run.sample.soil = lunarContacts();
  for (const SampleKey& key : sampleKeys()) {
    key.in(run.sample) = node.at(key.name.c_str()).number(key.valid);
  }
  run.sample.soil.rho_max_kg_m3 *= run.sample.soil.rho0_kg_m3 / lunarContacts().rho0_kg_m3;
  if (node.has("residual")) {
    run.strength = MeasuredStrength{strengthFrom(node.at("residual")), strengthFrom(node.at("peak"))};
  }
  for (const JsonValue& window : node.at("forces_n").list(windows, windows)) {
    const auto [x, y, z] = window.numbers<3>({-1e6, 1e6});
    run.forces.emplace_back(x, y, z);
  }
  return run;
}

std::vector<TimedPose> posesFrom(const JsonValue& node) {
  std::vector<TimedPose> poses;
  for (const JsonValue& row : node.list(2, kMostWindows)) {
    const auto v = row.numbers<8>({-1e6, 1e6});
    const Quat turn(v[4], v[5], v[6], v[7]);
    requireInRange(row.path() + ": length of qw,qx,qy,qz", turn.norm(), kUnitNorm);
    poses.push_back({v[0], {{v[1], v[2], v[3]}, turn.normalized()}});
  }
  return poses;
}

}  // namespace

std::string trainingText(const Training& training) {
  Json poses = Json::array();
  for (const TimedPose& at : training.movement.poses()) {
    const Vec3& p = at.pose.position_m;
    const Quat& q = at.pose.orientation;
    Json row = Json::array();
    for (const double value : {at.time_s, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}) {
      row.push_back(rounded(value));
    }
    poses.push_back(row);
  }
  // One line per run, so that changes are visible in a diff.
  std::string text = fmt::format(
      "{{\"haptolith_training\": {},\n\"tool\": {},\n\"gravity_m_s2\": {},\n\"window_s\": {},\n"
      "{}\"poses\": {},\n\"runs\": [",
      kVersion, Json(training.tool).dump(), training.gravity_m_s2, kForceWindow_s,
      training.temper ? fmt::format("\"temper\": {:.4g},\n", *training.temper) : "", poses.dump());
  const char* separator = "\n";
  for (const TrainingRun& run : training.runs) {
    Json row{{"number", run.number}};
    SoilSample sample = run.sample;
    for (const SampleKey& key : sampleKeys()) {
      row[key.name] = rounded(key.in(sample));
    }
    if (run.strength) {
      const auto& [residual, peak] = *run.strength;
      row["residual"] = {rounded(residual.angle_deg), rounded(residual.cohesion_pa)};
      row["peak"] = {rounded(peak.angle_deg), rounded(peak.cohesion_pa)};
    }
    Json& forces = row["forces_n"] = Json::array();
    for (const Vec3& f : run.forces) {
      forces.push_back({force(f.x()), force(f.y()), force(f.z())});
    }
    text += separator + row.dump();
    separator = ",\n";
  }
  return text + "\n]}\n";
}

Training parseTraining(std::string_view text, std::string_view name) {
  const JsonValue file = parseJson(text, std::string(name), "a training that `haptolith identify train` has written");
  (void)file.at("haptolith_training").number({kVersion, kVersion});
  (void)file.at("window_s").number({kForceWindow_s, kForceWindow_s});
  Training training{ToolMovement(posesFrom(file.at("poses"))), {}, 0, {}, {}};
  training.gravity_m_s2 = file.at("gravity_m_s2").number(BedRanges::gravity_m_s2);
  requireInRange(fmt::format("{}: poses: duration_s", name), training.movement.duration(),
                 {kForceWindow_s, kForceWindow_s * kMostWindows});
  const auto windows = static_cast<std::size_t>(training.movement.duration() / kForceWindow_s);
  if (file.has("temper")) {
    training.temper = file.at("temper").number({0.1, 1000});
  }
  training.tool = file.has("tool") ? file.at("tool").text() : "";
  std::map<std::uint64_t, std::string> places;  // keys of the runs by their numbers
  for (const JsonValue& node : file.at("runs").list(0, kMostRuns)) {
    const TrainingRun run = runFrom(node, windows);
    if (const auto [same, is_new] = places.emplace(run.number, node.path()); !is_new) {
      throw InvalidParameter(node.path() + ".number", fmt::format("{}, as of {}", run.number, same->second),
                             "another soil in each run: one that stands there twice would count twice");
    }
    const auto same = std::ranges::find(training.runs, run.forces, &TrainingRun::forces);
    if (same != training.runs.end() && !run.forces.empty()) {
      throw InvalidParameter(node.path() + ".forces_n", fmt::format("those of run {} again", same->number),
                             "another soil in each run: one that stands there twice would count twice");
    }
    training.runs.push_back(run);
  }
  return training;
}

Training readTraining(const std::filesystem::path& path) {
  std::ifstream file = openInput(path, kMostBytes);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  return parseTraining(text, path.string());
}

const Training& probeTraining() {
  static const Training kTraining = [] {
    const std::span<const BuiltInTraining> files = builtInTrainings();
    if (files.empty()) {
      throw Failure("this program was built without a training");
    }
    return parseTraining(files.front().text, files.front().name);
  }();
  return kTraining;
}

}  // namespace haptolith

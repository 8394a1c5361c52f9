#include "run/run_summary.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/core/pluralise.h"
#include "haptolith/machine/deadline_report.h"
#include "haptolith/scene_file/scene_words.h"

#include "shared/histogram_json.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

Json statisticsJson(const Histogram& h) {
  return {{"mean", h.mean()}, {"p99", h.percentile(0.99)}, {"max", h.max()}};
}

Json finestJson(const std::optional<FinestGrain>& finest) {
  const auto trial = [](const GrainTrial& tried) -> Json {
    return {{"radius_mm", 1e3 * tried.radius_m},
            {"grains", tried.grains},
            {"substeps", tried.substeps},
            {"threads", tried.threads},
            {"predicted_tick_us_p99", tried.tick_us_p99}};
  };
  return finest ? Json{{"chosen", trial(finest->chosen)},
                       {"too_slow", finest->too_slow ? trial(*finest->too_slow) : Json(nullptr)}}
                : Json(nullptr);
}

std::string soilText(const SceneFile& scene_file) {
  const std::string name = scene_file.preset + scene_file.soil_name;  // at most one of them is set
  return fmt::format("{}, {} friction", name.empty() ? "own soil" : name,
                     wordFor(kFrictionWords, scene_file.bed.soil.friction));
}

/// Describes the lateness of ticks in real time; empty without any.
std::string wakeUpText(const Histogram& late_us) {
  return late_us.count() == 0
             ? ""
             : fmt::format("  wake-up    p50 {:.1f}  p99 {:.1f}  p99.9 {:.1f}  max {:.1f} us late\n",
                           late_us.percentile(0.5), late_us.percentile(0.99), late_us.percentile(0.999), late_us.max());
}

/// Returns "256 particles of R = 7 mm", "2048 particles (208 of R = 7 mm, 1840 of R = 3.5 mm)"; held particles of
/// several sizes come last, "189 of 7 mm behind the sides".
std::string grainsText(const Bed& bed) {
  std::vector<std::string> sizes;
  const std::vector<Bed::GrainRun> runs = bed.grainRuns();
  for (const auto& [grain_class, count] : runs) {
    const std::string size =
        fmt::format("R = {:g} mm", 1e3 * GrainClasses::scale(grain_class) * bed.parameters().soil.radius_m);
    sizes.push_back(runs.size() == 1 ? "of " + size : fmt::format("{} of {}", count, size));
  }
  if (runs.size() > 1 && bed.heldParticles() > 0) {
    sizes.back() += " behind the sides";
  }
  const std::string all = fmt::format("{}", fmt::join(sizes, ", "));
  return runs.size() == 1 ? fmt::format("{} particles {}", bed.particles(), all)
                          : fmt::format("{} particles ({})", bed.particles(), all);
}

Json bandJson(const std::optional<ForceRange>& band) {
  return band ? Json{band->low_n, band->high_n} : Json(nullptr);
}

Json toolsJson(const SceneFile& scene_file, const Scene& scene) {
  Json tools = Json::array();
  const std::vector<std::string_view> names = toolNames(scene_file);
  for (std::size_t i = 0; i < scene.tools(); ++i) {
    const JointState& joint = scene.joint(i);
    const Vec3& force_n = scene.soilWrench(i).force_n;
    tools.push_back({{"name", names.at(i)},
                     {"soil_force_n", {force_n.x(), force_n.y(), force_n.z()}},
                     {"force_band_n", bandJson(scene.forceBand(i))},
                     {"joint", scene.tool(i).joint.any() ? Json{{"angle_rad", joint.angle_rad},
                                                                {"speed_rad_s", joint.speed_rad_s},
                                                                {"soil_torque_nm", joint.soil_torque_nm},
                                                                {"motor_torque_nm", joint.motor_torque_nm}}
                                                         : Json(nullptr)}});
  }
  return tools;
}

/// Describes the tools at the end; empty for one without a joint.
std::string toolsText(const SceneFile& scene_file, const Scene& scene) {
  std::string text;
  if (scene.tools() == 1 && !scene.tool().joint.any()) {
    return text;
  }
  const std::vector<std::string_view> names = toolNames(scene_file);
  for (std::size_t i = 0; i < scene.tools(); ++i) {
    text += fmt::format("  {:<10} {:.2f} N of the soil at the end", names.at(i), scene.soilWrench(i).force_n.norm());
    if (scene.tool(i).joint.any()) {
      const JointState& joint = scene.joint(i);
      text += fmt::format("; turns at {:.3g} rad/s, motor {:.3g} N m, soil {:.3g} N m", joint.speed_rad_s,
                          joint.motor_torque_nm, joint.soil_torque_nm);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

nlohmann::ordered_json summaryJson(const SceneFile& scene_file, const Scene& scene, const HapticLoop& loop,
                                   const RunSummary& summary) {
  const LoopStatistics& statistics = loop.statistics();
  const auto misses = [&](Miss cause) {
    return scene_file.loop.real_time ? Json(statistics.misses(cause)) : Json(nullptr);
  };
  return {{"title", scene_file.title},
          {"preset", scene_file.preset},
          {"soil", scene_file.soil_name.empty() ? Json(nullptr) : Json(scene_file.soil_name)},
          {"friction", wordFor(kFrictionWords, scene_file.bed.soil.friction)},
          {"body", scene_file.body},
          {"particles", scene.bed().particles()},
          {"finest", finestJson(summary.finest)},
          {"held", scene.bed().heldParticles()},  // permanently, at the ends of the box
          {"awake", scene.bed().awake()},
          {"substeps", scene.substeps()},
          {"threads", scene_file.bed.threads},
          {"simd", simdTarget()},
          {"arithmetic", arithmetic()},
          {"ticks", statistics.ticks()},
          {"duration_s", loop.time()},
          {"ended", text(summary.end)},
          {"tick_us", histogramJsonWithBuckets(statistics.tickUs())},
          {"late_us", scene_file.loop.real_time ? histogramJsonWithBuckets(statistics.lateUs()) : Json(nullptr)},
          {"deadline_misses", scene_file.loop.real_time ? Json(statistics.deadlineMisses()) : Json(nullptr)},
          {"misses_too_long", misses(Miss::kTooLong)},
          {"misses_woken_late", misses(Miss::kWokenLate)},
          {"misses_preempted", misses(Miss::kPreempted)},
          {"advice", summary.advice.empty() ? Json(nullptr) : Json(summary.advice)},
          {"success_rate_last_100", scene_file.loop.real_time ? Json(statistics.successRate()) : Json(nullptr)},
          {"force_n", statisticsJson(statistics.forceN())},
          {"torque_nm", statisticsJson(statistics.torqueNm())},
          {"largest_speed_m_s", scene.bed().largestSpeed()},
          {"lost_records", summary.lost_records},
          {"device_input", summary.device_input.empty() ? Json(nullptr) : Json(summary.device_input)},
          {"tools", toolsJson(scene_file, scene)},
          {"state_hash", fmt::format("{:016x}", scene.hash())},
          {"realtime",
           {{"scheduler", summary.real_time.scheduler},
            {"memory_locked", summary.real_time.memory_locked},
            {"cpu", summary.real_time.cpu == kAnyCpu ? Json(nullptr) : Json(summary.real_time.cpu)}}}};
}

std::string summaryText(const SceneFile& scene_file, const Scene& scene, const HapticLoop& loop,
                        const RunSummary& summary) {
  const LoopStatistics& s = loop.statistics();
  const Histogram& t = s.tickUs();
  return fmt::format(
      "{title}\n  soil       {grains}, {soil}, g = {g:g} m/s2, {substeps} per tick; {awake} awake at the end\n  time   "
      "    {time:.3f} s in {ticks} ticks: {end}\n  tick       mean {mean:.1f}  p50 {p50:.1f}  p99 {p99:.1f}  p99.9 "
      "{p999:.1f}  max {max:.1f} us ({simd}, {threads})\n{wakeup}  deadlines  {deadlines}; {scheduler}{cpu}, memory "
      "{locked}\n  force      mean {fmean:.2f}  p99 {fp99:.2f}  max {fmax:.2f} N\n  torque     mean {mmean:.4f}  p99 "
      "{mp99:.4f}  max {mmax:.4f} N m\n{tools}{packets}  state      {hash:016x}\n",
      fmt::arg("title", scene_file.title), fmt::arg("grains", grainsText(scene.bed())),
      fmt::arg("awake", scene.bed().awake()), fmt::arg("soil", soilText(scene_file)),
      fmt::arg("g", scene_file.bed.gravity_m_s2.norm()), fmt::arg("substeps", pluralise(scene.substeps(), "substep")),
      fmt::arg("time", loop.time()), fmt::arg("ticks", s.ticks()), fmt::arg("end", text(summary.end)),
      fmt::arg("mean", t.mean()), fmt::arg("p50", t.percentile(0.5)), fmt::arg("p99", t.percentile(0.99)),
      fmt::arg("p999", t.percentile(0.999)), fmt::arg("max", t.max()),
      fmt::arg("simd", instructionSetName(simdTarget())),
      fmt::arg("threads", pluralise(scene_file.bed.threads, "thread")),
      fmt::arg("deadlines", scene_file.loop.real_time ? deadlinesText(s) : "none: not in real time"),
      fmt::arg("scheduler", summary.real_time.scheduler),
      fmt::arg("cpu", summary.real_time.cpu == kAnyCpu ? "" : fmt::format(" on CPU {}", summary.real_time.cpu)),
      fmt::arg("wakeup", wakeUpText(s.lateUs())),
      fmt::arg("locked", summary.real_time.memory_locked ? "locked" : "not locked"),
      fmt::arg("fmean", s.forceN().mean()), fmt::arg("fp99", s.forceN().percentile(0.99)),
      fmt::arg("fmax", s.forceN().max()), fmt::arg("mmean", s.torqueNm().mean()),
      fmt::arg("mp99", s.torqueNm().percentile(0.99)), fmt::arg("mmax", s.torqueNm().max()),
      fmt::arg("tools", toolsText(scene_file, scene)),
      fmt::arg("packets", summary.device_input.empty() ? "" : fmt::format("  packets    {}\n", summary.device_input)),
      fmt::arg("hash", scene.hash()));
}

}  // namespace haptolith

#include "haptolith/lammps/lammps_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "haptolith/bed/start/bed_tile.h"
#include "haptolith/core/error.h"
#include "haptolith/core/movement.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/lammps/tool_spheres.h"

namespace haptolith {

namespace {

constexpr double kToolTold_s = 1e-3;     ///< period of printed mean forces on the tool
constexpr double kKey_s = 0.01;          ///< from pose to pose of the tool
constexpr double kMostSphere = 1.0 / 3;  ///< largest sphere of a tool, in radii of the soil

double densityOf(double mass_kg, double radius_m) {
  return mass_kg / (4.0 / 3 * std::numbers::pi * radius_m * radius_m * radius_m);
}

std::vector<int> kindsOf(const Bed& bed, const LammpsRun& run) {
  if (!run.kinds.empty()) {
    return run.kinds;
  }
  std::vector<int> kinds(bed.particles(), LammpsRun::kSoil);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    kinds[i] = bed.state().isHeld(i) ? LammpsRun::kHeld : LammpsRun::kSoil;
  }
  return kinds;
}

/// The sizes that grains have where a table is needed, which knows distances and not radii.
class SizeBins {
 public:
  SizeBins(const SoilParameters& soil, bool needs_table)
      : half_m_(soil.size_spread * soil.radius_m),
        count_(needs_table && half_m_ > 0 ? kMost : 1),
        quantised_(needs_table) {}

  [[nodiscard]] int count() const noexcept { return count_; }
  /// 0 is that of the smallest.
  [[nodiscard]] int of(double excess_m) const noexcept {
    const double place = half_m_ > 0 ? (excess_m / half_m_ + 1) / 2 : 0.5;
    return std::clamp(static_cast<int>(place * count_), 0, count_ - 1);
  }
  /// By how much a grain's radius exceeds R in LAMMPS.
  [[nodiscard]] double sizeOf(double excess_m) const noexcept {
    return quantised_ ? more(2 * of(excess_m)) / 2 : excess_m;
  }
  /// By how much two grains' radii, of bins that add up to `both`, exceed 2 R.
  [[nodiscard]] double more(int both) const noexcept {
    return half_m_ * (static_cast<double>(2 * both + 2) / count_ - 2);
  }

 private:
  static constexpr int kMost = 11;

  double half_m_;
  int count_;
  bool quantised_;
};

std::string tableName(int both) {
  return fmt::format("REST_{}", both);
}

/// Up to what distance grains act on each other, in m.
double reachOf(const Bed& bed, const GranularLaw& law, double more_m) {
  return std::max(bed.law().cutoff_m, bed.law().diameter_m + 2 * law.larger_m) + more_m;
}

/// restForce() of each sum of two bins.
std::string tableText(const Bed& bed, const GranularLaw& law, const SizeBins& bins) {
  constexpr int kRows = 2000;
  std::string text =
      "# Difference between haptolith's contact law and `granular`, over the distance of two particles.\n";
  for (int both = 0; both <= 2 * (bins.count() - 1); ++both) {
    const double more_m = bins.more(both);
    const double first_m = bed.law().diameter_m / 2, last_m = reachOf(bed, law, more_m);
    const double step_m = (last_m - first_m) / (kRows - 1);
    std::vector<double> force_n(kRows), energy_j(kRows);
    for (int row = kRows - 2; row >= 0; --row) {  // nothing at the end
      const auto at = static_cast<std::size_t>(row);
      force_n[at] = restForce(law, bed.law(), more_m, first_m + row * step_m);
      energy_j[at] = energy_j[at + 1] + step_m * (force_n[at] + force_n[at + 1]) / 2;
    }
    fmt::format_to(std::back_inserter(text), "\n{}\nN {} R {:.9g} {:.9g}\n\n", tableName(both), kRows, first_m, last_m);
    for (int row = 0; row < kRows; ++row) {
      const auto at = static_cast<std::size_t>(row);
      fmt::format_to(std::back_inserter(text), "{} {:.9g} {:.9g} {:.9g}\n", row + 1, first_m + row * step_m,
                     energy_j[at], force_n[at]);
    }
  }
  return text;
}

void appendAtom(std::string& text, std::size_t id, int type, double radius_m, double density, const Vec3& centre) {
  fmt::format_to(std::back_inserter(text), "{} {} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", id, type, 2 * radius_m,
                 density, centre.x(), centre.y(), centre.z());
}

struct Box {
  double half_width_m, half_length_m;  ///< half size of the walls, or of the period
};
Box boxOf(const BedParameters& bed) {
  const double held_m = heldWidth(bed);
  return {bed.width_m / 2 + (bed.periodic_x ? 0 : held_m), bed.length_m / 2 + (bed.periodic_y ? 0 : held_m)};
}

std::string dataText(const Bed& bed, const LammpsRun& run, const LammpsFiles& files, const ToolSpheres& spheres) {
  const std::vector<int> kinds = kindsOf(bed, run);
  const SizeBins bins(bed.parameters().soil, !files.law.exact);
  const BedParameters& parameters = bed.parameters();
  const double radius_m = parameters.soil.radius_m;
  const Box box = boxOf(parameters);
  // A wall lets grains stand in it by less than their radius; a tool may begin, and move, outside the box.
  double x_m = box.half_width_m + (parameters.periodic_x ? 0 : 2 * radius_m);
  double y_m = box.half_length_m + (parameters.periodic_y ? 0 : 2 * radius_m);
  double top_m = bed.surfaceHeight() + 4 * radius_m;
  double bottom_m = -2 * radius_m;
  double reach_m = 0;
  for (const Vec3& centre : spheres.centres_tool_m) {
    reach_m = std::max(reach_m, centre.norm() + spheres.radius_m);
  }
  for (const TimedPose& at : run.path) {
    const Vec3& place_m = at.pose.position_m;
    x_m = parameters.periodic_x ? x_m : std::max(x_m, std::abs(place_m.x()) + reach_m);
    y_m = parameters.periodic_y ? y_m : std::max(y_m, std::abs(place_m.y()) + reach_m);
    top_m = std::max(top_m, place_m.z() + reach_m);
    bottom_m = std::min(bottom_m, place_m.z() - reach_m);
  }
  const int most = files.typeOf(std::max(static_cast<int>(LammpsRun::kTool), *std::ranges::max_element(kinds)));
  std::string text = fmt::format(
      "{}\n\n{} atoms\n{} atom types\n{:.9g} {:.9g} xlo xhi\n{:.9g} {:.9g} ylo yhi\n{:.9g} {:.9g} zlo zhi\n\nAtoms # "
      "sphere\n\n",
      plainText(run.program), bed.particles() + spheres.centres_tool_m.size(), most, -x_m, x_m, -y_m, y_m, bottom_m,
      top_m);
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& p = bed.state().position[i];
    const double grain_m = radius_m + bins.sizeOf(p.w) + files.law.larger_m;
    const int type = kinds[i] == LammpsRun::kSoil ? 1 + bins.of(p.w) : files.typeOf(kinds[i]);
    appendAtom(text, i + 1, type, grain_m, densityOf(bed.mass(), grain_m), {p.x, p.y, p.z});
  }
  const Pose start = run.path.empty() ? Pose{} : run.path.front().pose;
  for (std::size_t i = 0; i < spheres.centres_tool_m.size(); ++i) {
    appendAtom(text, bed.particles() + i + 1, files.typeOf(LammpsRun::kTool), spheres.radius_m,
               parameters.soil.rho0_kg_m3, start.position_m + start.orientation * spheres.centres_tool_m[i]);
  }
  text += "\nVelocities\n\n";
  for (std::size_t i = 0; i < bed.particles() + spheres.centres_tool_m.size(); ++i) {
    const Float4 v = i < bed.particles() ? bed.state().velocity[i] : Float4{};
    fmt::format_to(std::back_inserter(text), "{} {:.9g} {:.9g} {:.9g} 0 0 0\n", i + 1, v.x, v.y, v.z);
  }
  return text;
}

std::string remarks(const GranularLaw& law, const ToolSpheres& spheres) {
  std::string text =
      "# As in haptolith: positions and masses; particles without rotation; gravity; walls and floor, which\n# act as "
      "mirror images of particles; Cundall and Strack's friction; the time step.\n";
  if (law.own) {
    text +=
        "# Also as in haptolith: sizes, and the law of contacts, damping and cohesion, including walls.\n# Radii are "
        "increased by half the range of cohesion; soil.lammpstrj has the true radii.\n";
  } else if (law.exact) {
    text += "# Also as in haptolith: sizes, and the contact law, a spring and a damper without tension.\n";
  } else {
    text += fmt::format(
        "# As in haptolith except for the sizes, of which there are at most eleven: the normal force, from Hertz' law "
        "and a table.\n# APPROXIMATE: the friction limit uses Hertz' part, with an error of {:.0f} % (RMS) in this "
        "bed; walls are\n# springs without cohesion. Effect on the strength of the soil: docs/reports/lammps.md\n",
        100 * law.spread_of_fit);
  }
  if (!law.own) {
    text += "# Different: in a sliding contact, LAMMPS adds the damper's force to the spring.\n";
  }
  text += "# The slip of contacts restarts at zero.\n";
  if (!spheres.centres_tool_m.empty()) {
    text += fmt::format(
        "# The tool is {} spheres of R = {:.3g} mm just under its surface, with a stiffness that matches the tool\n# "
        "at an overlap of a twentieth of the radius.\n",
        spheres.centres_tool_m.size(), 1e3 * spheres.radius_m);
  }
  return text;
}

std::string setupText(const Bed& bed, const LammpsRun& run, const LammpsFiles& files, const ToolSpheres& spheres) {
  const BedParameters& parameters = bed.parameters();
  const GranularLaw& law = files.law;
  const SizeBins bins(parameters.soil, !law.exact);
  const bool has_tool = !spheres.centres_tool_m.empty();
  const Vec3& gravity = parameters.gravity_m_s2;
  const Box box = boxOf(parameters);
  std::string text = fmt::format(
      "# '{}', by {}\n# LAMMPS {}, with the package GRANULAR: lmp -in in.haptolith\n#                                  "
      "                 mpirun -np 4 lmp -in in.haptolith\n# SI units. z is up, the floor at z = 0, x = y = 0 at the "
      "centre of the box.\n{}",
      plainText(run.title), plainText(run.program),
      law.own ? "2023 or newer, built with haptolith's contact law (extras/lammps)"
              : "September 2021 (Debian 12) or newer",
      remarks(law, spheres));
  const auto add = [&text]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
    text += '\n';
  };
  add("\nunits           si\natom_style      sphere");
  add("boundary        {} {} fm", parameters.periodic_x ? 'p' : 'f', parameters.periodic_y ? 'p' : 'f');
  add("newton          off\ncomm_modify     vel yes\nprocessors      * * 1\nread_data       bed.data");
  const int tool_type = files.typeOf(LammpsRun::kTool), held_type = files.typeOf(LammpsRun::kHeld);
  add("group           soil type 1:{}", files.soil_types);
  add("group           held type {}", held_type);
  add("neighbor        {:.6g} bin", parameters.soil.radius_m / 2);
  add("neigh_modify    delay 0 every 1 check yes");
  add("neigh_modify    exclude group held held");
  add("timestep        {:.10g}", run.dt_s);
  const std::vector<int> kinds = kindsOf(bed, run);
  const int most_kind = *std::ranges::max_element(kinds);
  const char* granular = law.exact ? "" : " granular";
  add("pair_style      {}", law.exact ? "granular" : "hybrid/overlay granular table linear 4000");
  add("pair_coeff      * *{} {}", granular, law.betweenGrains());
  if (has_tool) {
    // As they were before radii were changed: the distance at which a grain and a sphere touch is the same.
    ToolSpheres before = spheres;
    before.radius_m += law.larger_m;
    const SpheresUnderAGrain under = spheresUnderAGrain(before, *run.tool, parameters.soil.radius_m);
    const GranularContact tool = granularContact(*run.tool, parameters.soil, run.dt_s, under);
    add("group           tool type {}", tool_type);
    add("neigh_modify    exclude group tool tool\nneigh_modify    exclude group held tool");
    add("pair_coeff      1*{} {}{} {}", held_type, tool_type, granular, tool.text());
  }
  if (!law.exact) {
    const auto rest = [&](int one, const std::string& other, int both) {
      add("pair_coeff      {} {} table rest.table {} {:.9g}", one, other, tableName(both),
          reachOf(bed, law, bins.more(both)));
    };
    const int middle = bins.count() / 2;
    for (int one = 0; one < bins.count(); ++one) {
      for (int other = one; other < bins.count(); ++other) {
        rest(one + 1, fmt::format("{}", other + 1), one + other);
      }
      rest(one + 1, fmt::format("{}", held_type), one + middle);
      if (most_kind >= LammpsRun::kBody) {
        rest(one + 1, fmt::format("{}*{}", files.typeOf(LammpsRun::kBody), files.typeOf(most_kind)), one + middle);
      }
    }
  }
  if (gravity.norm() > 0) {
    add("fix             gravity soil gravity {:.9g} vector {:.9g} {:.9g} {:.9g}", gravity.norm(), gravity.x(),
        gravity.y(), gravity.z());
  }
  add("fix             motion soil nve   # not nve/sphere: nothing turns");
  add("fix             floor soil wall/gran granular {} zplane {:.9g} NULL", law.atWall(1), 0.0 - law.wall_behind_m);
  const std::string side = law.atWall(wallRatio(parameters));
  if (!parameters.periodic_x) {
    add("fix             walls_x soil wall/gran granular {} xplane {:.9g} {:.9g}", side,
        -box.half_width_m - law.wall_behind_m, box.half_width_m + law.wall_behind_m);
  }
  if (!parameters.periodic_y) {
    add("fix             walls_y soil wall/gran granular {} yplane {:.9g} {:.9g}", side,
        -box.half_length_m - law.wall_behind_m, box.half_length_m + law.wall_behind_m);
  }
  add("fix             even all balance 1000 1.1 shift xy 10 1.05   # for mpirun: as many grains on each rank");
  add("thermo          {}", std::max(1L, std::lround(0.1 / run.dt_s)));
  add("variable        type atom gmask(soil)+2*gmask(held){}", has_tool ? "+3*gmask(tool)" : "");
  add("compute         sphere all property/atom radius\nvariable        radius atom c_sphere{:+.9g}   # the grains'",
      0.0 - law.larger_m);
  add("dump            soil all custom {} soil.lammpstrj id v_type x y z v_radius vx vy vz",
      std::max(1L, std::lround(run.dump_every_s / run.dt_s)));
  add("dump_modify     soil time yes");
  return text;
}

/// One of the tool's poses, as commands.
struct Key {
  Pose pose;
  Vec3 velocity, turning;
  long steps;
};

std::vector<Key> keysOf(const LammpsRun& run) {
  std::vector<Key> keys;
  const double begin_s = run.path.front().time_s;
  long done = 0;
  TimedPose from = run.path.front();
  for (std::size_t i = 1; i < run.path.size(); ++i) {
    const TimedPose& to = run.path[i];
    const bool last = i + 1 == run.path.size();
    if (to.time_s < from.time_s + kKey_s && !last) {
      continue;
    }
    const long until = std::lround((to.time_s - begin_s) / run.dt_s);
    if (until > done) {
      const double lasts_s = static_cast<double>(until - done) * run.dt_s;
      keys.push_back({from.pose, (to.pose.position_m - from.pose.position_m) / lasts_s,
                      rotationBetween(from.pose.orientation, to.pose.orientation) / lasts_s, until - done});
      done = until;
      from = to;
    }
  }
  return keys;
}

std::string pathText(const LammpsRun& run) {
  const long told = std::max(1L, std::lround(kToolTold_s / run.dt_s));
  std::string text = fmt::format(R"(
# The tool: v + omega x (r - p), with v, omega and p of the line below that is under way. tool.txt has, every ms, the mean
# force of the soil on the tool and its torque about the tool's origin, and where that is.
variable        tx equal v_px+v_vx*(step-v_since)*dt
variable        ty equal v_py+v_vy*(step-v_since)*dt
variable        tz equal v_pz+v_vz*(step-v_since)*dt
variable        ux atom v_vx+v_wy*(z-v_tz)-v_wz*(y-v_ty)
variable        uy atom v_vy+v_wz*(x-v_tx)-v_wx*(z-v_tz)
variable        uz atom v_vz+v_wx*(y-v_ty)-v_wy*(x-v_tx)
variable        mx atom (y-v_ty)*fz-(z-v_tz)*fy
variable        my atom (z-v_tz)*fx-(x-v_tx)*fz
variable        mz atom (x-v_tx)*fy-(y-v_ty)*fx
fix             tool_moves tool move variable NULL NULL NULL v_ux v_uy v_uz
compute         on_tool tool reduce sum fx fy fz v_mx v_my v_mz
variable        t_s equal step*dt
fix             told all ave/time 1 {0} {0} v_t_s c_on_tool[1] c_on_tool[2] c_on_tool[3] c_on_tool[4] c_on_tool[5] c_on_tool[6] v_tx v_ty v_tz file tool.txt
thermo_style    custom step time ke c_on_tool[1] c_on_tool[2] c_on_tool[3]

)",
                                 told);
  long since = 0;
  bool first = true;
  for (const Key& key : keysOf(run)) {
    const Vec3 &p = key.pose.position_m, &v = key.velocity, &w = key.turning;
    fmt::format_to(std::back_inserter(text),
                   "variable since equal {}\nvariable px equal {:.9g}\nvariable py equal {:.9g}\nvariable pz equal "
                   "{:.9g}\nvariable vx equal {:.9g}\nvariable vy equal {:.9g}\nvariable vz equal {:.9g}\nvariable wx "
                   "equal {:.9g}\nvariable wy equal {:.9g}\nvariable wz equal {:.9g}\nrun {}{}\n",
                   since, p.x(), p.y(), p.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z(), key.steps,
                   first ? "" : " pre no post no");
    since += key.steps;
    first = false;
  }
  return text;
}

}  // namespace

LammpsFiles lammpsFiles(const Bed& bed, const LammpsRun& run) {
  LammpsFiles files;
  files.law = granularLaw(bed, run.law);
  const SizeBins bins(bed.parameters().soil, !files.law.exact);
  files.soil_types = bins.count();
  ToolSpheres spheres;
  if (run.tool != nullptr) {
    if (run.tool->shape == ToolShape::kJaws) {
      throw InvalidParameter("tool.shape", "jaws", "a tool of one rigid body: jaws open, and are not exported");
    }
    if (run.path.size() < 2) {
      throw InvalidParameter("path", fmt::format("{} poses", run.path.size()), "at least 2");
    }
    spheres = toolSpheres(*run.tool, 0, kMostSphere * bed.parameters().soil.radius_m);
    constexpr double kLeast_m = 1e-5;  // grains that are larger by more than that meet the tool too early
    spheres.radius_m = std::max(kLeast_m, spheres.radius_m - files.law.larger_m);
  }
  files.tool_spheres = spheres.centres_tool_m.size();
  files.data = dataText(bed, run, files, spheres);
  files.table = files.law.exact ? "" : tableText(bed, files.law, bins);
  files.setup = setupText(bed, run, files, spheres);
  files.path = run.tool == nullptr
                   ? fmt::format("\nrun             {}\n", std::max(1L, std::lround(run.duration_s / run.dt_s)))
                   : pathText(run);
  return files;
}

}  // namespace haptolith

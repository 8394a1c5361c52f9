// Scenes for the comparison with another discrete-element engine: writes the initial state of each for the other
// engine, and runs it. See README.md. Contact friction with a linear spring, and only spheres: floors, plates, the
// blade and the tray consist of driven particles, so that wall models have no effect.

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/lab/apparatus/lab_bed.h"
#include "haptolith/lammps/lammps_export.h"
#include "haptolith/scene_file/soil_file.h"
#include "haptolith/soil/contact_law.h"

namespace haptolith {
namespace {

constexpr int kRows = 400;  // rows of a curve; each is a mean over its part of the time

/// Speed along x at a time; linear in between, constant after the last.
struct Knot {
  double time_s, speed_m_s;
};

/// Servo for the load on a plate that is free to rise and sink, as in the laboratory's shear test.
struct Servo {
  double load_n, mass_kg, damping_n_s_m, fastest_m_s;
};

/// Initial state and movement of a comparison. The last body moves, the others are fixed.
struct Scene {
  LabConditions conditions;
  LabBox box;
  std::vector<Vec3> soil_m{};
  std::vector<std::vector<Vec3>> bodies_m{};
  std::vector<Vec3> soil_velocity_m_s{};  ///< empty: at rest
  std::vector<Knot> movement{};
  std::optional<Servo> servo{};
  double duration_s = 0;
  /// Indices of soil particles that are attached to each body. If cohesion in the other engine is different, the soil
  /// would
  /// otherwise slip on the plates instead of shearing internally.
  std::vector<std::vector<std::size_t>> glued{};
  /// Height below which soil has been spilled and no longer matters; the other engine leaves it out.
  double spilled_below_m = -std::numeric_limits<double>::max();
};

/// Returns soil with linear springs F = k (2R - a): gamma = k (2R - a_min)^2 makes the hyperbola of eq. (7) in icra2021
/// nowhere softer than its line.
SoilParameters linearSoil(double damping_ratio) {
  SoilParameters soil;
  soil.friction = FrictionModel::kContact;
  soil.radius_m = 7e-3;
  soil.rho0_kg_m3 = 1330;
  soil.attraction_ratio = 1;
  soil.contact_cohesion_n = 0;
  soil.contact_friction = 0.5;
  soil.tangential_ratio = 0.5;
  soil.damping_ratio = damping_ratio;
  soil.size_spread = 0.2;
  soil.stiffness_n_m = std::numeric_limits<double>::infinity();
  const double overlap_m = 2 * soil.radius_m - makeContactLaw(soil).a_min_m;
  soil.stiffness_n_m = 1000;
  soil.gamma_nm = soil.stiffness_n_m * overlap_m * overlap_m;
  return soil;
}

double speedAt(const std::vector<Knot>& movement, double time_s) {
  for (std::size_t i = 1; i < movement.size(); ++i) {
    const Knot& from = movement[i - 1];
    const Knot& to = movement[i];
    if (time_s < to.time_s) {
      return from.speed_m_s + (to.speed_m_s - from.speed_m_s) * (time_s - from.time_s) / (to.time_s - from.time_s);
    }
  }
  return movement.back().speed_m_s;
}

/// Movement of the driven body, identical in both engines.
class Driver {
 public:
  explicit Driver(const Scene& scene) : scene_(scene) {}
  /// Returns the velocity for a step, from the force of the previous step.
  Vec3 velocityAt(double time_s, double dt_s, double soil_n) {
    if (scene_.servo) {
      const Servo& servo = *scene_.servo;
      sinking_m_s_ += dt_s / servo.mass_kg * (soil_n - servo.load_n - servo.damping_n_s_m * sinking_m_s_);
      sinking_m_s_ = std::clamp(sinking_m_s_, -servo.fastest_m_s, servo.fastest_m_s);
    }
    return {speedAt(scene_.movement, time_s), 0, sinking_m_s_};
  }
  [[nodiscard]] double verticalSpeed() const { return sinking_m_s_; }

 private:
  const Scene& scene_;
  double sinking_m_s_ = 0;
};

/// Two particles; the upper one falls obliquely, without gravity.
Scene impact(const LabConditions& conditions) {
  Scene scene{.conditions = conditions,
              .box = {.width_m = 0.2, .length_m = 0.2, .periodic_x = true, .periodic_y = true}};
  scene.conditions.gravity_m_s2 = 0;
  scene.soil_m = {{0.002, 0.001, 0.0655}, {0, 0, 0.05}};
  scene.soil_velocity_m_s = {{0.05, -0.1, -0.3}, {0, 0, 0}};
  scene.bodies_m = {{{0.05, 0.05, 0.02}}};  // far away; the driven body that each scene requires
  scene.movement = {{0, 0}};
  scene.duration_s = 0.08;
  return scene;
}

/// Particle on two rails of particles that move away under it: sticks, slips, and passes over them without rotating.
Scene slide(const LabConditions& conditions) {
  Scene scene{.conditions = conditions,
              .box = {.width_m = 0.14, .length_m = 0.1, .periodic_x = true, .periodic_y = true}};
  const double r = conditions.soil.radius_m;
  std::vector<Vec3> rails;
  for (int i = 0; i < 20; ++i) {
    rails.emplace_back(-0.07 + 0.007 * i, -0.9 * r, 0.05);
    rails.emplace_back(-0.07 + 0.007 * i, 0.9 * r, 0.05);
  }
  scene.soil_m = {{0.0012, 0, 0.0625}};
  scene.bodies_m = {rails};
  scene.movement = {{0, 0}, {0.1, 0}, {0.15, 0.08}, {0.4, 0.08}};
  scene.duration_s = 0.4;
  return scene;
}

/// Ten particles that fall onto a rough plate between walls.
Scene ten(const LabConditions& conditions) {
  const SoilParameters& soil = conditions.soil;
  const double d = 2 * soil.radius_m;
  Scene scene{.conditions = conditions, .box = {.width_m = 4 * d, .length_m = 4 * d, .wall_friction_ratio = 1}};
  scene.soil_m = looseSoil(soil, scene.box, 10, 3 * d, conditions.seed);
  scene.soil_m.resize(10);
  scene.bodies_m = {roughPlate(soil, scene.box, d, conditions.seed + 1)};
  scene.movement = {{0, 0}};
  scene.duration_s = 1.5;
  return scene;
}

/// Column of 256 loosely poured particles, five wide, between rough walls; it falls onto a rough plate.
Scene column(const LabConditions& conditions) {
  const SoilParameters& soil = conditions.soil;
  const double d = 2 * soil.radius_m;
  Scene scene{.conditions = conditions, .box = {.width_m = 5.5 * d, .length_m = 5.5 * d, .wall_friction_ratio = 1}};
  scene.soil_m = looseSoil(soil, scene.box, 256, 2.5 * d, conditions.seed);
  scene.soil_m.resize(256);
  scene.bodies_m = {roughPlate(soil, scene.box, d, conditions.seed + 1)};
  scene.movement = {{0, 0}};
  scene.duration_s = 3;
  return scene;
}

/// Copies the settled positions, with everything at rest and without contact history.
void takePlaces(const LabBed& lab, Scene& scene) {
  scene.soil_m = lab.soilCentres();
  std::size_t next = lab.soil();
  for (std::vector<Vec3>& body : scene.bodies_m) {
    for (Vec3& centre : body) {
      centre = lab.centre(next++);
    }
  }
}

double normal_pa = 500;  // normal stress of `shear`; the last argument can change it

/// Size in particle diameters, and displacement of a plate relative to the height.
struct ShearCell {
  double width = 20, length = 12, height = 8, strain = 4;
};

/// Soil under constant load between two rough plates, periodic in x and y, without gravity, as in the laboratory's
/// shear.cpp.
Scene shear(const LabConditions& conditions, const ShearCell& cell) {
  constexpr double kInertialNumber = 0.02;
  constexpr double kRest_s = 0.3;
  const SoilParameters& soil = conditions.soil;
  const double d = 2 * soil.radius_m;
  Scene scene{.conditions = conditions,
              .box = {.width_m = cell.width * d, .length_m = cell.length * d, .periodic_x = true, .periodic_y = true}};
  const double area = scene.box.width_m * scene.box.length_m;
  scene.soil_m = looseSoil(soil, scene.box, particlesFor(soil, area * cell.height * d), 2 * d, conditions.seed);
  scene.bodies_m = {roughPlate(soil, scene.box, d, conditions.seed + 1),
                    roughPlate(soil, scene.box, scene.soil_m.back().z() + 2.5 * d, conditions.seed + 2)};
  const double mass = macroparticleMass(soil) * area / (d * d);
  scene.servo = Servo{.load_n = normal_pa * area,
                      .mass_kg = mass,
                      .damping_n_s_m = 0.1 * std::sqrt(mass * soil.stiffness_n_m * area) / d,
                      .fastest_m_s = 0.15};
  scene.movement = {{0, 0}};

  LabBed lab(scene.conditions, scene.box, scene.soil_m, scene.bodies_m);
  lab.settle();
  lab.bed().setGravity(Vec3::Zero());
  scene.conditions.gravity_m_s2 = 0;
  Driver driver(scene);
  const auto lower = [&] { lab.moveBody(1, driver.velocityAt(0, lab.dt(), lab.forceOnBody(1).z())); };
  do {
    lab.run(0.2, "the plate comes down", lower);
  } while (std::abs(lab.forceOnBody(1).z() - scene.servo->load_n) > 0.02 * scene.servo->load_n ||
           std::abs(driver.verticalSpeed()) > 1e-4);
  takePlaces(lab, scene);

  const double height = lab.centreOfBody(1).z() - lab.centreOfBody(0).z();
  const double speed = kInertialNumber * height / d * std::sqrt(normal_pa / soil.rho0_kg_m3);
  const double lasts = cell.strain * height / speed;
  scene.movement = {{0, 0}, {kRest_s, 0}, {kRest_s + 0.02 * lasts, speed}};
  scene.duration_s = kRest_s + 1.01 * lasts;  // 0.01: duration of the start
  return scene;
}

/// Plate drawn through a settled bed on a rough floor, periodic in x and y.
Scene blade(const LabConditions& conditions) {
  constexpr double kSpacing = 1.6;
  const SoilParameters& soil = conditions.soil;
  const double r = soil.radius_m;
  const double d = 2 * r;
  Scene scene{.conditions = conditions,
              .box = {.width_m = 20 * d, .length_m = 12 * d, .periodic_x = true, .periodic_y = true}};
  const double depth = 7 * d;
  std::vector<Vec3> sheet;
  const double floor_m = 2 * r;
  for (int column = 0; column < 9; ++column) {
    for (int row = 0; row < 9; ++row) {
      sheet.emplace_back(-6 * d, (column - 4) * kSpacing * r, floor_m + 4 * d + row * kSpacing * r);
    }
  }
  const auto clear_of_blade = [&](const Vec3& centre) {
    return std::abs(centre.x() + 6 * d) > 2.5 * r || std::abs(centre.y()) > 8.6 * r || centre.z() < floor_m + 2.7 * d;
  };
  const double volume = scene.box.width_m * scene.box.length_m * depth;
  scene.soil_m = looseSoil(soil, scene.box, particlesFor(soil, volume), floor_m + d, conditions.seed, clear_of_blade);
  scene.bodies_m = {roughPlate(soil, scene.box, floor_m, conditions.seed + 1), sheet};
  LabBed lab(conditions, scene.box, scene.soil_m, scene.bodies_m);
  lab.settle();
  takePlaces(lab, scene);
  constexpr double kSpeed_m_s = 0.1;
  scene.movement = {{0, 0}, {0.3, 0}, {0.35, kSpeed_m_s}};
  scene.duration_s = 0.35 + 0.16 / kSpeed_m_s;
  return scene;
}

/// Tray with soil above its rim. The soil slumps and spills while the tray is at rest, and again when it is moved
/// sideways at 0.1 m/s.
Scene carry(const LabConditions& conditions) {
  constexpr double kSpacing = 1.6;
  const SoilParameters& soil = conditions.soil;
  const double r = soil.radius_m;
  const double d = 2 * r;
  Scene scene{.conditions = conditions,
              .box = {.width_m = 36 * d, .length_m = 26 * d, .periodic_x = true, .periodic_y = true}};
  const double floor_m = 14 * d;
  const int columns = 16, rows = 14, brim = 2, collar = 22;
  const double pitch = kSpacing * r;
  const double half_width = (columns - 1) / 2.0 * pitch;
  const double half_length = (rows - 1) / 2.0 * pitch;
  std::vector<Vec3> tray, forming;  // the collar forms the soil and is removed
  for (int column = 0; column < columns; ++column) {
    for (int row = 0; row < rows; ++row) {
      const bool is_rim = column == 0 || column == columns - 1 || row == 0 || row == rows - 1;
      for (int storey = 0; storey < (is_rim ? collar : 1); ++storey) {
        (storey < brim ? tray : forming)
            .emplace_back(column * pitch - half_width, row * pitch - half_length, floor_m + storey * pitch);
      }
    }
  }
  const auto above_tray = [&](const Vec3& centre) {
    return std::abs(centre.x()) < half_width - 2.2 * r && std::abs(centre.y()) < half_length - 2.2 * r;
  };
  const double volume = 4 * (half_width - r) * (half_length - r) * 9 * d;
  scene.soil_m = looseSoil(soil, scene.box, particlesFor(soil, volume), floor_m + d, conditions.seed, above_tray);
  LabBed lab(conditions, scene.box, scene.soil_m, {tray, forming});
  lab.settle();
  scene.bodies_m = {tray};
  takePlaces(lab, scene);
  constexpr double kSpeed_m_s = 0.1;
  scene.movement = {{0, 0}, {1, 0}, {1.03, kSpeed_m_s}, {2.03, kSpeed_m_s}, {2.06, 0}};
  scene.duration_s = 2.4;
  scene.spilled_below_m = floor_m - 3 * d;
  return scene;
}

Scene sceneNamed(const std::string& name, const LabConditions& conditions) {
  if (name == "impact") return impact(conditions);
  if (name == "slide") return slide(conditions);
  if (name == "ten") return ten(conditions);
  if (name == "column") return column(conditions);
  if (name == "shear") return shear(conditions, {});
  if (name == "small-shear") return shear(conditions, {.width = 10, .length = 6, .height = 8, .strain = 0.6});
  if (name == "blade") return blade(conditions);
  if (name == "carry") return carry(conditions);
  throw std::invalid_argument("no scene \"" + name +
                              "\": impact, slide, ten, column, shear, small-shear, blade or carry");
}

/// Writes initial state and movement as JSON.
void writeScene(const std::filesystem::path& path, const Scene& scene, const LabBed& lab) {
  const SoilParameters& soil = scene.conditions.soil;
  std::ofstream out(path);
  const double damping = soil.damping_ratio * std::sqrt(2 * macroparticleMass(soil));
  const double tangential_n_m = soil.tangential_ratio * soil.stiffness_n_m;
  fmt::print(
      out,
      "{{\"dt_s\": {:.17g}, \"steps\": {}, \"steps_per_row\": {},\n\"gravity_m_s2\": {:.17g}, \"width_m\": {:.17g}, "
      "\"length_m\": {:.17g},\n\"mass_kg\": {:.17g}, \"radius_m\": {:.17g}, \"k_n_m\": {:.17g}, \"k_t_n_m\": "
      "{:.17g}, \"c_n_s_m\": {:.17g}, \"c_t_n_s_m\": {:.17g}, \"mu\": {:.17g},\n\"spilled_below_m\": {:.17g},\n",
      lab.dt(), std::lround(scene.duration_s / lab.dt()),
      std::max(1L, std::lround(scene.duration_s / lab.dt() / kRows)), scene.conditions.gravity_m_s2, scene.box.width_m,
      scene.box.length_m, lab.bed().mass(), soil.radius_m, soil.stiffness_n_m, tangential_n_m,
      damping * std::sqrt(soil.stiffness_n_m), damping * std::sqrt(tangential_n_m), soil.contact_friction,
      std::max(scene.spilled_below_m, -1e9));
  if (scene.servo) {
    const Servo& servo = *scene.servo;
    fmt::print(out,
               "\"servo\": {{\"load_n\": {:.17g}, \"mass_kg\": {:.17g}, \"damping_n_s_m\": {:.17g}, \"fastest_m_s\": "
               "{:.17g}}},\n",
               servo.load_n, servo.mass_kg, servo.damping_n_s_m, servo.fastest_m_s);
  }
  fmt::print(out, "\"movement\": [");
  for (std::size_t i = 0; i < scene.movement.size(); ++i) {
    fmt::print(out, "{}[{:.17g}, {:.17g}]", i ? ", " : "", scene.movement[i].time_s, scene.movement[i].speed_m_s);
  }
  fmt::print(out, "],\n\"particles\": [\n");  // x y z radius vx vy vz body: -1 is soil
  std::vector<int> body(scene.soil_m.size(), -1);
  for (std::size_t b = 0; b < scene.bodies_m.size(); ++b) {
    body.insert(body.end(), scene.bodies_m[b].size(), static_cast<int>(b));
  }
  const BedState& state = lab.bed().state();
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Float4& x = state.position[i];
    const Float4& v = state.velocity[i];
    fmt::print(out, "{}[{:.17g}, {:.17g}, {:.17g}, {:.17g}, {:.17g}, {:.17g}, {:.17g}, {}]", i ? ",\n" : "",
               static_cast<double>(x.x), static_cast<double>(x.y), static_cast<double>(x.z), soil.radius_m + x.w,
               static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z), body[i]);
  }
  fmt::print(out, "\n]}}\n");
}

/// Returns the speed of Driver::velocityAt() along x, as a formula of LAMMPS.
std::string speedFormula(const std::vector<Knot>& movement) {
  std::string text = fmt::format("(v_t>={:.9g})*{:.9g}", movement.back().time_s, movement.back().speed_m_s);
  for (std::size_t i = 1; i < movement.size(); ++i) {
    const Knot &from = movement[i - 1], &to = movement[i];
    text += fmt::format("+(v_t>={0:.9g})*(v_t<{1:.9g})*({2:.9g}+{3:.9g}*(v_t-{0:.9g}))", from.time_s, to.time_s,
                        from.speed_m_s, (to.speed_m_s - from.speed_m_s) / (to.time_s - from.time_s));
  }
  return text;
}

/// Attaches the two layers of soil next to each body to it.
void glue(Scene& scene, const LabBed& lab) {
  const double near_m = 4 * scene.conditions.soil.radius_m;
  for (std::size_t body = 0; body < scene.bodies_m.size(); ++body) {
    scene.glued.emplace_back();
    for (std::size_t i = 0; i < lab.soil(); ++i) {
      if (std::abs(lab.centre(i).z() - lab.centreOfBody(body).z()) < near_m) {
        scene.glued.back().push_back(i);
      }
    }
  }
}

/// Writes the scene for LAMMPS, as `haptolith export --format lammps` writes beds, and the movement of its bodies.
void writeLammps(const std::filesystem::path& folder, const Scene& scene, const LabBed& lab, LammpsLaw law) {
  LammpsRun run{.title = "a scene of benchmarks/peers",
                .program = "haptolith",
                .dt_s = lab.dt(),
                .duration_s = scene.duration_s,
                .dump_every_s = scene.duration_s,
                .law = law};
  run.kinds.assign(lab.soil(), LammpsRun::kSoil);
  int last = LammpsRun::kBody - 1;
  for (const std::vector<Vec3>& body : scene.bodies_m) {
    run.kinds.insert(run.kinds.end(), body.size(), ++last);
  }
  for (std::size_t body = 0; body < scene.glued.size(); ++body) {
    for (const std::size_t i : scene.glued[body]) {
      run.kinds[i] = LammpsRun::kBody + static_cast<int>(body);
    }
  }
  const LammpsFiles files = lammpsFiles(lab.bed(), run);
  const long steps_per_row = std::max(1L, std::lround(scene.duration_s / lab.dt() / kRows));
  const auto grains = scene.bodies_m.back().size() + (scene.glued.empty() ? 0 : scene.glued.back().size());
  std::string load = "0";
  std::string text = fmt::format(R"(
group           bodies type {0}:{1}
group           driven type {1}
group           first id 1
neigh_modify    exclude group bodies bodies
variable        t equal (step-1)*dt   # a step moves by the speed at its beginning
variable        vx equal {2}
variable        still equal 0
)",
                                 files.typeOf(LammpsRun::kBody), files.typeOf(last), speedFormula(scene.movement));
  if (scene.servo) {
    // The plate's mass is the sum of its spheres; each has its part of the load and of the damper, and the equal force.
    const Servo& servo = *scene.servo;
    load = fmt::format("{:.9g}+{:.9g}*vcm(driven,z)", servo.load_n, servo.damping_n_s_m);
    text += fmt::format(
        "set             group driven mass {:.9g}\nvariable        load equal -({})/{}\n"
        "fix             load driven aveforce NULL NULL v_load\n"
        "fix             drive driven move variable NULL NULL NULL v_vx v_still NULL\n",
        servo.mass_kg / static_cast<double>(grains), load, grains);
  } else {
    text += "fix             drive driven move variable NULL NULL NULL v_vx v_still v_still\n";
  }
  text += fmt::format(R"(compute         on_it driven reduce sum fx fy fz
variable        fx equal c_on_it[1]
variable        fy equal c_on_it[2]
variable        fz equal c_on_it[3]+{0}
variable        began equal xcm(driven,x)
variable        x0 equal ${{began}}
variable        gone equal xcm(driven,x)-v_x0
variable        height equal xcm(driven,z)
variable        x equal xcm(first,x)
variable        y equal xcm(first,y)
variable        z equal xcm(first,z)
fix             forces all ave/time 1 {1} {1} v_fx v_fy v_fz file forces.txt format " %.9g"
fix             places all ave/time {1} 1 {1} v_gone v_height v_x v_y v_z file places.txt format " %.9g"
run             {2}
)",
                      scene.servo ? load : "0", steps_per_row, std::lround(scene.duration_s / lab.dt()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "bed.data") << files.data;
  std::ofstream(folder / "rest.table") << files.table;
  std::ofstream(folder / "in.haptolith") << files.setup << text;
}

/// Runs the scene and writes its curve: means over each row's steps, and the positions of the driven body and the first
/// particle at its end.
void runScene(const std::filesystem::path& path, const Scene& scene, LabBed& lab) {
  const long steps = std::lround(scene.duration_s / lab.dt());
  const long steps_per_row = std::max(1L, std::lround(scene.duration_s / lab.dt() / kRows));
  const std::size_t driven = scene.bodies_m.size() - 1;
  const double area = scene.box.width_m * scene.box.length_m;
  std::ofstream out(path);
  fmt::print(out, "# time_s displacement_m height_m force_x_n force_y_n force_z_n area_m2 x_m y_m z_m\n");
  Driver driver(scene);
  Vec3 sum = Vec3::Zero();
  double displacement = 0;
  for (const std::vector<std::size_t>& of_body : scene.glued) {
    for (const std::size_t i : of_body) {
      lab.bed().drive(i, Vec3::Zero());
    }
  }
  const auto force = [&] {
    Vec3 on_it = lab.forceOnBody(driven);
    for (std::size_t k = 0; !scene.glued.empty() && k < scene.glued[driven].size(); ++k) {
      on_it += lab.bed().contactForce(scene.glued[driven][k]);
    }
    return on_it;
  };
  for (long i = 0; i < steps; ++i) {
    const double soil_n = i > 0 ? force().z() : 0;
    const Vec3 velocity = driver.velocityAt(static_cast<double>(i) * lab.dt(), lab.dt(), soil_n);
    lab.moveBody(driven, velocity);
    for (std::size_t k = 0; !scene.glued.empty() && k < scene.glued[driven].size(); ++k) {
      lab.bed().drive(scene.glued[driven][k], velocity);
    }
    lab.step();
    displacement += lab.dt() * velocity.x();
    sum += force();
    if ((i + 1) % steps_per_row == 0) {
      const Vec3 mean = sum / static_cast<double>(steps_per_row);
      const Vec3 first = lab.centre(0);
      fmt::print(out, "{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n",
                 static_cast<double>(i + 1) * lab.dt(), displacement, lab.centreOfBody(driven).z(), mean.x(), mean.y(),
                 mean.z(), area, first.x(), first.y(), first.z());
      sum = Vec3::Zero();
    }
  }
}

int run(int argc, char** argv) {
  if (argc < 4 || argc > 8) {
    fmt::print(stderr,
               "peer_scene <impact|slide|ten|column|shear|small-shear|blade|carry> <seed> <folder> [damping ratio "
               "[soil [normal stress "
               "of shear, Pa [pair style]]]]\n");
    return 2;
  }
  const std::string name = argv[1];
  const std::filesystem::path folder = argv[3];
  LabConditions conditions;
  conditions.seed = std::stoull(argv[2]);
  conditions.soil = linearSoil(argc >= 5 ? std::stod(argv[4]) : 0.2);
  if (argc >= 6 && std::string(argv[5]) != "springs") {
    conditions.soil = findSoil(argv[5]).soil;
    conditions.soil.damping_ratio = std::stod(argv[4]);
  }
  normal_pa = argc >= 7 ? std::stod(argv[6]) : normal_pa;
  Scene scene = sceneNamed(name, conditions);
  LabBed lab(scene.conditions, scene.box, scene.soil_m, scene.bodies_m);
  for (std::size_t i = 0; i < scene.soil_velocity_m_s.size(); ++i) {
    lab.bed().drive(i, scene.soil_velocity_m_s[i]);
    lab.bed().release(i);
  }
  if (name.ends_with("shear") && argc >= 6 && std::string(argv[5]) != "springs") {
    glue(scene, lab);
  }
  std::filesystem::create_directories(folder);
  const std::string stem = name + "-" + argv[2];
  writeScene(folder / (stem + ".json"), scene, lab);
  writeLammps(folder / (stem + "-lammps"), scene, lab,
              argc == 8 && std::string(argv[7]) == "haptolith" ? LammpsLaw::kHaptolith : LammpsLaw::kStandard);
  runScene(folder / (stem + "-haptolith.txt"), scene, lab);
  fmt::print("{}: {} particles of soil, {} driven, {:g} s in steps of {:g} s\n", stem, lab.soil(),
             lab.bed().particles() - lab.soil(), scene.duration_s, lab.dt());
  return 0;
}

}  // namespace
}  // namespace haptolith

int main(int argc, char** argv) {
  try {
    return haptolith::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "peer_scene: {}\n", error.what());
    return 1;
  }
}

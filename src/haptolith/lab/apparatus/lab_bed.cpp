#include "haptolith/lab/apparatus/lab_bed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "haptolith/bed/critical_step.h"
#include "haptolith/core/error.h"
#include "haptolith/core/math/random.h"

namespace haptolith {

namespace {

constexpr double kTick_s = 1e-3;
constexpr int kMostSubsteps = 1000;

/// Factor by which steps are shorter than under a hand, because a test may press harder. Under 60 kPa soil at rest
/// vibrates at the time steps that suffice for 10 kPa, and is at rest at three quarters of them
/// (docs/reports/performance.md).
constexpr double kShorterSteps = 4.0 / 3;

/// Speed of nearly resting soil over that of soil at rest.
constexpr double kNearly = 2;

/// Volume fraction of randomly jammed spheres (O'Hern et al. 2003: 0.64 for equal spheres).
constexpr double kRandomPacking = 0.64;

BedParameters bedParameters(const LabConditions& conditions, const LabBox& box, int classes = 1) {
  BedParameters bed;
  bed.soil = conditions.soil;
  if (classes > 1) {  // the particles determine the share of each class
    bed.grading.fine_radius_m = GrainClasses::scale(classes - 1) * conditions.soil.radius_m;
    bed.grading.fine_width_m = box.width_m;
    bed.grading.fine_length_m = box.length_m;
  }
  bed.gravity_m_s2 = {0, 0, -conditions.gravity_m_s2};
  bed.width_m = box.width_m;
  bed.length_m = box.length_m;
  bed.periodic_x = box.periodic_x;
  bed.periodic_y = box.periodic_y;
  bed.wall_friction_ratio = box.wall_friction_ratio;
  bed.seed = conditions.seed;
  bed.threads = conditions.threads;
  bed.max_substeps = kMostSubsteps;
  bed.tick_s = kTick_s;
  return bed;
}

double stepFor(const BedParameters& bed, const std::optional<ToolParameters>& tool) {
  validate(bed.soil);
  if (tool) {
    validate(*tool);
  }
  const FrictionModel friction = bed.soil.friction;
  const int substeps = substepsFor(bed, tool ? stiffnessInStep(*tool, friction) : 0);
  return kTick_s / (friction == FrictionModel::kContact ? std::ceil(kShorterSteps * substeps) : substeps);
}

std::vector<Float4> together(const std::vector<Float4>& soil, const std::vector<std::vector<Vec3>>& bodies_m) {
  std::vector<Float4> all = soil;
  for (const std::vector<Vec3>& body : bodies_m) {
    for (const Vec3& centre : body) {
      all.push_back(
          {static_cast<float>(centre.x()), static_cast<float>(centre.y()), static_cast<float>(centre.z()), 0});
    }
  }
  return all;
}

std::vector<Vec3> together(const std::vector<Vec3>& soil_m, const std::vector<std::vector<Vec3>>& bodies_m) {
  std::vector<Vec3> all = soil_m;
  for (const std::vector<Vec3>& body : bodies_m) {
    all.insert(all.end(), body.begin(), body.end());
  }
  return all;
}

}  // namespace

std::vector<Vec3> looseSoil(const SoilParameters& soil, const LabBox& box, std::size_t particles, double bottom_m,
                            std::uint64_t seed, const std::function<bool(const Vec3&)>& inside,
                            Preparation preparation) {
  const bool loose = preparation != Preparation::kDense;
  const double largest = soil.radius_m * (1 + soil.size_spread);
  const double cell = (loose ? 2.6 : 2.15) * largest;
  const double play = cell / 2 - largest;
  const int columns = std::max(1, static_cast<int>(box.width_m / cell));
  const int rows = std::max(1, static_cast<int>(box.length_m / cell));
  constexpr int kMostStoreys = 100'000;
  std::mt19937_64 random(seed);
  std::vector<Vec3> centres;
  for (int storey = 0; centres.size() < particles && storey < kMostStoreys; ++storey) {
    const int over_gaps = loose ? storey % 2 : 0;
    const double first = 0.5 + 0.5 * over_gaps;
    for (int row = 0; row < std::max(1, rows - over_gaps); ++row) {
      for (int column = 0; column < std::max(1, columns - over_gaps); ++column) {
        Vec3 centre((column + first) * box.width_m / columns - box.width_m / 2,
                    (row + first) * box.length_m / rows - box.length_m / 2, bottom_m + (storey + 0.5) * cell);
        for (int axis = 0; axis < 3; ++axis) {
          centre[axis] += play * uniformSigned(random);
        }
        if ((!inside || inside(centre)) && centres.size() < particles) {
          centres.push_back(centre);
        }
      }
    }
    if (storey == 100 && centres.empty()) {
      throw InvalidParameter("radius_m", fmt::format("{:g}", soil.radius_m),
                             "small enough to fit into the soil region");
    }
  }
  return centres;
}

std::vector<Float4> mixedGrains(const SoilParameters& soil, const std::vector<Vec3>& loose, int classes,
                                std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::vector<Float4>> of_class(static_cast<std::size_t>(classes));
  const double cell = 2 * soil.radius_m * (1 + soil.size_spread);  // diameter of the largest particle in the cell
  for (const Vec3& place : loose) {
    const std::size_t c = random() % of_class.size();
    const int along = 1 << c;
    const double scale = GrainClasses::scale(static_cast<int>(c));
    for (int k = 0; k < along * along * along; ++k) {
      const auto offset = [&](int index) { return (index + 0.5 - along / 2.0) * scale * cell; };
      const Vec3 at = place + Vec3(offset(k % along), offset(k / along % along), offset(k / along / along));
      const double radius_m = scale * soil.radius_m * (1 + soil.size_spread * uniformSigned(random));
      of_class[c].push_back({static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()),
                             static_cast<float>(radius_m - soil.radius_m)});
    }
  }
  std::vector<Float4> all;
  for (std::vector<Float4>& grains : of_class) {
    grains.resize(grains.size() / kGroup * kGroup);
    all.insert(all.end(), grains.begin(), grains.end());
  }
  return all;
}

std::size_t particlesFor(const SoilParameters& soil, double volume_m3) {
  constexpr double kMost = 3e6;  // two gigabytes of memory and days of computing
  const double sphere = 4.0 / 3 * std::numbers::pi * std::pow(soil.radius_m, 3);
  const double particles = std::max(1.0, kRandomPacking * volume_m3 / sphere);
  if (!(particles <= kMost)) {
    throw InvalidParameter(
        "particles that the test takes", fmt::format("{:.3g}", particles),
        fmt::format("{:g} or less: use larger particles (radius_mm), or a smaller tool and box", kMost));
  }
  return static_cast<std::size_t>(particles);
}

std::vector<Vec3> roughPlate(const SoilParameters& soil, const LabBox& box, double height_m, std::uint64_t seed) {
  constexpr double kSpacing = 1.6;
  constexpr double kRoughness = 0.6;
  std::mt19937_64 random(seed);
  const auto columns = static_cast<int>(std::ceil(box.width_m / (kSpacing * soil.radius_m)));
  const auto rows = static_cast<int>(std::ceil(box.length_m / (kSpacing * soil.radius_m)));
  std::vector<Vec3> centres;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      centres.emplace_back((column + 0.5) / columns * box.width_m - box.width_m / 2,
                           (row + 0.5) / rows * box.length_m - box.length_m / 2,
                           height_m + kRoughness * soil.radius_m * uniformSigned(random));
    }
  }
  return centres;
}

LabBed::LabBed(const LabConditions& conditions, const LabBox& box, const std::vector<Vec3>& soil_m,
               const std::vector<std::vector<Vec3>>& bodies_m, const std::optional<ToolParameters>& tool)
    : conditions_(conditions),
      dt_s_(stepFor(bedParameters(conditions, box), tool)),
      soil_(soil_m.size()),
      body_begin_{soil_m.size()},
      bed_(bedParameters(conditions, box), together(soil_m, bodies_m)),
      tool_(tool) {
  joint_.speed_rad_s = tool ? tool->joint.speed_rad_s : 0;
  for (std::size_t body = 0; body < bodies_m.size(); ++body) {
    body_begin_.push_back(body_begin_.back() + bodies_m[body].size());
    moveBody(body, Vec3::Zero());
  }
}

LabBed::LabBed(const LabConditions& conditions, const LabBox& box, const std::vector<Float4>& soil, int classes,
               const std::vector<std::vector<Vec3>>& bodies_m)
    : conditions_(conditions),
      dt_s_(stepFor(bedParameters(conditions, box, classes), {})),
      soil_(soil.size()),
      body_begin_{soil.size()},
      bed_(bedParameters(conditions, box, classes), together(soil, bodies_m)) {
  for (std::size_t body = 0; body < bodies_m.size(); ++body) {
    body_begin_.push_back(body_begin_.back() + bodies_m[body].size());
    moveBody(body, Vec3::Zero());
  }
}

LabBed::LabBed(const LabConditions& conditions, const BedParameters& bed, const ToolParameters& tool)
    : conditions_(conditions),
      dt_s_(stepFor(bed, tool)),
      soil_(0),
      body_begin_{0},
      bed_(bed,
           [&conditions](double time_s, double /*speed_m_s*/) {
             return !conditions.progress || conditions.progress("the soil settles", time_s / (time_s + 10));
           }),
      tool_(tool) {
  joint_.speed_rad_s = tool.joint.speed_rad_s;
  soil_ = body_begin_[0] = bed_.particles();
}

Vec3 LabBed::centre(std::size_t particle) const noexcept {
  const Float4& p = bed_.state().position[particle];
  return {p.x, p.y, p.z};
}

std::vector<Vec3> LabBed::soilCentres() const {
  std::vector<Vec3> centres;
  for (std::size_t i = 0; i < soil_; ++i) {
    centres.push_back(centre(i));
  }
  return centres;
}

double LabBed::surfaceHeight(double share) const {
  std::vector<float> tops;
  for (std::size_t i = 0; i < soil_; ++i) {
    const float smaller = GrainClasses::scale(bed_.classOf(i)) - 1;  // radius difference to class 0, in class-0 radii
    tops.push_back(bed_.state().position[i].z + smaller * static_cast<float>(conditions_.soil.radius_m));
  }
  const auto at = tops.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(soil_ - 1));
  std::nth_element(tops.begin(), at, tops.end());
  return static_cast<double>(*at) + conditions_.soil.radius_m;
}

double LabBed::surfaceHeight(DepthFrom from) const {
  return from == DepthFrom::kTips ? surfaceHeight() : levelSurface();
}

double LabBed::levelSurface() const {
  const double r = conditions_.soil.radius_m;
  const double tips = surfaceHeight();
  const double top = std::max(tips - 3 * r, tips / 2);
  const double bottom = std::max(tips - 7 * r, tips / 4);
  const auto grains_above = [&](double z) {  // number of particles of class 0 with the same volume
    double grains = 0;
    for (std::size_t i = 0; i < soil_; ++i) {
      const double own_r = GrainClasses::scale(bed_.classOf(i)) * r;
      const double t = std::clamp((bed_.state().position[i].z + own_r - z) / (2 * own_r), 0.0, 1.0);
      grains += double{GrainClasses::scale(3 * bed_.classOf(i))} * t * t * (3 - 2 * t);
    }
    return grains;
  };
  const double above = grains_above(top);
  const double per_metre = (grains_above(bottom) - above) / (top - bottom);
  return top + above / per_metre;
}

double LabBed::bulkDensity(double bottom_m, double top_m) const {
  const auto between = [&](std::size_t i) {
    const double z = bed_.state().position[i].z;
    return z >= bottom_m && z < top_m;
  };
  double grains = 0;  // in particles of class 0
  for (std::size_t i = 0; i < soil_; ++i) {
    grains += between(i) ? double{GrainClasses::scale(3 * bed_.classOf(i))} : 0;
  }
  const BedParameters& box = bed_.parameters();
  return grains * bed_.mass() / (box.width_m * box.length_m * (top_m - bottom_m));
}

void LabBed::moveBody(std::size_t body, const Vec3& velocity_m_s) noexcept {
  for (std::size_t i = body_begin_[body]; i < body_begin_[body + 1]; ++i) {
    bed_.drive(i, velocity_m_s);
  }
}

Vec3 LabBed::forceOnBody(std::size_t body) const noexcept {
  Vec3 force = Vec3::Zero();
  for (std::size_t i = body_begin_[body]; i < body_begin_[body + 1]; ++i) {
    force += bed_.contactForce(i);
  }
  return force;
}

Vec3 LabBed::centreOfBody(std::size_t body) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = body_begin_[body]; i < body_begin_[body + 1]; ++i) {
    sum += centre(i);
  }
  return sum / static_cast<double>(body_begin_[body + 1] - body_begin_[body]);
}

void LabBed::driveJoint(double value) noexcept {
  if (!tool_) {
    return;
  }
  if (Joint& joint = tool_->joint; joint.drive == Drive::kSpeed) {
    joint_.speed_rad_s = value;
  } else {
    joint.torque_nm = value;
  }
}

void LabBed::meetSoil() noexcept {
  const Joint& joint = tool_->joint;
  if (!joint.any()) {
    wrench_ = applyToolContact(*tool_, tool_pose_, tool_twist_, dt_s_, bed_, tool_memory_).wrench;
    return;
  }
  turn(joint_, dt_s_);
  const Pose pose = turned(tool_pose_, joint, joint_.angle_rad);
  const Twist twist = turning(tool_pose_, tool_twist_, joint, joint_.speed_rad_s, pose);
  wrench_ = applyToolContact(*tool_, pose, twist, dt_s_, bed_, tool_memory_).wrench;
  joint_.soil_torque_nm = torqueAboutAxis(tool_pose_, joint, pose, wrench_);
  joint_.motor_torque_nm = drive(joint, joint_, joint_.soil_torque_nm, dt_s_);
  wrench_.torque_nm += (pose.position_m - tool_pose_.position_m).cross(wrench_.force_n);
}

void LabBed::step() {
  if (tool_) {
    tool_pose_.position_m += dt_s_ * tool_twist_.linear_m_s;
    const Vec3 turn = dt_s_ * tool_twist_.angular_rad_s;
    if (!turn.isZero(0)) {
      tool_pose_.orientation =
          (Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * tool_pose_.orientation).normalized();
    }
    meetSoil();
  }
  if (const StepStatus status = bed_.step(dt_s_); status != StepStatus::kOk) {
    throw Failure(fmt::format("the test failed after {:.3f} s of simulated time: {}", time_s_, text(status)));
  }
  time_s_ += dt_s_;
}

void LabBed::run(double duration_s, std::string_view what, const std::function<void()>& each, const Part& part) {
  constexpr long kStepsBetweenLooks = 50;
  const auto steps = static_cast<long>(std::ceil(duration_s / dt_s_));
  for (long i = 0; i < steps; ++i) {
    step();
    if (each) {
      each();
    }
    if (conditions_.progress && i % kStepsBetweenLooks == 0 &&
        !conditions_.progress(
            what, part.begin + static_cast<double>(i) / static_cast<double>(steps) * (part.end - part.begin))) {
      throw Failure(fmt::format("interrupted: {}", what));
    }
  }
}

void LabBed::settle(Preparation preparation, double still_moving) {
  // Falling soil is slowed down to a speed proportional to gravity. On the Moon 20 s suffice for half a metre of loose
  // soil, on Ceres they do not. The friction of the icra2021 model also makes soil sink slowly.
  const double longest_s = 20 * std::max(1.0, 1.625 / conditions_.gravity_m_s2) * std::max(1.0, surfaceHeight() / 0.5) +
                           3 * sinkingTime(conditions_.soil, conditions_.gravity_m_s2, bed_.surfaceHeight(), dt_s_);
  if (preparation == Preparation::kDense) {
    bed_.setSettling(true);
    settleUntilRest(longest_s, "the soil settles", {0, 0.7}, still_moving);
  } else if (preparation == Preparation::kMedium) {
    settleUntilRest(longest_s, "the soil is settling", {0, 0.7});
    bed_.setSettling(true);
    run(std::sqrt(2 * conditions_.soil.radius_m / conditions_.gravity_m_s2), "the soil is tapped", {}, {0.7, 0.7});
  }
  bed_.setSettling(false);
  settleUntilRest(longest_s, "the soil is settling", {preparation == Preparation::kLoose ? 0 : 0.7, 1});
}

double LabBed::fractionFasterThan(double speed_m_s) const noexcept {
  const std::vector<Float4>& velocity = bed_.state().velocity;
  const auto faster = std::count_if(velocity.begin(), velocity.begin() + static_cast<std::ptrdiff_t>(soil_),
                                    [&](const Float4& v) { return std::hypot(v.x, v.y, v.z) > speed_m_s; });
  return static_cast<double>(faster) / static_cast<double>(soil_);
}

void LabBed::settleUntilRest(double longest_s, std::string_view what, const Part& part, double still_moving) {
  // At rest: slower than the speed of a particle that has fallen by 1/500 of its radius.
  const double at_rest = std::sqrt(2 * conditions_.gravity_m_s2 * conditions_.soil.radius_m / 500) + 1e-6;
  constexpr double kBetweenLooks_s = 0.1;
  constexpr double kHalf_s = 2;  // progress reaches one half after this time, because the total is unknown
  const auto fraction = [&part](double t) { return part.begin + t / (t + kHalf_s) * (part.end - part.begin); };
  for (double t = 0; t < longest_s; t += kBetweenLooks_s) {
    run(kBetweenLooks_s, what, {}, {fraction(t), fraction(t + kBetweenLooks_s)});
    if (t > 0 && fractionFasterThan(still_moving > 0 ? kNearly * at_rest : at_rest) <= still_moving) {
      return;
    }
  }
  throw Failure(fmt::format("{}, but did not come to a stop within {:g} s: its fastest particle moves at {:.2g} m/s",
                            what, longest_s, bed_.largestSpeed()));
}

}  // namespace haptolith

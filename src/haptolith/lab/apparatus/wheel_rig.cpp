#include "haptolith/lab/apparatus/wheel_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/statistics.h"
#include "haptolith/core/turn.h"
#include "haptolith/tool/tool_contact.h"
#include "haptolith/tool/tool_mesh.h"
#include "haptolith/tool/tool_part.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {

namespace {

/// Stiffness over that of the particles; the wheel must not deform before they do.
constexpr double kWheelStiffness = 2;

/// Duration in which a load grows to its value.
constexpr double kLoading_s = 0.3;

/// Fraction of the travel in which a wheel is lowered to a constant sinkage.
constexpr double kLowering = 0.25;

constexpr double kQuarterTurn = std::numbers::pi / 2;

/// Returns the wheel with bars across its rim, which begin a little inside it.
std::shared_ptr<const ToolMesh> withGrousers(const WheelShape& wheel, const ToolParameters& tool,
                                             const SoilParameters& soil) {
  const double radius_m = wheel.diameter_m / 2;
  const double inside_m = std::min(radius_m / 4, 2e-3);
  const std::array parts{
      ToolPart{.form = ToolPartForm::kCylinder, .diameter_m = wheel.diameter_m, .length_m = wheel.width_m},
      ToolPart{.size_m = {wheel.grouser_height_m + inside_m, wheel.grouser_thickness_m, wheel.width_m},
               .at_m = {radius_m + (wheel.grouser_height_m - inside_m) / 2, 0, 0},
               .copies = wheel.grousers}};
  ToolMeshSource source;
  source.name = "wheel with grousers";
  source.bytes = std::make_shared<const std::string>(drawn(parts));
  source.format = MeshFormat::kObj;
  source.origin_m = Vec3::Zero();
  return toolMesh(source, contactReach(tool, soil));
}

/// Least inertia of a joint that the soil drives: that of a scene (docs/contributing/equations.md).
double leastJointInertia(const WheelRun& run, const LabBed& bed) {
  const double particles = std::max(1.0, std::pow(run.below_m / bed.bed().parameters().soil.radius_m, 2));
  return particles * run.tool.stiffness_n_m * std::pow(bed.dt() * run.below_m, 2);
}

void validate(const WheelRun& run, const LabBed& bed) {
  const Range positive{0, 10, Ends::kOpenBelow};
  if (!run.tool.joint.any()) {
    throw InvalidParameter("joint", "none", "an axle");
  }
  requireInRange("radius_m", run.radius_m, positive);
  requireInRange("below_m", run.below_m, {run.radius_m, 10});
  requireInRange("slip_angle_rad", run.slip_angle_rad, {-kQuarterTurn, kQuarterTurn});
  requireInRange("travel_m_s", run.travel_m_s, positive);
  requireInRange("travel_m", run.travel_m, positive);
  requireInRange("sample_m", run.sample_m, {0, run.travel_m, Ends::kOpenBelow});
  if (run.load_n) {
    requireInRange("load_n", *run.load_n, {0, 1e5, Ends::kOpenBelow});
    // Stable for the contacts of all particles that the cross-section of the wheel has, and four times that.
    const double particles = std::max(1.0, std::pow(run.below_m / bed.bed().parameters().soil.radius_m, 2));
    requireInRange("mass_kg", run.mass_kg, {particles * run.tool.stiffness_n_m * std::pow(bed.dt(), 2), 1e5});
  } else {
    requireInRange("sinkage_m", run.sinkage_m, {0, 2 * run.radius_m, Ends::kOpenBelow});
  }
  if (run.tool.joint.drive != Drive::kSpeed) {
    requireInRange("joint_inertia_kg_m2", run.tool.joint.inertia_kg_m2,
                   {leastJointInertia(run, bed), JointRanges::inertia_kg_m2.highest});
  }
}

/// Returns the rotation that takes the joint's axis to the left of the path, turned by the slip angle.
Quat hubOf(const WheelRun& run) {
  const Quat heading = turnAbout(Vec3::UnitZ(), run.slip_angle_rad);
  return (heading * Quat::FromTwoVectors(run.tool.joint.axis, Vec3::UnitY())).normalized();
}

/// Readings that are being averaged.
class Readings {
 public:
  explicit Readings(const WheelRun& run)
      : run_(run),
        forwards_(std::cos(run.slip_angle_rad), std::sin(run.slip_angle_rad), 0),
        left_(-std::sin(run.slip_angle_rad), std::cos(run.slip_angle_rad), 0) {}

  void add(const LabBed& bed) {
    const Vec3& force_n = bed.toolWrench().force_n;
    const Vec3 axle_m = bed.toolPose().fromBody(run_.tool.joint.point_m);
    const double travel_m = axle_m.x() - run_.start_x_m;
    sum_.travel_m += travel_m;
    sum_.drawbar_n += force_n.dot(forwards_);
    sum_.side_n += force_n.dot(left_);
    sum_.vertical_n += force_n.z();
    sum_.torque_nm += bed.joint().motor_torque_nm;
    sum_.sinkage_m += run_.surface_m - (axle_m.z() - run_.radius_m);
    sum_.rim_m_s += bed.joint().speed_rad_s * run_.radius_m;
    sum_.along_path_n += force_n.x();
    ++count_;
    if (travel_m >= (static_cast<double>(all_.size()) + 1) * run_.sample_m) {
      finish();
    }
  }

  [[nodiscard]] std::vector<WheelReading> all() && { return std::move(all_); }

 private:
  void finish() {
    for (double WheelReading::*quantity :
         {&WheelReading::travel_m, &WheelReading::drawbar_n, &WheelReading::side_n, &WheelReading::vertical_n,
          &WheelReading::torque_nm, &WheelReading::sinkage_m, &WheelReading::rim_m_s, &WheelReading::along_path_n}) {
      sum_.*quantity /= count_;
    }
    all_.push_back(sum_);
    sum_ = {};
    count_ = 0;
  }

  const WheelRun& run_;
  Vec3 forwards_, left_;
  std::vector<WheelReading> all_;
  WheelReading sum_;
  double count_ = 0;
};

}  // namespace

void validate(const WheelShape& wheel, const SoilParameters& soil) {
  requireInRange("diameter_m", wheel.diameter_m, {8 * soil.radius_m, 1});
  requireInRange("width_m", wheel.width_m, {4 * soil.radius_m, 1});
  requireInRange("grousers", wheel.grousers, {0, 60});
  requireInRange("grouser_height_m", wheel.grouser_height_m, {ToolPartRanges::length_m.lowest, wheel.diameter_m / 2});
  requireInRange("grouser_thickness_m", wheel.grouser_thickness_m,
                 {ToolPartRanges::length_m.lowest, wheel.diameter_m / 2});
  requireInRange("wheel_friction", wheel.friction, ToolRanges::friction);
}

ToolParameters wheelTool(const WheelShape& wheel, const SoilParameters& soil) {
  validate(wheel, soil);
  ToolParameters tool;
  tool.shape = ToolShape::kCylinder;
  tool.diameter_m = wheel.diameter_m;
  tool.length_m = wheel.width_m;
  tool.stiffness_n_m = kWheelStiffness * soil.stiffness_n_m;
  tool.friction = wheel.friction;
  tool.joint.axis = Vec3::UnitZ();
  tool.joint.drive = Drive::kSpeed;
  if (wheel.grousers > 0) {
    tool.shape = ToolShape::kMesh;
    tool.mesh = withGrousers(wheel, tool, soil);
  }
  return tool;
}

std::vector<WheelReading> runWheel(LabBed& bed, const WheelRun& run) {
  validate(run, bed);
  const Quat hub = hubOf(run);
  const auto pose_at = [&](double axle_z_m) {
    return Pose{Vec3(run.start_x_m, 0, axle_z_m) - hub * run.tool.joint.point_m, hub};
  };
  bed.driveJoint(0);
  bed.placeTool(pose_at(bed.bed().surfaceHeight() + run.below_m));
  const auto require_above_floor = [&] {
    if (bed.toolPose().fromBody(run.tool.joint.point_m).z() < run.below_m) {
      throw Failure(
          fmt::format("the wheel sank to the floor after {:.3g} s: use a deeper bed or less load", bed.time()));
    }
  };

  double sinking_m_s = 0;
  const auto slide = [&](double travel_m_s, double load_n) {
    sinking_m_s += bed.dt() * (load_n - bed.toolWrench().force_n.z()) / run.mass_kg;
    bed.moveTool({{travel_m_s, 0, -sinking_m_s}, Vec3::Zero()});
    require_above_floor();
  };
  if (run.load_n) {
    const double start_s = bed.time();
    bed.moveTool({});
    bed.run(kLoading_s, "the wheel is loaded",
            [&] { slide(0, *run.load_n * std::min(1.0, (bed.time() - start_s) / kLoading_s)); });
  }

  const double height_m = bed.toolPose().fromBody(run.tool.joint.point_m).z();
  const double goal_m = run.surface_m + run.radius_m - run.sinkage_m;
  const double lowering_m_s = (height_m - goal_m) / (kLowering * run.travel_m / run.travel_m_s);
  Readings readings(run);
  bed.driveJoint(run.drive);
  bed.moveTool({{run.travel_m_s, 0, run.load_n ? -sinking_m_s : -lowering_m_s}, Vec3::Zero()});
  bed.run(run.travel_m / run.travel_m_s + 2 * bed.dt(), "the wheel travels", [&] {
    readings.add(bed);
    if (run.load_n) {
      slide(run.travel_m_s, *run.load_n);
    } else if (bed.toolPose().position_m.x() - run.start_x_m >= kLowering * run.travel_m) {
      bed.moveTool({{run.travel_m_s, 0, 0}, Vec3::Zero()});
    }
  });
  return std::move(readings).all();
}

WheelMean meanOf(std::span<const WheelReading> readings, double WheelReading::*quantity) {
  std::vector<double> values;
  for (const WheelReading& reading : readings) {
    values.push_back(reading.*quantity);
  }
  return {mean(values), standardDeviation(values)};
}

}  // namespace haptolith

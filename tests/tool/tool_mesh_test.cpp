// A mesh as a tool: what is made of a file, and that it meets soil as the exact shape that it was drawn from.

#include "haptolith/tool/tool_mesh.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "haptolith/scene/scene.h"
#include "haptolith/soil/presets.h"
#include "haptolith/tool/tool_contact.h"
#include "haptolith/tool/tool_shape.h"
#include "haptolith/tool/tool_surface.h"

namespace haptolith {
namespace {

using testing::HasSubstr;

constexpr double kReach_m = 8e-3;

/// A surface as an OBJ file in millimetres.
std::string objOf(const ToolSurface& surface) {
  std::string text;
  for (const Vec3& point_m : surface.points_tool_m) {
    text += fmt::format("v {} {} {}\n", 1e3 * point_m.x(), 1e3 * point_m.y(), 1e3 * point_m.z());
  }
  for (const auto& [a, b, c] : surface.triangles) {
    text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
  }
  return text;
}

ToolMeshSource sourceOf(const std::string& obj) {
  return {.name = "tool.obj", .bytes = std::make_shared<const std::string>(obj), .format = MeshFormat::kObj};
}

ToolParameters shovel(double thickness_m) {
  ToolParameters tool;
  tool.size_m = {0.05, 0.04, thickness_m};
  return tool;
}

/// The tool defined by its mesh alone.
ToolParameters drawn(const ToolParameters& exact) {
  ToolParameters tool = exact;
  tool.shape = ToolShape::kMesh;
  tool.mesh = toolMesh(sourceOf(objOf(toolSurface(exact, 0))), kReach_m);
  return tool;
}

TEST(ToolMesh, IsTheSameObjectForTheSameFileAndPlace) {
  const ToolMeshSource source = sourceOf(objOf(toolSurface(shovel(0.005), 0)));
  const auto mesh = toolMesh(source, kReach_m);
  ToolMeshSource other_name = source;
  other_name.name = "another";
  other_name.bytes = std::make_shared<const std::string>(*source.bytes);
  EXPECT_EQ(toolMesh(other_name, kReach_m), mesh);
  EXPECT_EQ(toolMesh(source, kReach_m - 1e-3), mesh) << "of soil that needs no more";
  EXPECT_NE(toolMesh(source, 2 * kReach_m), mesh);
  ToolMeshSource turned = source;
  turned.turn_rad.z() = 1;
  EXPECT_NE(toolMesh(turned, kReach_m), mesh);
}

TEST(ToolMesh, LivesUntilAnotherIsMadeThoughNobodyHoldsIt) {
  ToolMeshSource source = sourceOf(objOf(toolSurface(shovel(0.004), 0)));
  std::weak_ptr<const ToolMesh> seen = toolMesh(source, kReach_m);
  EXPECT_FALSE(seen.expired()) << "the tick would have to free it";
  source.turn_rad.x() = 0.5;
  (void)toolMesh(source, kReach_m);
  EXPECT_TRUE(seen.expired());
}

TEST(ToolMesh, IsHeldInTheMiddleOfTheBoxAroundItOrWhereItIsSaid) {
  const std::string obj = objOf(toolSurface(shovel(0.005), 0));
  ToolMeshSource source = sourceOf(obj);
  const auto corners = [](const ToolMeshSource& of) { return toolMesh(of, kReach_m)->field.corners(); };
  EXPECT_LT((corners(source).high_m - Vec3(0.025, 0.02, 0.0025)).norm(), 1e-9);
  source.origin_m = Vec3(0.025, 0, 0);
  EXPECT_LT((corners(source).high_m - Vec3(0, 0.02, 0.0025)).norm(), 1e-9);
  source.turn_rad.z() = std::numbers::pi / 2;  // x becomes y
  EXPECT_LT((corners(source).high_m - Vec3(0.02, 0, 0.0025)).norm(), 1e-9);
  EXPECT_LT((corners(source).low_m - Vec3(-0.02, -0.05, -0.0025)).norm(), 1e-9);
}

TEST(ToolMesh, RefusesWhatCannotBeATool) {
  const auto message = [](const ToolMeshSource& source, double reach_m) -> std::string {
    try {
      (void)toolMesh(source, reach_m);
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "";
  };
  ToolMeshSource source = sourceOf(objOf(toolSurface(shovel(0.005), 0)));
  EXPECT_THAT(message(source, 0.03), HasSubstr("particles touch a mesh from at most 0.0295 m"));
  source.unit_m = 0.2;
  EXPECT_THAT(message(source, kReach_m), HasSubstr("tool.obj: largest edge"));
  source.unit_m = 2;
  EXPECT_THAT(message(source, kReach_m), HasSubstr("mesh_unit_m = 2"));
  EXPECT_THAT(message(sourceOf("v 0 0 0\nv 30 0 0\nv 0 30 0\nf 1 2 3\n"), kReach_m), HasSubstr("closed"));
  EXPECT_THAT(message(sourceOf("not a mesh"), kReach_m), HasSubstr("tool.obj"));
}

TEST(ToolMesh, IsRefusedByASceneWhoseGrainsFeelItFromFartherThanItIsMeasured) {
  ToolParameters tool = drawn(shovel(0.005));
  BedParameters bed;
  EXPECT_NO_THROW(Scene(bed, tool));
  bed.soil = rescaled(bed.soil, 0.011);
  bed.particles = 20;
  EXPECT_THROW(Scene(bed, tool), InvalidParameter);
  tool.mesh = nullptr;
  EXPECT_THROW(validate(tool), InvalidParameter);
}

// --- in soil ---

const Quat kBlade(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY()));

BedParameters lunarBed() {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.contact_cohesion_n = 0.003;
  bed.soil.size_spread = 0.05;
  return bed;
}

/// A tool that feels a bed without doing anything to it: what it would feel there.
class Shadow {
 public:
  explicit Shadow(ToolParameters tool, std::size_t particles)
      : tool_(std::move(tool)), sides_(particles), slip_(particles), forces_(particles) {}

  Wrench feel(const Scene& scene, const HandState& hand, double dt_s) {
    return applyToolContact(tool_, hand.pose, hand.twist, scene.bed().parameters().soil, dt_s, scene.bed().state(),
                            {sides_, slip_}, forces_)
        .wrench;
  }

 private:
  ToolParameters tool_;
  std::vector<std::int8_t> sides_;
  std::vector<Float4> slip_, forces_;
};

/// Poses of a hand that scoops with the shovel: down with the edge first, along, and up level; or that stirs in
/// circles.
HandState moving(bool scoops, double time_s, double surface_m) {
  const auto pose = [&](double t) -> Pose {
    const double phase = std::numbers::pi * t;
    if (!scoops) {
      return {Vec3(0.03 * std::cos(2 * phase), 0.03 * std::sin(2 * phase), surface_m - 0.012), kBlade};
    }
    const double tilt = 0.6 * std::cos(phase);
    return {Vec3(-0.04 * std::cos(phase), 0, surface_m + 0.01 - 0.03 * std::sin(phase)),
            Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()))};
  };
  constexpr double kStep_s = 1e-5;
  const Pose now = pose(time_s), next = pose(time_s + kStep_s);
  const Eigen::AngleAxisd turn(next.orientation * now.orientation.conjugate());
  return {{now, {(next.position_m - now.position_m) / kStep_s, turn.axis() * turn.angle() / kStep_s}}};
}

TEST(ToolMesh, ShovelFeelsTheSameSoilAsTheExactOne) {
  const ToolParameters exact = shovel(0.005);
  const ToolParameters mesh = drawn(exact);
  for (const BedParameters& bed : {BedParameters{}, lunarBed()}) {
    for (const bool scoops : {true, false}) {
      Scene scene(bed, exact);
      const double surface_m = scene.bed().surfaceHeight();
      Shadow by_numbers(exact, scene.bed().particles()), by_mesh(mesh, scene.bed().particles());
      double sum_n = 0, sum_nm = 0, off_n = 0, off_nm = 0, mesh_n = 0, mesh_nm = 0;
      scene.placeTool(moving(scoops, 0, surface_m + 0.03));
      for (int tick = 1; tick <= 2000; ++tick) {
        const double time_s = 1e-3 * tick;
        const HandState hand = moving(scoops, time_s, surface_m + 0.03 * std::max(0.0, 1 - 4 * time_s));
        ASSERT_EQ(scene.tick(hand), StepStatus::kOk);
        const Wrench one = by_numbers.feel(scene, hand, 1e-3);
        const Wrench other = by_mesh.feel(scene, hand, 1e-3);
        sum_n += one.force_n.norm();
        sum_nm += one.torque_nm.norm();
        mesh_n += other.force_n.norm();
        mesh_nm += other.torque_nm.norm();
        off_n += (other.force_n - one.force_n).norm();
        off_nm += (other.torque_nm - one.torque_nm).norm();
      }
      EXPECT_NEAR(mesh_n, sum_n, 0.005 * sum_n) << scoops;
      EXPECT_NEAR(mesh_nm, sum_nm, 0.005 * sum_nm) << scoops;
      EXPECT_LT(off_n, 0.01 * sum_n) << scoops << ": at every moment";
      EXPECT_LT(off_nm, 0.02 * sum_nm) << scoops;
    }
  }
}

/// Number of particles that pass from one side of an upright plate to the other without going round it.
int passages(const BedParameters& bed, const ToolParameters& tool, const Vec3& size_m, double speed_m_s) {
  Scene scene(bed, tool);
  const double middle_m = 0.6 * scene.bed().surfaceHeight();
  scene.placeTool({{{Vec3(-0.045, 0, middle_m + 0.06), kBlade}, {}}});
  int count = 0;
  std::vector<int> before(scene.bed().particles(), 0);
  const auto look = [&] {
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Float4& p = scene.bed().state().position[i];
      const Vec3 there_m = scene.toolPose().toBody(Vec3(p.x, p.y, p.z));
      const bool over_face = std::abs(there_m.x()) < size_m.x() / 2 && std::abs(there_m.y()) < size_m.y() / 2;
      const int now = !over_face ? 0 : there_m.z() > 0 ? 1 : -1;
      count += now * before[i] < 0 && std::abs(there_m.z()) < 0.03 ? 1 : 0;
      before[i] = now;
    }
  };
  const auto move = [&](const Vec3& to_m) {
    const Vec3 from_m = scene.toolPose().position_m;
    const int ticks = static_cast<int>(std::ceil((to_m - from_m).norm() / (speed_m_s * 1e-3)));
    for (int i = 1; i <= ticks; ++i) {
      const Twist twist{(to_m - from_m) / (ticks * 1e-3), Vec3::Zero()};
      EXPECT_EQ(scene.tick({{{from_m + (to_m - from_m) * i / ticks, kBlade}, twist}}), StepStatus::kOk);
      look();
    }
  };
  move(Vec3(-0.045, 0, middle_m));
  const std::vector<Pose> stones = scene.bed().stones().poses();
  double squeezing_m = bed.width_m / 2 - 0.006;  // 6 mm from the box, for grains of 14 mm
  for (std::size_t i = 0; i < scene.bed().stones().size(); ++i) {
    squeezing_m -= 2 * scene.bed().stones().shape(i)->reach_m;
  }
  for (int times = 0; times < 2; ++times) {
    move(Vec3(squeezing_m, 0.01, middle_m));
    move(Vec3(-squeezing_m, -0.01, middle_m));
  }
  for (std::size_t i = 0; i < stones.size(); ++i) {
    EXPECT_GT((scene.bed().stones().pose(i).position_m - stones[i].position_m).norm(), 0.01) << "it was not met";
  }
  return count;
}

TEST(ToolMesh, NobodyPassesAWallOfOneMillimetreAtHandSpeeds) {
  const ToolParameters wall = drawn(shovel(0.001));
  BedParameters icra2021;
  icra2021.soil = findPreset("P4").soil;
  for (const BedParameters& bed : {icra2021, lunarBed()}) {
    for (const double speed : {0.2, 0.5, 1.0}) {
      EXPECT_EQ(passages(bed, wall, {0.05, 0.04, 0.001}, speed), 0) << speed;
    }
  }
}

TEST(ToolMesh, NobodyPassesAThinWallBesideAStone) {
  BedParameters bed = lunarBed();
  bed.stones.placed = {{.size_m = 0.02, .seed = 3, .x_m = 0.01, .depth_m = 0.4 * bed.depth_m}};
  for (const double speed : {0.2, 1.0}) {
    EXPECT_EQ(passages(bed, drawn(shovel(0.001)), {0.05, 0.04, 0.001}, speed), 0) << speed;
  }
}

}  // namespace
}  // namespace haptolith

// The adaptor to CHAI3D, with mocks of CHAI3D's classes and, if CHAI3D_DIR is set, with CHAI3D.

#include <gmock/gmock.h>
#include <haptolith/chai3d.hpp>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "use.h"

namespace haptolith::library {
namespace {

using chai3d::cMatrix3d;
using chai3d::cVector3d;
using hapto::cHaptolithBed;
using hapto::cHaptolithLoop;
using hapto::cHaptolithTool;
using testing::HasSubstr;
using testing::StrEq;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTick_s = 1e-3;

/// A device of CHAI3D's that is where the test says.
class ScriptedDevice final : public chai3d::cGenericHapticDevice {
 public:
  ScriptedDevice() {
    rotation.identity();
    m_specifications.m_maxLinearForce = 1000;
    m_specifications.m_maxAngularTorque = 1000;
    m_specifications.m_maxGripperForce = 8;
    m_specifications.m_maxLinearStiffness = 4000;
    m_specifications.m_workspaceRadius = 0.5;
    m_specifications.m_gripperMaxAngleRad = 0.5;
    m_specifications.m_sensedRotation = m_specifications.m_sensedGripper = true;
    m_specifications.m_actuatedPosition = m_specifications.m_actuatedRotation = true;
    m_specifications.m_actuatedGripper = true;
  }
  bool open() override { return true; }
  bool close() override { return true; }
  bool calibrate(bool /*force*/) override { return true; }
  bool getPosition(cVector3d& out) override {
    out = position_m;
    return well;
  }
  bool getLinearVelocity(cVector3d& out) override {
    out = velocity_m_s;
    return well;
  }
  bool getRotation(cMatrix3d& out) override {
    out = rotation;
    return well;
  }
  bool getAngularVelocity(cVector3d& out) override {
    out = cVector3d(0, 0, 0);
    return well;
  }
  bool getGripperAngleRad(double& out) override {
    out = gripper_rad;
    return well;
  }
  bool getUserSwitches(unsigned int& out) override {
    out = 0;
    return well;
  }
  bool setForceAndTorqueAndGripperForce(const cVector3d& force, const cVector3d& /*torque*/,
                                        double /*gripper*/) override {
    force_n = force;
    ++shown;
    return well;
  }

  cVector3d position_m{0, 0, 0}, velocity_m_s{0, 0, 0}, force_n{0, 0, 0};
  cMatrix3d rotation;
  double gripper_rad = 0.5;
  bool well = true;
  int shown = 0;
};

/// A scene, and a world with its bed and its tool.
struct Rig {
  explicit Rig(ScenePtr of = sceneOf(kIcra2021))
      : scene(std::move(of)),
        bed(new cHaptolithBed(scene.get())),
        tool(new cHaptolithTool(&world, *bed)),
        device(std::make_shared<ScriptedDevice>()) {
    world.addChild(bed);
    world.addChild(tool);
    tool->setHapticDevice(device);
  }

  void begin() {
    world.computeGlobalPositions(true);
    EXPECT_TRUE(tool->start());
  }
  /// CHAI3D's loop, once.
  void turn(double elapsed_s = kTick_s) {
    tool->updateFromDevice();
    tool->advance(elapsed_s);
    tool->applyToDevice();
  }
  /// Lets the handle be where the tool then is, in the scene, when nothing has been moved or turned.
  void goTo(const double (&scene_m)[3]) { device->position_m = cVector3d(-scene_m[1], scene_m[0], scene_m[2]); }
  void goTo(double x_m, double y_m, double z_m) { goTo({x_m, y_m, z_m}); }
  [[nodiscard]] double surface() const { return bed->getSurfaceHeight(); }
  [[nodiscard]] double felt() const { return tool->getDeviceLocalForce().length(); }
  [[nodiscard]] std::string reason() const { return tool->getTripReason(); }

  ScenePtr scene;
  chai3d::cWorld world;  // has bed and tool
  cHaptolithBed* bed;
  cHaptolithTool* tool;
  std::shared_ptr<ScriptedDevice> device;
};

/// As in examples/c/dig.c: 40 mm down at 0.1 m/s.
std::vector<hapto_pose> digging(double surface_m, int ticks = 401) {
  std::vector<hapto_pose> way;
  hapto_pose tool = {{0, 0, surface_m + 0.01}, {1, 0, 0, 0}};
  for (int tick = 0; tick < ticks; ++tick) {
    way.push_back(tool);
    tool.position_m[2] -= 1e-4;
  }
  return way;
}

std::vector<hapto_wrench> steppedInC(hapto_scene* scene, const std::vector<hapto_pose>& way) {
  std::vector<hapto_wrench> felt(way.size());
  expectOk(hapto_scene_place_tool(scene, way.data()));
  expectOk(hapto_scene_steps(scene, way.size(), way.data(), nullptr, felt.data(), nullptr));
  return felt;
}

cMatrix3d turnedBy(double x_rad, double z_rad) {
  cMatrix3d about_x, about_z;
  about_x.set(1, 0, 0, 0, std::cos(x_rad), -std::sin(x_rad), 0, std::sin(x_rad), std::cos(x_rad));
  about_z.set(std::cos(z_rad), -std::sin(z_rad), 0, std::sin(z_rad), std::cos(z_rad), 0, 0, 0, 1);
  return about_z * about_x;
}

void expectNear(const cVector3d& a, const cVector3d& b, double tolerance) {
  EXPECT_LE((a - b).length(), tolerance) << a(0) << ' ' << a(1) << ' ' << a(2) << " and " << b(0) << ' ' << b(1) << ' '
                                         << b(2);
}

// --- the same soil
// ----------------------------------------------------------------------------------------------------

TEST(Chai3dTool, FeelsTheSameBitsAsTheCInterface) {
  const char* dig = "[soil]\npreset = 'P3'\n[gravity]\nbody = 'Moon'\n";  // as in examples/c/dig.c
  const ScenePtr in_c = sceneOf(dig);
  Rig rig(sceneOf(dig));
  const auto way = digging(rig.surface());
  const auto felt = steppedInC(in_c.get(), way);
  rig.tool->setUseSafety(false);
  rig.tool->setUseDeviceVelocity(false);
  rig.goTo(way[0].position_m);
  rig.begin();
  rig.turn(0);
  for (std::size_t tick = 0; tick < way.size(); ++tick) {
    rig.goTo(way[tick].position_m);
    rig.turn();
    const hapto_wrench& here = rig.tool->getSceneWrench();
    const cVector3d shown_n = rig.tool->getDeviceLocalForce(), shown_nm = rig.tool->getDeviceLocalTorque();
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(here.force_n[axis], felt[tick].force_n[axis]) << tick;
      ASSERT_EQ(here.torque_nm[axis], felt[tick].torque_nm[axis]) << tick;
    }
    expectNear(shown_n, cVector3d(-felt[tick].force_n[1], felt[tick].force_n[0], felt[tick].force_n[2]), 0);
    expectNear(shown_nm, cVector3d(-felt[tick].torque_nm[1], felt[tick].torque_nm[0], felt[tick].torque_nm[2]), 0);
  }
  EXPECT_GT(felt.back().force_n[2], 10);
  EXPECT_EQ(hashOf(rig.scene.get()), hashOf(in_c.get()));
  EXPECT_EQ(rig.tool->getTicks(), way.size());
}

TEST(Chai3dTool, FeelsTheSameWhereverBedAndToolStandInTheWorld) {
  const ScenePtr in_c = sceneOf(kIcra2021);
  Rig rig;
  const auto way = digging(rig.surface(), 250);
  const auto felt = steppedInC(in_c.get(), way);
  rig.tool->setUseSafety(false);
  rig.tool->setUseDeviceVelocity(false);
  const cMatrix3d world_R_scene = turnedBy(0.3, -1.1), world_R_device = turnedBy(-0.2, 0.7);
  const cVector3d bed_m(0.4, -0.2, 1.3), base_m(-0.1, 0.05, 1.0);
  rig.bed->setLocalPos(bed_m);
  rig.bed->setLocalRot(world_R_scene);
  rig.tool->setLocalPos(base_m);
  rig.tool->setLocalRot(world_R_device);
  const cMatrix3d device_R_scene = cTranspose(world_R_device) * world_R_scene;
  rig.device->rotation = turnedBy(0.5, 0.4);
  rig.tool->setToolRotation(cTranspose(rig.device->rotation) * device_R_scene);  // upright in the scene
  const auto go_to = [&](const hapto_pose& pose) {
    const cVector3d world_m =
        bed_m + world_R_scene * cVector3d(pose.position_m[0], pose.position_m[1], pose.position_m[2]);
    rig.device->position_m = cTranspose(world_R_device) * (world_m - base_m);
  };
  go_to(way[0]);
  rig.begin();
  go_to(way[0]);
  rig.turn(0);
  for (std::size_t tick = 0; tick < way.size(); ++tick) {
    go_to(way[tick]);
    rig.turn();
    const double* force_n = felt[tick].force_n;
    const double* torque_nm = felt[tick].torque_nm;
    expectNear(rig.tool->getDeviceLocalForce(), device_R_scene * cVector3d(force_n[0], force_n[1], force_n[2]), 1e-3);
    expectNear(rig.tool->getDeviceLocalTorque(), device_R_scene * cVector3d(torque_nm[0], torque_nm[1], torque_nm[2]),
               1e-4);
    expectNear(rig.tool->getDeviceGlobalForce(), world_R_scene * cVector3d(force_n[0], force_n[1], force_n[2]), 1e-3);
  }
  EXPECT_GT(felt.back().force_n[2], 5);
}

TEST(Chai3dTool, TurnsEachAxisOfTheDeviceIntoTheScenes) {
  Rig rig;
  rig.tool->setUseSafety(false);
  const double high_m = rig.surface() + 0.05;
  rig.device->position_m = cVector3d(0, 0, high_m);
  rig.begin();
  rig.turn(0);
  const auto tool_at = [&](double x_m, double y_m, double z_m) {
    rig.device->position_m = cVector3d(x_m, y_m, high_m + z_m);
    rig.turn();
    const double* at_m = rig.tool->getScenePose().position_m;
    return cVector3d(at_m[0], at_m[1], at_m[2] - high_m);
  };
  expectNear(tool_at(0.005, 0, 0), cVector3d(0, -0.005, 0), 1e-15);  // to the person: not away
  expectNear(tool_at(0, 0.005, 0), cVector3d(0.005, 0, 0), 1e-15);   // right
  expectNear(tool_at(0, 0, 0.005), cVector3d(0, 0, 0.005), 1e-15);   // up

  // A handle that is turned about its own x, to the person, turns the tool about the scene's -y.
  rig.device->rotation = turnedBy(0.1, 0);
  rig.turn();
  const double* q = rig.tool->getScenePose().orientation;
  EXPECT_NEAR(q[0], std::cos(0.05), 1e-12);
  EXPECT_NEAR(q[1], 0, 1e-12);
  EXPECT_NEAR(q[2], -std::sin(0.05), 1e-12);
  EXPECT_NEAR(q[3], 0, 1e-12);
}

TEST(Chai3dTool, KnowsEveryRotation) {
  for (const double x_rad : {-3.1, -2.0, -0.5, 0.0, 1.0, 2.5, M_PI}) {
    for (const double z_rad : {-3.0, -1.5, 0.0, 0.7, 2.9}) {
      const cMatrix3d r = turnedBy(x_rad, z_rad);
      double q[4];
      hapto::detail::put(r, q);
      EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-12);
      EXPECT_NEAR(1 - 2 * (q[2] * q[2] + q[3] * q[3]), r(0, 0), 1e-12);
      EXPECT_NEAR(2 * (q[1] * q[2] - q[0] * q[3]), r(0, 1), 1e-12);
      EXPECT_NEAR(2 * (q[1] * q[3] + q[0] * q[2]), r(0, 2), 1e-12);
      EXPECT_NEAR(2 * (q[2] * q[3] - q[0] * q[1]), r(1, 2), 1e-12);
      EXPECT_NEAR(1 - 2 * (q[1] * q[1] + q[2] * q[2]), r(2, 2), 1e-12);
    }
  }
}

TEST(Chai3dTool, StretchesMovementsAndNotForces) {
  Rig alike, stretched;
  stretched.tool->setWorkspaceScaleFactor(2);
  stretched.tool->setForceScale(0.5);
  const auto way = digging(alike.surface(), 300);
  for (Rig* rig : {&alike, &stretched}) {
    rig->tool->setUseSafety(false);
    rig->device->velocity_m_s = cVector3d(0, 0, rig == &alike ? -0.1 : -0.05);
  }
  for (std::size_t tick = 0; tick < way.size(); ++tick) {
    alike.goTo(way[tick].position_m);
    stretched.device->position_m = alike.device->position_m / 2;
    if (tick == 0) {
      alike.begin();
      stretched.begin();
    }
    alike.turn();
    stretched.turn();
    expectNear(stretched.tool->getDeviceLocalForce(), 0.5 * alike.tool->getDeviceLocalForce(), 1e-12);
    expectNear(stretched.tool->getDeviceLocalTorque(), 0.25 * alike.tool->getDeviceLocalTorque(), 1e-12);
  }
  EXPECT_GT(alike.felt(), 5);

  Rig wide;  // the hand is within its workspace however far the tool goes
  wide.device->m_specifications.m_workspaceRadius = 0.01;
  wide.tool->setWorkspaceScaleFactor(10);
  wide.device->position_m = cVector3d(0, 0, 0.009);
  wide.begin();
  wide.turn(0);
  wide.turn();
  EXPECT_THAT(wide.reason(), StrEq(""));
  EXPECT_NEAR(wide.tool->getScenePose().position_m[2], 0.09, 1e-15);
}

// --- time
// -------------------------------------------------------------------------------------------------------------

/// Force of each tick that ended a call, by its number.
std::vector<std::array<double, 4>> dugAt(double calls_hz, double duration_s) {
  Rig rig;
  rig.tool->setUseSafety(false);
  rig.device->velocity_m_s = cVector3d(0, 0.02, -0.06);
  std::vector<std::array<double, 4>> ticks;
  const auto calls = static_cast<int>(std::lround(duration_s * calls_hz));
  for (int call = 0; call <= calls; ++call) {
    const double t_s = call / calls_hz;
    rig.device->position_m = cVector3d(0, 0.02 * t_s, rig.surface() + 0.01 - 0.06 * t_s);
    if (call == 0) {
      rig.begin();
    }
    rig.turn(call == 0 ? 0 : 1 / calls_hz);
    const double* at_m = rig.tool->getScenePose().position_m;
    ticks.resize(rig.tool->getTicks() + 1);
    ticks.back() = {at_m[0], at_m[2] - rig.surface(), rig.tool->getSceneWrench().force_n[2], rig.felt()};
  }
  return ticks;
}

TEST(Chai3dTool, MakesTheSameTicksAtEveryRateOfTheLoop) {
  const auto at_1000 = dugAt(1000, 0.6);
  for (const double calls_hz : {4000.0, 300.0, 731.0}) {
    const auto at_other = dugAt(calls_hz, 0.6);
    ASSERT_NEAR(static_cast<double>(at_other.size()), static_cast<double>(at_1000.size()), calls_hz == 731 ? 1 : 0);
    double strongest_n = 0;
    for (std::size_t tick = 1; tick < std::min(at_other.size(), at_1000.size()); ++tick) {
      if (at_other[tick][1] == 0) {
        continue;  // one of several in a call
      }
      EXPECT_NEAR(at_other[tick][0], 0.02 * kTick_s * static_cast<double>(tick), 1e-12) << calls_hz;
      EXPECT_NEAR(at_other[tick][1], 0.01 - 0.06 * kTick_s * static_cast<double>(tick), 1e-12) << calls_hz;
      EXPECT_NEAR(at_other[tick][2], at_1000[tick][2], 0.05) << calls_hz << " tick " << tick;
      strongest_n = std::max(strongest_n, at_other[tick][2]);
    }
    EXPECT_GT(strongest_n, 5);
  }
}

TEST(Chai3dTool, FollowsTheContactStiffnessBetweenTicks) {
  Rig rig;
  rig.tool->setUseSafety(false);
  const auto way = digging(rig.surface(), 250);
  for (const hapto_pose& pose : way) {
    rig.goTo(pose.position_m);
    if (&pose == way.data()) {
      rig.begin();
    }
    rig.turn();
  }
  const double at_tick_n = rig.tool->getDeviceLocalForce()(2);
  double k_n_m[9];
  expectOk(hapto_scene_get_contact_stiffness(rig.scene.get(), k_n_m));
  const std::uint64_t ticks = rig.tool->getTicks();
  rig.device->position_m(2) -= 5e-5;
  rig.turn(0.4e-3);
  EXPECT_EQ(rig.tool->getTicks(), ticks);
  EXPECT_GT(k_n_m[8], 100);
  EXPECT_NEAR(rig.tool->getDeviceLocalForce()(2) - at_tick_n, k_n_m[8] * 5e-5, 1e-9);
}

TEST(Chai3dTool, KeepsTimeWithTheClock) {
  Rig rig;
  rig.device->position_m = cVector3d(0, 0, rig.surface() + 0.05);
  rig.begin();
  const auto begin = std::chrono::steady_clock::now();
  double passed_s = 0;
  while (passed_s < 0.05) {
    rig.tool->updateFromDevice();
    rig.tool->computeInteractionForces();
    passed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  EXPECT_LE(static_cast<double>(rig.tool->getTicks()), passed_s / kTick_s + 1);
  EXPECT_GE(rig.tool->getTicks(), 1U);  // the machine may be busy
}

// --- the hand
// ---------------------------------------------------------------------------------------------------------

/// Presses 15 mm deep and holds for so long.
void press(Rig& rig, int hold_ticks) {
  const auto way = digging(rig.surface(), 251);
  for (const hapto_pose& pose : way) {
    rig.goTo(pose.position_m);
    if (&pose == way.data()) {
      rig.begin();
    }
    rig.turn();
  }
  for (int tick = 0; tick < hold_ticks; ++tick) {
    rig.turn();
  }
}

TEST(Chai3dTool, HasTheSafetyLayerUnlessItIsSwitchedOff) {
  Rig rig;
  EXPECT_TRUE(rig.tool->getUseSafety());
  EXPECT_FALSE(rig.tool->getUseForceRise()) << "the soft start would be doubled";
  rig.device->m_specifications.m_maxLinearForce = 1.5;
  double strongest_n = 0, largest_step_n = 0, last_n = 0;
  const auto way = digging(rig.surface());
  for (int call = 0; call < 16000; ++call) {  // 4 kHz, with a hand that trembles
    rig.goTo(way[std::min<std::size_t>(static_cast<std::size_t>(call) / 8, 250)].position_m);
    rig.device->position_m(2) += 2e-5 * std::sin(call * 0.9);
    if (call == 0) {
      rig.begin();
    }
    rig.turn(kTick_s / 4);
    strongest_n = std::max(strongest_n, rig.felt());
    largest_step_n = std::max(largest_step_n, std::abs(rig.felt() - last_n));
    last_n = rig.felt();
    if (call == 1600) {  // 0.4 s of a soft start of 2 s
      EXPECT_LT(strongest_n, 0.2);
    }
  }
  EXPECT_THAT(rig.reason(), StrEq(""));
  EXPECT_LE(strongest_n, 1.5 + 1e-12);
  EXPECT_GT(strongest_n, 1.4);
  EXPECT_LE(largest_step_n, 2 * 1.5 / 3) << "full force in no less than 3 ms, between ticks and from tick to tick";

  Rig without;
  without.device->m_specifications.m_maxLinearForce = 1.5;
  without.tool->setUseSafety(false);
  press(without, 0);
  EXPECT_GT(without.felt(), 5);
}

TEST(Chai3dTool, ShowsWhatTheSafetyLayerOfTheCInterfaceShows) {
  Rig rig;
  const ScenePtr in_c = sceneOf(kIcra2021);
  hapto_device_limits limits = hapto::limitsOf(rig.device->m_specifications);
  limits.simulated = 1;
  limits.max_force_n = 4;
  rig.tool->setDeviceLimits(limits);
  hapto_safety* made = nullptr;
  expectOk(hapto_safety_create(&limits, nullptr, 0, kTick_s, 100, &made));
  const std::unique_ptr<hapto_safety, Destroy> safety(made);
  const auto way = digging(rig.surface());
  expectOk(hapto_scene_place_tool(in_c.get(), way.data()));
  rig.goTo(way[0].position_m);
  rig.device->velocity_m_s = cVector3d(0, 0, -0.1);
  rig.begin();
  rig.turn(0);
  for (const hapto_pose& pose : way) {
    rig.goTo(pose.position_m);
    rig.turn();
    const hapto_twist twist = {{0, 0, -0.1}, {0, 0, 0}};
    auto told = sized<hapto_device_input>();
    told.pose = {{-pose.position_m[1], pose.position_m[0], pose.position_m[2]}, {1, 0, 0, 0}};
    told.twist = twist;
    told.gripper_open = 1;
    auto shown = sized<hapto_device_output>();
    hapto_wrench felt;
    expectOk(hapto_scene_step(in_c.get(), &pose, &twist, &felt));
    shown.wrench = {{-felt.force_n[1], felt.force_n[0], felt.force_n[2]},
                    {-felt.torque_nm[1], felt.torque_nm[0], felt.torque_nm[2]}};
    expectOk(hapto_safety_step(made, &told, 0, &shown));
    const double* force_n = shown.wrench.force_n;
    expectNear(rig.tool->getDeviceLocalForce(), cVector3d(force_n[0], force_n[1], force_n[2]), 1e-12);
  }
  EXPECT_NEAR(rig.felt(), 4, 0.5);
}

/// Force on a pressing hand in a tick, and after it has moved deeper before the next.
std::array<double, 2> feltBetweenTicks(const std::vector<std::string>& safety, double max_force_n, double deeper_m) {
  Rig rig;
  rig.device->m_specifications.m_maxLinearForce = max_force_n;
  rig.tool->setSafetyParameters(safety);
  press(rig, 500);
  const double in_tick_n = rig.felt();
  rig.device->position_m(2) -= deeper_m;
  rig.turn(kTick_s / 2);
  return {in_tick_n, rig.felt()};
}

TEST(Chai3dTool, KeepsLimitsBetweenTicks) {
  const std::string soon = "safety.soft_start_s=0.05", undamped = "safety.passivity=false";
  const auto free_n = feltBetweenTicks({soon, undamped}, 1000, 2e-3);
  const double limit_n = 1.4 * free_n[0];
  EXPECT_GT(free_n[1], 1.1 * limit_n);
  EXPECT_NEAR(feltBetweenTicks({soon, undamped}, limit_n, 2e-3)[1], limit_n, 1e-3) << "the device's limit";
  EXPECT_NEAR(feltBetweenTicks({soon, undamped, "safety.max_force_n=" + std::to_string(limit_n)}, 1000, 2e-3)[1],
              limit_n, 1e-3);
  const auto rate_n = feltBetweenTicks({soon, undamped}, 2 * free_n[0], 8e-3);
  EXPECT_NEAR(rate_n[1] - rate_n[0], 2 * free_n[0] / 3, 0.2) << "full force in 3 ms";
  const auto below_n = feltBetweenTicks({soon, "safety.max_force_n=0.7"}, 1000, 2e-3);
  EXPECT_NEAR(below_n[0], 0.7, 0.2);
  EXPECT_LE(below_n[1], 0.7 + 1e-9);
}

TEST(Chai3dTool, ShowsNoForceWithoutTheSafetyLayerItWasAskedFor) {
  Rig wrong;
  wrong.tool->setSafetyParameters({"safety.max_force_n=often"});
  press(wrong, 0);
  EXPECT_EQ(wrong.felt(), 0) << "no safety layer, no force";
  EXPECT_THAT(wrong.reason(), testing::Not(StrEq("")));
  EXPECT_EQ(wrong.tool->getTicks(), 0U);
}

TEST(Chai3dTool, LetsGoOfAHandThatIsNotANumber) {
  for (const bool safety : {true, false}) {
    for (const double elapsed_s : {kTick_s, kTick_s / 4, 3.4 * kTick_s}) {
      Rig rig;
      rig.tool->setUseSafety(safety);
      rig.tool->setSafetyParameters({"safety.soft_start_s=0.05"});
      press(rig, 200);
      ASSERT_GT(rig.felt(), 1);
      const cVector3d there_m = rig.device->position_m;
      rig.device->position_m(0) = kNaN;
      rig.turn(elapsed_s);
      EXPECT_EQ(rig.felt(), 0) << "at once, " << elapsed_s;
      EXPECT_THAT(rig.reason(), testing::Not(StrEq("")));
      rig.device->position_m = there_m;
      rig.turn(elapsed_s / 8);
      EXPECT_EQ(rig.felt(), 0);
      double last_n = 0;
      for (int tick = 0; tick < 1900; ++tick) {
        rig.turn();
        if (safety) {
          ASSERT_LT(std::abs(rig.felt() - last_n), 0.4) << "softly, tick " << tick;
          ASSERT_TRUE(tick > 990 || rig.felt() == 0) << "not before all has been well for a second, tick " << tick;
        }
        last_n = rig.felt();
      }
      EXPECT_GT(rig.felt(), 0.5) << "and it comes back";
      EXPECT_THAT(rig.reason(), StrEq(""));
    }
  }
}

TEST(Chai3dTool, LetsGoOfWhatNoHandDoesAndSaysWhy) {
  const auto pressing = [] {
    auto rig = std::make_unique<Rig>();
    rig->tool->setSafetyParameters({"safety.soft_start_s=0.05"});
    press(*rig, 200);
    EXPECT_GT(rig->felt(), 1);
    return rig;
  };
  const auto jumped = pressing();
  const double deep_m = jumped->tool->getScenePose().position_m[2];
  jumped->device->position_m(1) += 0.05;
  jumped->turn();
  EXPECT_EQ(jumped->felt(), 0);
  EXPECT_EQ(jumped->tool->getScenePose().position_m[0], 0) << "the soil has not been swept";
  EXPECT_EQ(jumped->tool->getScenePose().position_m[2], deep_m);
  jumped->turn();
  EXPECT_THAT(jumped->reason(), HasSubstr("impossibly fast"));

  const auto silent = pressing();
  silent->turn(0.1);
  EXPECT_EQ(silent->felt(), 0);
  EXPECT_THAT(silent->reason(), HasSubstr("did not answer"));

  const auto slow = pressing();
  for (int call = 0; call < 6; ++call) {
    slow->turn(0.006);  // for 36 ms 170 Hz
  }
  EXPECT_EQ(slow->felt(), 0);
  EXPECT_THAT(slow->reason(), HasSubstr("deadlines"));

  const auto off = pressing();
  off->tool->setForcesOFF();
  off->turn();
  EXPECT_EQ(off->device->force_n.length(), 0);
  off->tool->setForcesON();
  off->turn();
  EXPECT_EQ(off->felt(), 0) << "the soft start is to come";
  EXPECT_THAT(off->reason(), HasSubstr("forces are off"));

  const auto away = pressing();
  away->device->m_specifications.m_workspaceRadius = 10;
  away->begin();
  away->device->position_m = cVector3d(0, 3, 0);
  away->begin();
  away->turn(0);
  away->turn();
  EXPECT_THAT(away->reason(), HasSubstr("space around the bed"));
  away->device->position_m = cVector3d(0, 0, 0.2);
  for (int tick = 0; tick < 1100; ++tick) {
    away->turn();
  }
  EXPECT_THAT(away->reason(), StrEq(""));

  Rig nowhere;
  EXPECT_TRUE(nowhere.tool->start());
  nowhere.turn();
  EXPECT_THAT(nowhere.reason(), HasSubstr("computeGlobalPositions"));
}

TEST(Chai3dTool, IsPutWhereTheHandIsAgainWithoutASweepThroughTheSoil) {
  const ScenePtr in_c = sceneOf(kIcra2021);
  Rig rig;
  rig.tool->setUseSafety(false);
  rig.tool->setUseDeviceVelocity(false);
  const auto way = digging(rig.surface(), 251);
  press(rig, 0);
  (void)steppedInC(in_c.get(), {way.begin() + 1, way.end()});  // the first only says where the hand is
  rig.device->position_m(2) = kNaN;
  rig.turn();
  rig.goTo(0.04, 0.01, way.back().position_m[2]);
  rig.turn();
  rig.turn();
  const hapto_pose there = {{0.04, 0.01, way.back().position_m[2]}, {1, 0, 0, 0}};
  hapto_wrench felt;
  for (const char* why : {"no number", "the hand has not been there for a tick"}) {
    EXPECT_EQ(hapto_scene_step(in_c.get(), &way.back(), nullptr, &felt), HAPTO_OK) << why;
  }
  expectOk(hapto_scene_place_tool(in_c.get(), &there));
  expectOk(hapto_scene_step(in_c.get(), &there, nullptr, &felt));
  EXPECT_EQ(hashOf(rig.scene.get()), hashOf(in_c.get()));
  EXPECT_EQ(rig.tool->getSceneWrench().force_n[2], felt.force_n[2]);
}

TEST(Chai3dTool, OpensTheJawsWithTheGripper) {
  Rig rig(sceneOf("[bed]\nparticles = 256\n[tool]\nshape = 'jaws'\n"));
  rig.tool->setUseSafety(false);
  rig.device->position_m = cVector3d(0, 0, rig.surface() + 0.1);
  rig.begin();
  const auto opening_m = [&](double gripper_rad) {
    rig.device->gripper_rad = gripper_rad;
    for (int tick = 0; tick < 300; ++tick) {
      rig.turn();
    }
    auto info = sized<hapto_scene_info>();
    expectOk(hapto_scene_get_info(rig.scene.get(), &info));
    return info.opening_m;
  };
  const double wide_m = opening_m(0.5);
  EXPECT_GT(wide_m, 0.01);
  EXPECT_NEAR(opening_m(0.25), wide_m / 2, 1e-9);
  EXPECT_NEAR(opening_m(-0.01), 0, 1e-9);
  rig.device->gripper_rad = kNaN;
  rig.turn();
  EXPECT_THAT(rig.reason(), testing::Not(StrEq("")));
}

// --- what is seen
// -----------------------------------------------------------------------------------------------------

double furthestFromScene(Rig& rig) {
  auto now = sized<hapto_array>();
  expectOk(hapto_scene_view(rig.scene.get(), HAPTO_POSITION, &now));
  EXPECT_EQ(rig.bed->getNumPoints(), now.count);
  double furthest_m = 0;
  for (unsigned int i = 0; i < rig.bed->getNumPoints(); ++i) {
    const auto* at_m = reinterpret_cast<const float*>(static_cast<const char*>(now.data) + i * now.stride_bytes);
    furthest_m =
        std::max(furthest_m, (rig.bed->m_vertices->getLocalPos(i) - cVector3d(at_m[0], at_m[1], at_m[2])).length());
  }
  return furthest_m;
}

TEST(Chai3dBed, ShowsParticlesWhereTheyAre) {
  Rig rig(sceneOf("[bed]\nparticles = 6000\nlayers = 1\nwidth_mm = 900\nlength_mm = 900\n"));
  EXPECT_EQ(furthestFromScene(rig), 0) << "from the first moment";
  EXPECT_FALSE(rig.bed->updateFromScene()) << "nothing new";
  rig.device->position_m = cVector3d(0, 0, rig.surface() + 0.1);
  rig.begin();
  rig.turn(0);
  rig.turn();
  EXPECT_GT(furthestFromScene(rig), 0);
  EXPECT_FALSE(rig.bed->updateFromScene()) << "6000 take two ticks";
  rig.turn();
  EXPECT_TRUE(rig.bed->updateFromScene());
  EXPECT_LT(furthestFromScene(rig), 1e-3);
  EXPECT_FALSE(rig.bed->updateFromScene());
}

TEST(Chai3dBed, IsDrawnByAnotherThreadAndHoldsUpNoHand) {
  Rig rig;
  const auto way = digging(rig.surface());
  rig.goTo(way[0].position_m);
  rig.begin();
  std::atomic<bool> over{false};
  std::atomic<int> pictures{0};
  std::thread drawing([&] {
    while (!over.load()) {
      pictures += rig.bed->updateFromScene() ? 1 : 0;
      rig.world.getGlobalPos();
      std::this_thread::yield();
    }
  });
  for (const hapto_pose& pose : way) {
    rig.goTo(pose.position_m);
    rig.turn();
    EXPECT_THAT(rig.reason(), StrEq(""));
    std::this_thread::yield();
  }
  while (pictures < 2) {  // however late a busy machine lets the other thread begin
    rig.turn();
    std::this_thread::yield();
  }
  over = true;
  drawing.join();
  EXPECT_THAT(rig.reason(), StrEq(""));
  EXPECT_GE(rig.tool->getTicks(), way.size() - 1) << "the first call only looks where the hand is";
}

// --- the end
// ----------------------------------------------------------------------------------------------------------

TEST(Chai3dTool, IsNoHarmWhateverIsDeletedFirst) {
  for (const char* order : {"sbt", "stb", "bst", "bts", "tsb", "tbs"}) {
    for (const bool safety : {true, false}) {
      chai3d::cWorld world;
      hapto_scene* scene = sceneOf(kIcra2021).release();
      auto* bed = new cHaptolithBed(scene);
      auto* tool = new cHaptolithTool(&world, *bed);
      auto device = std::make_shared<ScriptedDevice>();
      device->position_m = cVector3d(0, 0, 0.03);
      tool->setHapticDevice(device);
      tool->setUseSafety(safety);
      world.addChild(bed);
      world.addChild(tool);
      world.computeGlobalPositions(true);
      tool->start();
      bool scene_is_there = true;
      const auto go_on = [&] {
        world.computeGlobalPositions(true);
        for (int tick = 0; tick < 30; ++tick) {
          if (tool != nullptr) {
            tool->updateFromDevice();
            tool->advance(kTick_s);
            tool->applyToDevice();
            if (!scene_is_there) {
              EXPECT_EQ(tool->getDeviceLocalForce().length(), 0);
              EXPECT_THAT(tool->getTripReason(), testing::Not(StrEq("")));
            }
          }
          if (bed != nullptr) {
            bed->updateFromScene();
          }
        }
      };
      go_on();
      for (const char* what = order; *what != '\0'; ++what) {
        if (*what == 's') {
          expectOk(hapto_scene_destroy(scene));
          scene_is_there = false;
        } else if (*what == 'b') {
          world.removeChild(bed);
          delete bed;
          bed = nullptr;
        } else {
          world.removeChild(tool);
          delete tool;
          tool = nullptr;
        }
        go_on();
      }
    }
  }
  chai3d::cWorld world;
  cHaptolithBed nothing(nullptr);
  cHaptolithTool tool(&world, nothing);
  nothing.computeGlobalPositions(true);
  tool.advance(kTick_s);
  EXPECT_EQ(nothing.getNumPoints(), 0U);
  EXPECT_EQ(tool.getDeviceLocalForce().length(), 0);
}

TEST(Chai3dTool, LeavesAWholeToolBehind) {
  const ScenePtr scene = sceneOf(kIcra2021);
  {
    chai3d::cWorld world;
    cHaptolithBed bed(scene.get());
    cHaptolithTool tool(&world, bed);
    bed.computeGlobalPositions(true);
    tool.advance(0);
    tool.advance(kTick_s);
    auto info = sized<hapto_scene_info>();
    expectOk(hapto_scene_get_info(scene.get(), &info));
    EXPECT_LT(info.tool_fade, 0.1) << "soil where a person's hand is gives way gently";
  }
  auto info = sized<hapto_scene_info>();
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_EQ(info.tool_fade, 1);
}

// --- a device of CHAI3D's in haptolith's loop
// ---------------------------------------------------------------------------

constexpr const char* kPressedByLoop =
    "[bed]\nparticles = 256\n[mapping]\noffset_mm = [0, 0, 10]\n[safety]\nsoft_start_s = 0.05\n";

TEST(Chai3dLoop, LetsADeviceOfChai3dFeelTheSoil) {
  ScenePtr scene = sceneOf(kPressedByLoop);
  cHaptolithBed bed(scene.get());
  auto device = std::make_shared<ScriptedDevice>();
  {
    cHaptolithLoop loop(scene.get(), device, HAPTO_LOOP_TICKED_BY_CALLER);
    expectOk(loop.getStatus());
    device->velocity_m_s = cVector3d(0, 0, -0.05);
    for (int tick = 0; tick < 500; ++tick) {
      device->position_m(2) = -5e-5 * tick;
      EXPECT_EQ(loop.tick(), HAPTO_OK);
    }
    EXPECT_GT(device->force_n(2), 1) << "up";
    EXPECT_TRUE(loop.draw(bed));
    EXPECT_EQ(hapto_scene_state_hash(scene.get(), nullptr), HAPTO_NULL);
    EXPECT_EQ(hapto_scene_destroy(scene.get()), HAPTO_BUSY) << "the scene is the loop's";

    device->velocity_m_s = cVector3d(0, 0, 0);
    device->position_m(0) = kNaN;
    EXPECT_EQ(loop.tick(), HAPTO_OK);
    EXPECT_EQ(device->force_n.length(), 0);
    device->position_m(0) = 0;
    for (int tick = 0; tick < 2500; ++tick) {
      EXPECT_EQ(loop.tick(), HAPTO_OK);
    }
    EXPECT_GT(device->force_n(2), 0.5);
    device->well = false;
    EXPECT_EQ(loop.tick(), HAPTO_OK);
    EXPECT_EQ(device->force_n.length(), 0);
  }
  EXPECT_EQ(device->force_n.length(), 0);
  (void)hashOf(scene.get());
}

TEST(Chai3dLoop, TurnsTheDevicesAxesAsTheToolDoes) {
  const ScenePtr scene = sceneOf(kPressedByLoop);
  auto device = std::make_shared<ScriptedDevice>();
  hapto_device_limits limits = hapto::limitsOf(device->m_specifications);
  limits.simulated = 1;
  cHaptolithLoop loop(scene.get(), device, HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS, &limits);
  expectOk(loop.getStatus());
  for (int tick = 0; tick < 200; ++tick) {
    device->position_m = cVector3d(5e-5 * tick, 1e-4 * tick, 2e-4 * tick);
    expectOk(loop.tick());
  }
  std::vector<hapto_tick> ticks(300);
  for (hapto_tick& tick : ticks) {
    tick.size = sizeof tick;
  }
  std::uint64_t count = 0;
  expectOk(hapto_loop_take_ticks(loop.get(), ticks.data(), ticks.size(), &count, nullptr));
  ASSERT_EQ(count, 200U);
  const double* begin_m = ticks[0].scene_T_tool.position_m;
  const double* end_m = ticks[199].scene_T_tool.position_m;
  EXPECT_GT(end_m[0] - begin_m[0], 0.01) << "right";
  EXPECT_LT(end_m[1] - begin_m[1], -0.005) << "to the person";
  EXPECT_GT(end_m[2] - begin_m[2], 0.02) << "up";
}

TEST(Chai3dLoop, RunsOnAThreadOfItsOwnAndEndsWithoutForce) {
  const ScenePtr scene = sceneOf(kPressedByLoop);
  auto device = std::make_shared<ScriptedDevice>();
  {
    cHaptolithLoop loop(scene.get(), device);
    expectOk(loop.start());
    auto now = sized<hapto_snapshot>();
    while (now.ticks < 20) {
      std::this_thread::yield();
      expectOk(hapto_loop_snapshot(loop.get(), &now));
    }
  }
  EXPECT_GE(device->shown, 20);
  EXPECT_EQ(device->force_n.length(), 0);
}

TEST(Chai3dLoop, IsNoneWithoutADeviceOrAScene) {
  const ScenePtr scene = sceneOf(kIcra2021);
  EXPECT_EQ(cHaptolithLoop(scene.get(), nullptr).getStatus(), HAPTO_NULL);
  cHaptolithLoop no_scene(nullptr, std::make_shared<ScriptedDevice>());
  EXPECT_NE(no_scene.getStatus(), HAPTO_OK);
  EXPECT_NE(no_scene.tick(), HAPTO_OK);
}

}  // namespace
}  // namespace haptolith::library

// The tick allocates nothing: every operator new of this program counts.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/soil/presets.h"
#include "haptolith/tool/tool_mesh.h"

#include "../counted_new.h"

namespace haptolith {
namespace {

TEST(Allocation, TheCounterCounts) {
  const long before = allocations;
  std::vector<int> some(100);
  EXPECT_EQ(some.size(), 100U);
  EXPECT_GT(allocations, before);
}

/// Runs a number of ticks of a motion; returns the allocations between the first tick and the last.
long allocationsIn(int ticks, const BedParameters& bed, HandMotion motion, HandCompliance compliance) {
  Scene scene(bed, {});
  HandParameters hand_parameters;
  hand_parameters.motion = motion;
  hand_parameters.compliance = compliance;
  hand_parameters.surface_m = scene.bed().surfaceHeight();
  VirtualHand hand(hand_parameters, bed.tick_s);
  LoopParameters loop_parameters;
  loop_parameters.real_time = false;
  HapticLoop loop(scene, hand, loop_parameters, true);
  const std::uint64_t list_rebuilds = scene.bed().listRebuilds();
  const long before = allocations;
  for (int i = 0; i < ticks; ++i) {
    if (loop.tick() != LoopEnd::kRunning) {
      ADD_FAILURE() << "ended at tick " << i;
      break;
    }
  }
  const long during = allocations - before;
  EXPECT_GT(scene.bed().listRebuilds(), list_rebuilds + 100) << "too few lists were rebuilt: too quiet a scene";
  return during;
}

TEST(Allocation, ATickAllocatesNothing) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  EXPECT_EQ(allocationsIn(5000, bed, HandMotion::kScoop, HandCompliance::kArm), 0);
  EXPECT_EQ(allocationsIn(5000, bed, HandMotion::kStir, HandCompliance::kArm), 0);
  EXPECT_EQ(allocationsIn(5000, bed, HandMotion::kStir, HandCompliance::kRigid), 0);
}

TEST(Allocation, ATickWithContactFrictionAllocatesNothing) {
  // Renewed lists also move the memory of contacts.
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.contact_cohesion_n = 0.003;
  bed.soil.size_spread = 0.05;
  EXPECT_EQ(allocationsIn(5000, bed, HandMotion::kStir, HandCompliance::kRigid), 0);
  EXPECT_EQ(allocationsIn(5000, bed, HandMotion::kScoop, HandCompliance::kRigid), 0);
}

TEST(Allocation, ATickWithGrainsOfSeveralSizesAllocatesNothing) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  bed.soil.friction = FrictionModel::kContact;
  bed.soil.contact_cohesion_n = 0.003;
  bed.grading.fine_radius_m = bed.soil.radius_m / 4;
  bed.grading.fine_width_m = bed.grading.fine_length_m = 0.014;
  bed.grading.fine_depth_m = 0.01;
  EXPECT_EQ(allocationsIn(1500, bed, HandMotion::kStir, HandCompliance::kRigid), 0);
}

TEST(Allocation, ATickOnSeveralThreadsAllocatesNothing) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  bed.start = BedStart::kPacked;
  bed.depth_m = 0.12;
  bed.width_m = bed.length_m = 0.16;
  bed.threads = 2;
  EXPECT_EQ(allocationsIn(1200, bed, HandMotion::kStir, HandCompliance::kRigid),
            0);  // the blade is in the soil by then
}

/// A box of 40 mm that is known by its mesh alone.
ToolParameters meshTool() {
  const std::string obj =
      "v -20 -20 -20\nv 20 -20 -20\nv 20 20 -20\nv -20 20 -20\nv -20 -20 20\nv 20 -20 20\nv 20 20 20\nv -20 20 20\n"
      "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const ToolMeshSource source{
      .name = "box.obj", .bytes = std::make_shared<const std::string>(obj), .format = MeshFormat::kObj};
  return {.shape = ToolShape::kMesh, .mesh = toolMesh(source, 8e-3)};
}

TEST(Allocation, WhatIsAskedOfTheLoopAllocatesNothing) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  Scene scene(bed, {});
  Scene other(bed, {});
  ShownScene next(other);
  HandParameters hand_parameters;
  hand_parameters.surface_m = scene.bed().surfaceHeight();
  VirtualHand hand(hand_parameters, bed.tick_s);
  LoopParameters loop_parameters;
  loop_parameters.real_time = false;
  HapticLoop loop(scene, hand, loop_parameters, false);
  const LoopRequest requests[] = {request::Speed{0.5},
                                  request::Gravity{Vec3(0, 0, -3)},
                                  request::Soil{SoilLaws(findPreset("P4").soil)},
                                  request::ReplaceTool{ToolParameters{.shape = ToolShape::kSphere}},
                                  request::ReplaceTool{meshTool()},
                                  request::ReplaceTool{ToolParameters{.shape = ToolShape::kSphere}},  // frees the mesh
                                  request::ReplaceTool{meshTool()},
                                  request::ReplaceBed{&next},
                                  request::Pause{},
                                  request::Advance{3},
                                  request::Resume{}};
  const long before = allocations;
  for (const LoopRequest& asked : requests) {
    ASSERT_TRUE(loop.ask(asked));
    hand.command({.held = Pose{Vec3(0.01, 0, 0.05)}, .surface_m = 0.04});
    for (int i = 0; i < 300; ++i) {
      (void)loop.tick();
    }
    hand.command({.motion = HandMotion::kStir, .surface_m = 0.04, .beginnings = 1});
    for (int i = 0; i < 300; ++i) {
      (void)loop.tick();
    }
  }
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(&loop.shownScene(), &next);
}

TEST(Allocation, ALoopWithoutItsRecorderAllocatesNothingEither) {
  BedParameters bed;
  bed.soil = findPreset("P4").soil;
  Scene scene(bed, {});
  HandParameters hand_parameters;
  hand_parameters.motion = HandMotion::kStill;
  VirtualHand hand(hand_parameters, bed.tick_s);
  LoopParameters loop_parameters;
  loop_parameters.real_time = false;
  HapticLoop loop(scene, hand, loop_parameters, true);
  const long before = allocations;
  for (int i = 0; i < 10'000; ++i) {  // 8192 records have room
    (void)loop.tick();
  }
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(loop.lostRecords(), 10'000U - 8192U);
}

}  // namespace
}  // namespace haptolith

// Every function of the header with what must not be: NULL, structs of another size, handles that have been destroyed
// or are of another kind. A status, never a crash.

#include <gmock/gmock.h>

#include <fstream>
#include <functional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "../source_dir.h"
#include "device.h"
#include "use.h"

namespace haptolith::library {
namespace {

/// One handle of each kind, alive, destroyed or of a wrong kind.
struct Handles {
  hapto_scene* scene = nullptr;
  hapto_batch* batch = nullptr;
  hapto_soil* soil = nullptr;
  hapto_result* result = nullptr;
  hapto_loop* loop = nullptr;
  hapto_safety* safety = nullptr;
};

/// A call of a function with a handle in its place and all else as it should be.
struct Call {
  const char* function;
  std::function<std::int32_t(const Handles&)> with;
};

/// Targets and valid inputs of calls.
struct Good {
  hapto_pose pose{{0, 0, 0.2}, {1, 0, 0, 0}};
  hapto_wrench wrench{};
  hapto_scene_info info = sized<hapto_scene_info>();
  hapto_tool_state tool_state = sized<hapto_tool_state>();
  std::uint32_t tool = 0;
  hapto_array array = sized<hapto_array>();
  hapto_snapshot snapshot = sized<hapto_snapshot>();
  hapto_safety_info safety_info = sized<hapto_safety_info>();
  hapto_device_input input = sized<hapto_device_input>();
  hapto_device_output output = sized<hapto_device_output>();
  hapto_error error = sized<hapto_error>();
  double numbers[9]{0, 0, -1};
  std::vector<char> bytes = std::vector<char>(1 << 20);
  std::uint64_t count = 0;
  std::vector<hapto_tick> ticks = std::vector<hapto_tick>(4);
  const char* text = nullptr;
  const char* override = "gravity.body=Moon";
  std::vector<float> particles = std::vector<float>(3 * 256);
};

std::vector<Call> calls(Good& good) {
  return {
      {"hapto_result_json", [&](const Handles& h) { return hapto_result_json(h.result, &good.text); }},
      {"hapto_result_value",
       [&](const Handles& h) { return hapto_result_value(h.result, "gravity_m_s2", good.numbers); }},
      {"hapto_result_column", [&](const Handles& h) { return hapto_result_column(h.result, "depth_m", &good.array); }},
      {"hapto_scene_get_info", [&](const Handles& h) { return hapto_scene_get_info(h.scene, &good.info); }},
      {"hapto_scene_get_toml",
       [&](const Handles& h) {
         return hapto_scene_get_toml(h.scene, good.bytes.data(), good.bytes.size(), &good.count);
       }},
      {"hapto_scene_place_tool", [&](const Handles& h) { return hapto_scene_place_tool(h.scene, &good.pose); }},
      {"hapto_scene_get_tool_pose", [&](const Handles& h) { return hapto_scene_get_tool_pose(h.scene, &good.pose); }},
      {"hapto_scene_step", [&](const Handles& h) { return hapto_scene_step(h.scene, &good.pose, nullptr, nullptr); }},
      {"hapto_scene_steps",
       [&](const Handles& h) { return hapto_scene_steps(h.scene, 1, &good.pose, nullptr, nullptr, nullptr); }},
      {"hapto_scene_get_wrench", [&](const Handles& h) { return hapto_scene_get_wrench(h.scene, &good.wrench); }},
      {"hapto_scene_get_contact_stiffness",
       [&](const Handles& h) { return hapto_scene_get_contact_stiffness(h.scene, good.numbers); }},
      {"hapto_scene_set_opening", [&](const Handles& h) { return hapto_scene_set_opening(h.scene, 1); }},
      {"hapto_scene_get_grip_force",
       [&](const Handles& h) { return hapto_scene_get_grip_force(h.scene, good.numbers); }},
      {"hapto_scene_set_tool_fade", [&](const Handles& h) { return hapto_scene_set_tool_fade(h.scene, 1); }},
      {"hapto_scene_set_gravity",
       [&](const Handles& h) {
         const double down[3]{0, 0, -1};
         return hapto_scene_set_gravity(h.scene, down);
       }},
      {"hapto_scene_change", [&](const Handles& h) { return hapto_scene_change(h.scene, &good.override, 1); }},
      {"hapto_scene_tools", [&](const Handles& h) { return hapto_scene_tools(h.scene, &good.tool); }},
      {"hapto_scene_tool_name", [&](const Handles& h) { return hapto_scene_tool_name(h.scene, 0, &good.text); }},
      {"hapto_scene_find_tool", [&](const Handles& h) { return hapto_scene_find_tool(h.scene, "tool", &good.tool); }},
      {"hapto_scene_step_tools",
       [&](const Handles& h) { return hapto_scene_step_tools(h.scene, &good.pose, nullptr, 1, nullptr); }},
      {"hapto_scene_steps_tools",
       [&](const Handles& h) { return hapto_scene_steps_tools(h.scene, 1, &good.pose, nullptr, 1, nullptr, nullptr); }},
      {"hapto_scene_tool_place", [&](const Handles& h) { return hapto_scene_tool_place(h.scene, 0, &good.pose); }},
      {"hapto_scene_tool_set_opening", [&](const Handles& h) { return hapto_scene_tool_set_opening(h.scene, 0, 1); }},
      {"hapto_scene_tool_set_fade", [&](const Handles& h) { return hapto_scene_tool_set_fade(h.scene, 0, 1); }},
      {"hapto_scene_tool_set_drive", [&](const Handles& h) { return hapto_scene_tool_set_drive(h.scene, 0, 1); }},
      {"hapto_scene_tool_get_state",
       [&](const Handles& h) { return hapto_scene_tool_get_state(h.scene, 0, &good.tool_state); }},
      {"hapto_scene_view", [&](const Handles& h) { return hapto_scene_view(h.scene, HAPTO_POSITION, &good.array); }},
      {"hapto_scene_copy",
       [&](const Handles& h) {
         return hapto_scene_copy(h.scene, HAPTO_POSITION, good.particles.data(), good.particles.size() * 4);
       }},
      {"hapto_scene_get_state",
       [&](const Handles& h) {
         return hapto_scene_get_state(h.scene, good.bytes.data(), good.bytes.size(), &good.count);
       }},
      {"hapto_scene_set_state",
       [&](const Handles& h) { return hapto_scene_set_state(h.scene, good.bytes.data(), good.count); }},
      {"hapto_scene_state_hash", [&](const Handles& h) { return hapto_scene_state_hash(h.scene, &good.count); }},
      {"hapto_batch_step",
       [&](const Handles& h) { return hapto_batch_step(h.batch, 1, &good.pose, nullptr, nullptr, nullptr); }},
      {"hapto_batch_step_tools",
       [&](const Handles& h) { return hapto_batch_step_tools(h.batch, 1, &good.pose, nullptr, 1, nullptr, nullptr); }},
      {"hapto_soil_get", [&](const Handles& h) { return hapto_soil_get(h.soil, "soil.radius_mm", good.numbers); }},
      {"hapto_soil_get_toml",
       [&](const Handles& h) {
         return hapto_soil_get_toml(h.soil, good.bytes.data(), good.bytes.size(), &good.count);
       }},
      {"hapto_loop_start", [&](const Handles& h) { return hapto_loop_start(h.loop); }},
      {"hapto_loop_snapshot", [&](const Handles& h) { return hapto_loop_snapshot(h.loop, &good.snapshot); }},
      {"hapto_loop_get_tool", [&](const Handles& h) { return hapto_loop_get_tool(h.loop, 0, &good.tool_state); }},
      {"hapto_loop_pause", [&](const Handles& h) { return hapto_loop_pause(h.loop, 0); }},
      {"hapto_loop_change", [&](const Handles& h) { return hapto_loop_change(h.loop, &good.override, 1); }},
      {"hapto_loop_take_ticks",
       [&](const Handles& h) { return hapto_loop_take_ticks(h.loop, good.ticks.data(), 4, &good.count, nullptr); }},
      {"hapto_loop_get_header",
       [&](const Handles& h) {
         return hapto_loop_get_header(h.loop, good.bytes.data(), good.bytes.size(), &good.count);
       }},
      {"hapto_loop_stop", [&](const Handles& h) { return hapto_loop_stop(h.loop); }},
      {"hapto_safety_step",
       [&](const Handles& h) { return hapto_safety_step(h.safety, &good.input, 0, &good.output); }},
      {"hapto_safety_get_info", [&](const Handles& h) { return hapto_safety_get_info(h.safety, &good.safety_info); }},
      {"hapto_safety_stop", [&](const Handles& h) { return hapto_safety_stop(h.safety); }},
      {"hapto_loop_tick", [&](const Handles& h) { return hapto_loop_tick(h.loop, 0); }},
      {"hapto_scene_clone",
       [&](const Handles& h) {
         hapto_scene* made = nullptr;
         const std::int32_t status = hapto_scene_clone(h.scene, &made);
         return status == HAPTO_OK ? hapto_scene_destroy(made) : status;
       }},
      {"hapto_soil_profile",
       [&](const Handles& h) {
         hapto_result* made = nullptr;
         const std::int32_t status = hapto_soil_profile(h.soil, 1, 0.1, &made);
         return status == HAPTO_OK ? hapto_result_destroy(made) : status;
       }},
      {"hapto_batch_create",
       [&](const Handles& h) {
         hapto_batch* made = nullptr;
         const std::int32_t status = hapto_batch_create(&h.scene, 1, 1, &made);
         return status == HAPTO_OK ? hapto_batch_destroy(made) : status;
       }},
      {"hapto_loop_create",
       [&](const Handles& h) {
         hapto_loop* made = nullptr;
         const std::int32_t status = hapto_loop_create(h.scene, nullptr, 1, &made);
         return status == HAPTO_OK ? hapto_loop_destroy(made) : status;
       }},
      {"hapto_loop_create_tools",
       [&](const Handles& h) {
         hapto_loop* made = nullptr;
         const hapto_device* none = nullptr;
         const std::int32_t status = hapto_loop_create_tools(h.scene, &none, 1, 1, &made);
         return status == HAPTO_OK ? hapto_loop_destroy(made) : status;
       }},
      {"hapto_lab_test",
       [&](const Handles& h) {
         hapto_result* made = nullptr;
         const std::int32_t status =
             hapto_lab_test("free-fall", h.soil, "fall_m = 0.02\nthreads = 1", nullptr, nullptr, &made);
         return status == HAPTO_OK ? hapto_result_destroy(made) : status;
       }},
      {"hapto_scene_trust",
       [&](const Handles& h) {
         hapto_result* made = nullptr;
         const std::int32_t status = hapto_scene_trust(
             h.scene, "duration_s = 0.25\nspecimens = 2\nminutes = 0.1\nthreads = 1", nullptr, nullptr, &made);
         return status == HAPTO_OK ? hapto_result_destroy(made) : status;
       }},
      // The last ones: what they are given is no more.
      {"hapto_batch_destroy", [](const Handles& h) { return hapto_batch_destroy(h.batch); }},
      {"hapto_loop_destroy", [](const Handles& h) { return hapto_loop_destroy(h.loop); }},
      {"hapto_scene_destroy", [](const Handles& h) { return hapto_scene_destroy(h.scene); }},
      {"hapto_soil_destroy", [](const Handles& h) { return hapto_soil_destroy(h.soil); }},
      {"hapto_result_destroy", [](const Handles& h) { return hapto_result_destroy(h.result); }},
      {"hapto_safety_destroy", [](const Handles& h) { return hapto_safety_destroy(h.safety); }},
  };
}

/// Those that are called below by themselves: they have no handle.
const std::set<std::string> kWithoutHandle{"hapto_version",
                                           "hapto_version_string",
                                           "hapto_last_error",
                                           "hapto_status_text",
                                           "hapto_note_error",
                                           "hapto_psychometric_fit",
                                           "hapto_list",
                                           "hapto_scene_from_toml",
                                           "hapto_scene_from_file",
                                           "hapto_scene_from_state",
                                           "hapto_soil_find",
                                           "hapto_soil_from_toml",
                                           "hapto_device_limits_init",
                                           "hapto_safety_create",
                                           "hapto_soil_calibrate"};

Handles alive(hapto_scene** loops_scene) {
  Handles h;
  h.scene = sceneOf(kIcra2021, {"tool.joint_drive=speed", "tool.joint_axis=[0, 0, 1]"}).release();
  expectOk(hapto_batch_create(&h.scene, 1, 1, &h.batch));
  expectOk(hapto_soil_find("dry-sand", &h.soil));
  expectOk(hapto_soil_profile(h.soil, 1, 0.1, &h.result));
  *loops_scene = sceneOf(kIcra2021, {"loop.real_time=false"}).release();
  expectOk(hapto_loop_create(*loops_scene, nullptr, HAPTO_LOOP_TICKED_BY_CALLER | HAPTO_LOOP_KEEPS_TICKS, &h.loop));
  const hapto_device_limits limits = [] {
    hapto_device_limits made{};
    expectOk(hapto_device_limits_init(&made));
    return made;
  }();
  expectOk(hapto_safety_create(&limits, nullptr, 0, 1e-3, 100, &h.safety));
  return h;
}

TEST(EveryFunction, IsCalledHere) {
  Good good;
  std::set<std::string> called = kWithoutHandle;
  for (const Call& call : calls(good)) {
    called.insert(call.function);
  }
  std::ifstream file(sourceDir() / "include/haptolith/haptolith.h");
  std::stringstream header;
  header << file.rdbuf();
  const std::string text = header.str();
  const std::regex declaration(R"(HAPTO_API [\w ]+[ *](hapto_\w+)\()");
  std::set<std::string> declared;
  for (std::sregex_iterator at(text.begin(), text.end(), declaration), end; at != end; ++at) {
    declared.insert((*at)[1]);
  }
  EXPECT_GT(declared.size(), 45U);
  EXPECT_EQ(called, declared);
}

TEST(EveryFunction, GivesAStatusForEveryWrongHandle) {
  Good good;
  hapto_scene* loops_scene = nullptr;
  Handles h = alive(&loops_scene);
  const std::vector<Call> all = calls(good);
  for (const Call& call : all) {
    const std::int32_t status = call.with({});
    EXPECT_EQ(status, HAPTO_NULL) << call.function;
  }
  // Each handle in the place of another kind's.
  Handles wrong;
  wrong.scene = reinterpret_cast<hapto_scene*>(h.soil);
  wrong.batch = reinterpret_cast<hapto_batch*>(h.scene);
  wrong.soil = reinterpret_cast<hapto_soil*>(h.result);
  wrong.result = reinterpret_cast<hapto_result*>(h.loop);
  wrong.loop = reinterpret_cast<hapto_loop*>(h.safety);
  wrong.safety = reinterpret_cast<hapto_safety*>(h.batch);
  for (const Call& call : all) {
    EXPECT_EQ(call.with(wrong), HAPTO_DESTROYED) << call.function;
  }
  for (const Call& call : all) {  // as they should be: what destroys comes last
    const std::int32_t status = call.with(h);
    const bool with_a_thread = std::string(call.function) == "hapto_loop_start";
    const bool ended = std::string(call.function) == "hapto_loop_tick";  // after hapto_loop_stop()
    EXPECT_EQ(status, with_a_thread ? HAPTO_INVALID_PARAMETER : ended ? HAPTO_ENDED : HAPTO_OK) << call.function;
  }
  for (const Call& call : all) {
    EXPECT_EQ(call.with(h), HAPTO_DESTROYED) << call.function;
  }
  expectOk(hapto_scene_destroy(loops_scene));
}

TEST(EveryFunction, RefusesNullWhereThereMustBeSomething) {
  hapto_scene* loops_scene = nullptr;
  const Handles h = alive(&loops_scene);
  const hapto_pose pose{{0, 0, 0.2}, {1, 0, 0, 0}};
  hapto_device_limits limits{};
  EXPECT_EQ(hapto_last_error(nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_list(nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_list("scenes", nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_result_json(h.result, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_result_value(h.result, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_result_column(h.result, "x", nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_from_toml("", nullptr, nullptr, 0, nullptr, nullptr, nullptr), HAPTO_NULL);
  hapto_scene* scene = nullptr;
  EXPECT_EQ(hapto_scene_from_toml("", nullptr, nullptr, 1, nullptr, nullptr, &scene), HAPTO_INVALID_PARAMETER);
  const char* none = nullptr;
  EXPECT_EQ(hapto_scene_from_toml("", nullptr, &none, 1, nullptr, nullptr, &scene), HAPTO_INVALID_PARAMETER);
  EXPECT_EQ(hapto_scene_from_file(nullptr, nullptr, 0, nullptr, nullptr, &scene), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_from_state(nullptr, 9, &scene), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_clone(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_get_info(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_get_toml(h.scene, nullptr, 1 << 20, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_place_tool(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_get_tool_pose(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_step(h.scene, nullptr, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_steps(h.scene, 3, nullptr, nullptr, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_get_wrench(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_get_contact_stiffness(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_get_grip_force(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_set_gravity(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_change(h.scene, nullptr, 2), HAPTO_INVALID_PARAMETER);
  std::uint32_t tool = 0;
  EXPECT_EQ(hapto_scene_tools(h.scene, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_tool_name(h.scene, 0, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_find_tool(h.scene, nullptr, &tool), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_find_tool(h.scene, "tool", nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_step_tools(h.scene, nullptr, nullptr, 1, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_steps_tools(h.scene, 1, nullptr, nullptr, 1, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_tool_place(h.scene, 0, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_tool_get_state(h.scene, 0, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_view(h.scene, HAPTO_POSITION, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_copy(h.scene, HAPTO_POSITION, nullptr, 9), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_get_state(h.scene, nullptr, 1 << 20, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_set_state(h.scene, nullptr, 9), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_state_hash(h.scene, nullptr), HAPTO_NULL);
  hapto_batch* batch = nullptr;
  EXPECT_EQ(hapto_batch_create(nullptr, 1, 1, &batch), HAPTO_NULL);
  EXPECT_EQ(hapto_batch_create(&h.scene, 1, 1, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_batch_step(h.batch, 1, nullptr, nullptr, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_batch_step_tools(h.batch, 1, nullptr, nullptr, 1, nullptr, nullptr), HAPTO_NULL);
  hapto_soil* soil = nullptr;
  EXPECT_EQ(hapto_soil_find(nullptr, &soil), HAPTO_NULL);
  EXPECT_EQ(hapto_soil_find("dry-sand", nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_soil_from_toml(nullptr, nullptr, &soil), HAPTO_NULL);
  EXPECT_EQ(hapto_soil_get(h.soil, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_soil_calibrate(nullptr, nullptr, nullptr, &soil, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_soil_calibrate("", nullptr, nullptr, nullptr, nullptr), HAPTO_NULL);
  hapto_result* result = nullptr;
  EXPECT_EQ(hapto_lab_test(nullptr, h.soil, nullptr, nullptr, nullptr, &result), HAPTO_NULL);
  EXPECT_EQ(hapto_lab_test("free-fall", h.soil, nullptr, nullptr, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_scene_trust(h.scene, nullptr, nullptr, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_soil_get(h.soil, "soil.radius_mm", nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_soil_profile(h.soil, 1, 0.1, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_psychometric_fit(nullptr, 1, nullptr, &result), HAPTO_NULL);
  EXPECT_EQ(hapto_psychometric_fit(&pose.position_m[0], 1, nullptr, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_device_limits_init(nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_loop_create(h.scene, nullptr, 0, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_loop_snapshot(h.loop, nullptr), HAPTO_NULL);
  hapto_safety* safety = nullptr;
  EXPECT_EQ(hapto_safety_create(nullptr, nullptr, 0, 1e-3, 1, &safety), HAPTO_NULL);
  EXPECT_EQ(hapto_safety_create(&limits, nullptr, 0, 1e-3, 1, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_safety_step(h.safety, nullptr, 0, nullptr), HAPTO_NULL);
  EXPECT_EQ(hapto_safety_get_info(h.safety, nullptr), HAPTO_NULL);

  hapto_error error{};
  EXPECT_EQ(hapto_last_error(&error), HAPTO_WRONG_SIZE);
  hapto_scene_info info{};
  EXPECT_EQ(hapto_scene_get_info(h.scene, &info), HAPTO_WRONG_SIZE);
  EXPECT_STREQ(lastError().key, "out");
  hapto_tool_state tool_state{};
  EXPECT_EQ(hapto_scene_tool_get_state(h.scene, 0, &tool_state), HAPTO_WRONG_SIZE);
  hapto_array array{};
  EXPECT_EQ(hapto_scene_view(h.scene, HAPTO_POSITION, &array), HAPTO_WRONG_SIZE);
  EXPECT_EQ(hapto_result_column(h.result, "depth_m", &array), HAPTO_WRONG_SIZE);
  hapto_snapshot snapshot{};
  EXPECT_EQ(hapto_loop_snapshot(h.loop, &snapshot), HAPTO_WRONG_SIZE);
  hapto_safety_info safety_info{};
  EXPECT_EQ(hapto_safety_get_info(h.safety, &safety_info), HAPTO_WRONG_SIZE);
  hapto_device_input input{};
  hapto_device_output output = sized<hapto_device_output>();
  EXPECT_EQ(hapto_safety_step(h.safety, &input, 0, &output), HAPTO_WRONG_SIZE);
  EXPECT_EQ(hapto_safety_create(&limits, nullptr, 0, 1e-3, 1, &safety), HAPTO_WRONG_SIZE);
  (void)pose;
  expectOk(hapto_loop_destroy(h.loop));
  for (hapto_scene* made : {h.scene, loops_scene}) {
    if (made == h.scene) {
      expectOk(hapto_batch_destroy(h.batch));
    }
    expectOk(hapto_scene_destroy(made));
  }
  expectOk(hapto_result_destroy(h.result));
  expectOk(hapto_soil_destroy(h.soil));
  expectOk(hapto_safety_destroy(h.safety));
}

TEST(EveryFunction, ASceneInUseIsBusy) {
  struct Inside {
    hapto_scene* scene;
    std::int32_t status = -1;
  };
  // A device that uses its loop's scene.
  const ScenePtr scene = sceneOf(kIcra2021);
  Inside inside{scene.get()};
  hapto_device device{};
  device.size = sizeof device;
  device.user = &inside;
  expectOk(hapto_device_limits_init(&device.limits));
  device.limits.simulated = 1;
  device.read = [](void* user, hapto_device_input* out) {
    auto& self = *static_cast<Inside*>(user);
    self.status = hapto_scene_step(self.scene, &out->pose, nullptr, nullptr);
  };
  device.write = [](void*, const hapto_device_output*) {};
  hapto_loop* loop = nullptr;
  expectOk(hapto_loop_create(scene.get(), &device, 1, &loop));
  (void)hapto_loop_tick(loop, 0);
  EXPECT_EQ(inside.status, HAPTO_BUSY);
  EXPECT_EQ(hapto_scene_destroy(scene.get()), HAPTO_BUSY);
  EXPECT_STREQ(lastError().message, hapto_status_text(HAPTO_BUSY));
  expectOk(hapto_loop_destroy(loop));
}

TEST(EveryFunction, ManyThreadsMeetAndNobodyCrashes) {
  const ScenePtr scene = sceneOf(kIcra2021);
  std::vector<std::thread> threads;
  std::atomic<int> ok{0};
  std::atomic<int> busy{0};
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int tick = 0; tick < 200; ++tick) {
        const hapto_pose pose = stirring(tick);
        const std::int32_t status = hapto_scene_step(scene.get(), &pose, nullptr, nullptr);
        ++(status == HAPTO_OK ? ok : busy);
        EXPECT_TRUE(status == HAPTO_OK || status == HAPTO_BUSY) << status;
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  hapto_scene_info info = sized<hapto_scene_info>();
  expectOk(hapto_scene_get_info(scene.get(), &info));
  EXPECT_EQ(info.steps, static_cast<std::uint64_t>(ok.load()) * info.substeps);
}

}  // namespace
}  // namespace haptolith::library

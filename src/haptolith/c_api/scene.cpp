// Scenes: soil in a box and a tool.

#include <haptolith/haptolith.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "haptolith/bed/measure/contact_load.h"
#include "haptolith/bed/start/tile_cache.h"
#include "haptolith/c_api/errors.h"
#include "haptolith/c_api/scene_object.h"
#include "haptolith/c_api/values.h"
#include "haptolith/c_api/with_handle.h"
#include "haptolith/machine/machine_fit.h"

using namespace haptolith;
using namespace haptolith::library;

namespace {

using Scenes = Places<hapto_scene>;

/// Makes a scene of what `scene_file` reads, and hands it out.
template <class Read>
std::int32_t make(Read&& scene_file, hapto_progress told, void* user, hapto_scene** out) {
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "out");
  }
  Progress progress(told, user);
  return progress.status([&] {
    readEnvironment();
    *out = Scenes::take(std::make_unique<SceneObject>(
        scene_file(progress), [&](double, double) { return progress.tell("soil settles", -1); }));
    return std::int32_t{HAPTO_OK};
  });
}

/// A scene by its name or from a file; `auto` in the finest soil that this machine renders in time.
SceneFile opened(std::string_view name, std::span<const std::string> overrides, Progress& progress) {
  SceneFile scene_file = findSceneFile(name, overrides);
  if (name == kAutoScene && !setsKey(overrides, "soil.radius_mm") && canBeFitted(scene_file)) {
    std::atomic<bool> stop{false};
    (void)fitToMachine(
        scene_file,
        {.threads = setsKey(overrides, "bed.threads") ? std::optional(scene_file.bed.threads) : std::nullopt,
         .folder = tileFolder(),
         .measuring = [&] { stop = !progress.tell("the machine is measured", -1); }},
        stop);
  }
  return scene_file;
}

/// Does `body` with the scene, and notes what went wrong.
template <class Body>
std::int32_t with(const hapto_scene* scene, Body&& body) {
  return withHandle(scene, "scene", std::forward<Body>(body));
}

/// Data of a field.
struct Field {
  std::int32_t type = 0;
  std::uint32_t components = 0;
  [[nodiscard]] std::uint64_t bytes() const noexcept {
    return std::uint64_t{components} * (type == HAPTO_UINT8 ? 1 : sizeof(float));
  }
};

Field fieldOf(std::int32_t number) noexcept {
  switch (number) {
    case HAPTO_POSITION:
    case HAPTO_VELOCITY: return {HAPTO_FLOAT32, 3};
    case HAPTO_RADIUS:
    case HAPTO_CONTACT_LOAD: return {HAPTO_FLOAT32, 1};
    case HAPTO_ASLEEP:
    case HAPTO_HELD: return {HAPTO_UINT8, 1};
    default: return {};
  }
}

void copyVectors(const std::vector<Float4>& records, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    *out++ = records[i].x;
    *out++ = records[i].y;
    *out++ = records[i].z;
  }
}

void copyField(const Bed& bed, std::int32_t field, void* out) {
  const BedState& state = bed.state();
  const std::size_t n = bed.particles();
  auto* const numbers = static_cast<float*>(out);
  auto* const bytes = static_cast<std::uint8_t*>(out);
  switch (field) {
    case HAPTO_POSITION: copyVectors(state.position, n, numbers); break;
    case HAPTO_VELOCITY: copyVectors(state.velocity, n, numbers); break;
    case HAPTO_RADIUS:
      for (std::size_t i = 0; i < n; ++i) {
        numbers[i] = static_cast<float>(bed.parameters().soil.radius_m) + state.position[i].w;
      }
      break;
    case HAPTO_CONTACT_LOAD: {
      const std::vector<float> loads = contactLoads(bed.parameters(), {state.position.data(), n});
      std::ranges::copy(loads, numbers);
      break;
    }
    case HAPTO_ASLEEP:
      for (std::size_t i = 0; i < n; ++i) {
        bytes[i] = state.asleep(i / kGroup) ? 1 : 0;
      }
      break;
    default:
      for (std::size_t i = 0; i < n; ++i) {
        bytes[i] = state.isHeld(i) ? 1 : 0;
      }
  }
}

}  // namespace

// --- making ----------------------------------------------------------------------------------------------------------

std::int32_t hapto_scene_from_toml(const char* text, const char* name, const char* const* overrides,
                                   std::uint32_t count, hapto_progress progress, void* user, hapto_scene** out) {
  return make(
      [&](Progress&) {
        return sceneFileFromText(textOrNothing(text), name == nullptr ? "scene" : name, texts(overrides, count));
      },
      progress, user, out);
}

std::int32_t hapto_scene_from_file(const char* name_or_path, const char* const* overrides, std::uint32_t count,
                                   hapto_progress progress, void* user, hapto_scene** out) {
  if (name_or_path == nullptr) {
    return wrongArgument(HAPTO_NULL, "name_or_path");
  }
  return make([&](Progress& told) { return opened(name_or_path, texts(overrides, count), told); }, progress, user, out);
}

std::int32_t hapto_scene_clone(const hapto_scene* scene, hapto_scene** out) {
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "out");
  }
  return with(scene, [&](const SceneObject& object) {
    *out = Scenes::take(std::make_unique<SceneObject>(object));
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_from_state(const void* bytes, std::uint64_t count, hapto_scene** out) {
  if (bytes == nullptr || out == nullptr) {
    return wrongArgument(HAPTO_NULL, bytes == nullptr ? "bytes" : "out");
  }
  return guarded([&] {
    readEnvironment();
    *out = Scenes::take(std::make_unique<SceneObject>(std::string_view(static_cast<const char*>(bytes), count)));
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_destroy(hapto_scene* scene) {
  Claim claim(scene);
  if (claim.status() != HAPTO_OK) {
    return wrongArgument(claim.status(), "scene");
  }
  claim.destroy();
  return HAPTO_OK;
}

// --- asking ----------------------------------------------------------------------------------------------------------

std::int32_t hapto_scene_get_info(const hapto_scene* scene, hapto_scene_info* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return wrongArgument(status, "out");
  }
  return with(scene, [&](const SceneObject& object) {
    const Scene& now = object.scene();
    const Bed& bed = now.bed();
    const BedParameters& parameters = bed.parameters();
    const Vec3& gravity_m_s2 = parameters.gravity_m_s2;
    give({.size = 0,
          .substeps = static_cast<std::uint32_t>(now.substeps()),
          .threads = static_cast<std::uint32_t>(parameters.threads),
          .friction = parameters.soil.friction == FrictionModel::kContact ? 1U : 0U,
          .particles = bed.particles(),
          .held = bed.heldParticles(),
          .awake = bed.awake(),
          .steps = bed.state().step,
          .tick_s = parameters.tick_s,
          .radius_m = parameters.soil.radius_m,
          .mass_kg = bed.mass(),
          .width_m = parameters.width_m,
          .length_m = parameters.length_m,
          .surface_m = bed.surfaceHeight(),
          .opening_m = now.opening(),
          .tool_fade = now.toolFade(),
          .energy_j = bed.energy(),
          .gravity_m_s2 = {gravity_m_s2.x(), gravity_m_s2.y(), gravity_m_s2.z()}},
         *out);
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_get_toml(const hapto_scene* scene, char* text, std::uint64_t capacity, std::uint64_t* needed) {
  return with(scene, [&](const SceneObject& object) {
    const std::string toml = sceneFileText(object.sceneFile());
    return handOut({toml.c_str(), toml.size() + 1}, text, capacity, needed);
  });
}

std::int32_t hapto_scene_get_tool_pose(const hapto_scene* scene, hapto_pose* out) {
  return quicklyWith(scene, out, [&](const SceneObject& object) {
    *out = pose(object.scene().toolPose());
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_get_wrench(const hapto_scene* scene, hapto_wrench* out) {
  return quicklyWith(scene, out, [&](const SceneObject& object) {
    *out = wrench(object.scene().soilWrench());
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_get_contact_stiffness(const hapto_scene* scene, double n_m[9]) {
  return quicklyWith(scene, n_m, [&](const SceneObject& object) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{n_m} = object.scene().contactStiffness();
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_get_grip_force(const hapto_scene* scene, double* n) {
  return quicklyWith(scene, n, [&](const SceneObject& object) {
    *n = object.scene().soilForce().grip_n;
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_state_hash(const hapto_scene* scene, std::uint64_t* out) {
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "out");
  }
  return with(scene, [&](const SceneObject& object) {
    *out = object.scene().hash();
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_view(const hapto_scene* scene, std::int32_t field, hapto_array* out) {
  if (const std::int32_t status = sizeStatus(out); status != HAPTO_OK) {
    return status;
  }
  if (field != HAPTO_POSITION && field != HAPTO_VELOCITY) {
    return HAPTO_INVALID_PARAMETER;
  }
  return quicklyWith(scene, out, [&](const SceneObject& object) {
    const BedState& state = object.scene().bed().state();
    give({.size = 0,
          .type = HAPTO_FLOAT32,
          .count = state.particles(),
          .components = 3,
          .stride_bytes = sizeof(Float4),
          .data = (field == HAPTO_POSITION ? state.position : state.velocity).data()},
         *out);
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_copy(const hapto_scene* scene, std::int32_t field, void* out, std::uint64_t bytes) {
  if (out == nullptr) {
    return wrongArgument(HAPTO_NULL, "out");
  }
  return with(scene, [&](const SceneObject& object) -> std::int32_t {
    const Bed& bed = object.scene().bed();
    const std::uint64_t each = fieldOf(field).bytes();
    if (each == 0) {
      throw InvalidParameter("field", field, {1, HAPTO_FIELDS});
    }
    if (bytes != each * bed.particles()) {
      throw InvalidParameter("bytes", std::to_string(bytes), std::to_string(each * bed.particles()));
    }
    copyField(bed, field, out);
    return HAPTO_OK;
  });
}

// --- moving ----------------------------------------------------------------------------------------------------------

std::int32_t hapto_scene_place_tool(hapto_scene* scene, const hapto_pose* scene_T_tool) {
  return quicklyWith(scene, scene_T_tool, [&](SceneObject& object) { return object.placeTool(0, *scene_T_tool); });
}

std::int32_t hapto_scene_step(hapto_scene* scene, const hapto_pose* scene_T_tool, const hapto_twist* twist,
                              hapto_wrench* felt) {
  return quicklyWith(scene, scene_T_tool, [&](SceneObject& object) { return object.step(*scene_T_tool, twist, felt); });
}

std::int32_t hapto_scene_steps(hapto_scene* scene, std::uint64_t count, const hapto_pose* poses,
                               const hapto_twist* twists, hapto_wrench* felt, std::uint64_t* done) {
  if (done != nullptr) {
    *done = 0;
  }
  return quicklyWith(scene, poses, [&](SceneObject& object) {
    std::int32_t status = HAPTO_OK;
    for (std::uint64_t i = 0; i < count && status == HAPTO_OK; ++i) {
      status = object.step(poses[i], twists == nullptr ? nullptr : twists + i, felt == nullptr ? nullptr : felt + i);
      if (done != nullptr && status == HAPTO_OK) {
        ++*done;
      }
    }
    return status;
  });
}

std::int32_t hapto_scene_set_opening(hapto_scene* scene, double share) {
  if (!(share >= 0 && share <= 1)) {
    return HAPTO_INVALID_PARAMETER;
  }
  return quicklyWith(scene, &share, [&](SceneObject& object) {
    object.setOpening(0, share);
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_set_tool_fade(hapto_scene* scene, double share) {
  if (!(share >= 0 && share <= 1)) {
    return HAPTO_INVALID_PARAMETER;
  }
  return quicklyWith(scene, &share, [&](SceneObject& object) {
    object.setFade(0, share);
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_set_gravity(hapto_scene* scene, const double m_s2[3]) {
  return quicklyWith(scene, m_s2, [&](SceneObject& object) {
    const Vec3 gravity_m_s2 = Vec3::Map(m_s2);
    if (!BedRanges::gravity_m_s2.contains(gravity_m_s2.norm())) {  // NaN is in no range
      return HAPTO_INVALID_PARAMETER;
    }
    object.setGravity(gravity_m_s2);
    return HAPTO_OK;
  });
}

std::int32_t hapto_scene_change(hapto_scene* scene, const char* const* overrides, std::uint32_t count) {
  return with(scene, [&](SceneObject& object) {
    object.carryOut(object.planned(texts(overrides, count)));
    return HAPTO_OK;
  });
}

// --- the whole state -------------------------------------------------------------------------------------------------

std::int32_t hapto_scene_get_state(const hapto_scene* scene, void* bytes, std::uint64_t capacity,
                                   std::uint64_t* needed) {
  return with(scene, [&](const SceneObject& object) { return handOut(object.save(), bytes, capacity, needed); });
}

std::int32_t hapto_scene_set_state(hapto_scene* scene, const void* bytes, std::uint64_t count) {
  if (bytes == nullptr) {
    return wrongArgument(HAPTO_NULL, "bytes");
  }
  return with(scene, [&](SceneObject& object) {
    object.restore({static_cast<const char*>(bytes), count});
    return HAPTO_OK;
  });
}

#pragma once

#include <haptolith/haptolith.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/bed/kernel/soil_laws.h"
#include "haptolith/c_api/handles.h"
#include "haptolith/scene/scene.h"
#include "haptolith/scene_file/scene_file.h"

namespace haptolith::library {

/// Checked changes of the existing soil.
struct SceneChanges {
  std::optional<Vec3> gravity_m_s2;
  std::optional<SoilLaws> laws;
  std::optional<ToolParameters> tool;
  SceneFile wanted;
};

/// A scene behind a handle: the scene itself, and the parameters that it has now.
class SceneObject {
 public:
  /// @throws InvalidParameter, Failure: as Scene.
  SceneObject(const SceneFile& scene_file, const SettleProgress& progress);
  /// Continues from the bytes of save(). @throws Failure for other bytes, another version or instruction set;
  /// InvalidParameter as Scene.
  explicit SceneObject(std::string_view saved);
  /// Continues from the state of another one.
  SceneObject(const SceneObject& other);
  SceneObject& operator=(const SceneObject&) = delete;

  [[nodiscard]] std::string save() const;
  /// As it was when this throws. @throws as the constructor, and InvalidParameter for a scene of other parameters.
  void restore(std::string_view bytes);

  /// A tick. May be called at 1 kHz.
  std::int32_t step(const hapto_pose& to, const hapto_twist* given, hapto_wrench* felt) noexcept;
  std::int32_t placeTool(const hapto_pose& at) noexcept;
  void setGravity(const Vec3& gravity_m_s2) noexcept;
  void setOpening(double share) noexcept { opening_ = share; }

  /// @throws InvalidParameter for what needs another bed.
  [[nodiscard]] SceneChanges planned(const std::vector<std::string>& overrides) const;
  void carryOut(const SceneChanges& changes);
  /// A loop has carried them out.
  void note(const SceneChanges& changes) { scene_file_ = changes.wanted; }

  [[nodiscard]] Scene& scene() noexcept { return *scene_; }
  [[nodiscard]] const Scene& scene() const noexcept { return *scene_; }
  [[nodiscard]] const SceneFile& sceneFile() const noexcept { return scene_file_; }
  /// HAPTO_OK, or what the bed has come to.
  [[nodiscard]] std::int32_t condition() const noexcept { return condition_; }
  /// For a recording that begins now: 0 when soil and tool are as the scene says, else ticks so far, at least 1.
  [[nodiscard]] std::uint64_t startTick() const noexcept;
  /// From a loop, which may not have come to all that was noted.
  void takeBack(std::int32_t condition, double tool_fade);

 private:
  struct Saved;
  [[nodiscard]] static Saved parsed(std::string_view bytes);
  explicit SceneObject(const Saved& saved);
  void goOn(const Saved& saved);

  SceneFile scene_file_;
  SoilParameters made_of_;  ///< the soil that the bed was made with: its neighbour lists reach as far as that needs
  std::unique_ptr<Scene> scene_;
  std::int32_t condition_ = HAPTO_OK;
  double opening_ = 1;
  bool as_made_ = true;  ///< gravity, soil and tool are unchanged, and no state was set
};

}  // namespace haptolith::library

struct hapto_scene : haptolith::library::HandleOf<haptolith::library::SceneObject> {
  static constexpr std::uint32_t kKind = 0x48615363;
};

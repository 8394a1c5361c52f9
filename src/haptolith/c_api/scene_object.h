#pragma once

#include <haptolith/haptolith.h>

#include <array>
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

/// Another tool in the place of one.
struct ToolChange {
  std::size_t tool = 0;
  ToolParameters parameters{};
};

/// Checked changes of the existing soil.
struct SceneChanges {
  std::optional<Vec3> gravity_m_s2;
  std::optional<SoilLaws> laws;
  std::vector<ToolChange> tools;
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

  /// A tick of the first tool. May be called at 1 kHz, as all to setDrive().
  std::int32_t step(const hapto_pose& to, const hapto_twist* given, hapto_wrench* felt) noexcept {
    return move(&to, given, 1, felt);
  }
  /// A tick of all tools; `count` must be their number.
  std::int32_t stepTools(const hapto_pose* poses, const hapto_twist* given, std::uint64_t count,
                         hapto_wrench* felt) noexcept {
    return count == scene_->tools() ? move(poses, given, count, felt) : HAPTO_WRONG_TOOL;
  }
  std::int32_t placeTool(std::size_t tool, const hapto_pose& at) noexcept;
  void setGravity(const Vec3& gravity_m_s2) noexcept;
  void setOpening(std::size_t tool, double share) noexcept { uses_[tool].opening = share; }
  void setFade(std::size_t tool, double share) noexcept;
  /// A tool touches the soil from now on.
  void enterSoil(std::size_t tool) noexcept;
  [[nodiscard]] double fade(std::size_t tool) const noexcept { return uses_[tool].fade; }
  /// Whether the tool has been placed or stepped, and may touch the soil. The first one may from the start.
  [[nodiscard]] bool inSoil(std::size_t tool) const noexcept { return uses_[tool].in_soil; }
  std::int32_t setDrive(std::size_t tool, double value) noexcept;

  /// @throws InvalidParameter for what needs another bed.
  [[nodiscard]] SceneChanges planned(const std::vector<std::string>& overrides) const;
  void carryOut(const SceneChanges& changes);
  /// A loop has carried them out.
  void note(const SceneChanges& changes) { scene_file_ = changes.wanted; }

  [[nodiscard]] Scene& scene() noexcept { return *scene_; }
  [[nodiscard]] const Scene& scene() const noexcept { return *scene_; }
  [[nodiscard]] const SceneFile& sceneFile() const noexcept { return scene_file_; }
  /// Names of the tools, which never change.
  [[nodiscard]] const std::vector<std::string>& toolNames() const noexcept { return tool_names_; }
  /// HAPTO_OK, or what the bed has come to.
  [[nodiscard]] std::int32_t condition() const noexcept { return condition_; }
  /// For a recording that begins now: 0 when soil and tools are as the scene says, else ticks so far, at least 1.
  /// @param moved  number of the tools that the recorded loop moves.
  [[nodiscard]] std::uint64_t startTick(std::size_t moved) const noexcept;
  /// From a loop, which may not have come to all that was noted.
  void takeBack(std::int32_t condition);

 private:
  struct Saved;
  /// Use of a tool.
  struct ToolUse {
    double opening = 1;  ///< opening of jaws at the end of the next tick
    double fade = 1;     ///< requested fraction; the scene has 0 until the tool is in the soil
    bool in_soil = true;
  };
  using ToolUses = std::array<ToolUse, ToolSet::kMost>;

  [[nodiscard]] static Saved parsed(std::string_view bytes);
  explicit SceneObject(const Saved& saved);
  void goOn(const Saved& saved);
  void placeAtStart() noexcept;
  [[nodiscard]] bool isValid(const hapto_pose& at) const noexcept;
  [[nodiscard]] HandState handFor(std::size_t tool, const hapto_pose& to, const hapto_twist* given) const noexcept;
  std::int32_t move(const hapto_pose* poses, const hapto_twist* given, std::size_t count, hapto_wrench* felt) noexcept;
  void setTool(std::size_t tool, const ToolParameters& parameters) noexcept;

  SceneFile scene_file_;
  SoilParameters made_of_;  ///< the soil that the bed was made with: its neighbour lists reach as far as that needs
  std::unique_ptr<Scene> scene_;
  std::int32_t condition_ = HAPTO_OK;
  std::vector<std::string> tool_names_;
  ToolUses uses_;
  std::array<HandState, ToolSet::kMost> hands_;  ///< in a tick
  bool as_made_ = true;                          ///< gravity, soil and tools are unchanged, and no state was set
};

}  // namespace haptolith::library

struct hapto_scene : haptolith::library::HandleOf<haptolith::library::SceneObject> {
  static constexpr std::uint32_t kKind = 0x48615363;
};

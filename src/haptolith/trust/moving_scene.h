#pragma once

#include <memory>
#include <vector>

#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/trust/trust_force.h"
#include "haptolith/trust/trust_plan.h"

namespace haptolith {

/// A scene of `haptolith trust` with its hands, its soil settled, ready to move.
class MovingScene {
 public:
  /// @throws as Scene.
  MovingScene(const TrustRun& run, int threads, const TrustProgress& progress);

  /// One tick. @return whether the movement continues. @throws Failure when it cannot.
  bool tick();

  /// Movements of all hands in the next tick, whatever the soil does. Not together with tick().
  [[nodiscard]] std::vector<HandState> nextMovements();

  [[nodiscard]] Scene& scene() noexcept { return scene_; }
  [[nodiscard]] const SceneFile& file() const noexcept { return file_; }
  /// Height of the soil's surface at the beginning, scene frame.
  [[nodiscard]] double surface() const noexcept { return surface_m_; }

 private:
  [[nodiscard]] ToolHandling handlingOfFirst(const TrustRun& run);

  SceneFile file_;
  Scene scene_;
  double surface_m_ = 0;
  std::vector<std::unique_ptr<VirtualHand>> hands_;
  std::unique_ptr<HapticLoop> loop_;
};

}  // namespace haptolith

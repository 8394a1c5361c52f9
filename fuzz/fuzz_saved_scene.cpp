// Saved scene: bytes from a file or another program, which are refused or tolerated.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/scene/scene.h"

using namespace haptolith;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  BedParameters bed;
  bed.soil.friction = FrictionModel::kContact;
  bed.particles = 16;
  bed.layers = 1;
  try {
    Scene scene(bed, {}, deserialiseSavedScene({reinterpret_cast<const char*>(data), size}));
    HandState hand;
    hand.pose.position_m = {0, 0, 0.015};
    for (int tick = 0; tick < 3 && scene.tick(hand) == StepStatus::kOk; ++tick) {
    }
  } catch (const InvalidParameter&) {
  } catch (const Failure&) {
  }
  return 0;
}

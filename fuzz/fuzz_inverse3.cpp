// Messages of a Haply service, or of another program at its port: each is ignored, or contains a plausible state; a
// device of any name can be commanded.

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "haptolith/device/drivers/inverse3_messages.h"

namespace {

void require(bool right) {
  if (!right) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace haptolith;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto inventory = parseHaplyInventory(text);
  std::string device = "049D";
  std::string grip = "61A5";
  if (inventory) {
    for (const std::string& id : inventory->devices) {
      require(!id.empty() && id.size() <= 64);
      const auto command = nlohmann::json::parse(inverse3Command(id, Vec3(1, 2, 3), inventory->dialect));
      require(command["inverse3"][0]["device_id"] == id);
      device = id;
    }
    if (!inventory->grips.empty()) {
      grip = inventory->grips.back();
    }
  }
  if (const auto state = parseInverse3State(text, device, grip)) {
    require(inventory.has_value());
    require(state->position_m.allFinite() && state->position_m.cwiseAbs().maxCoeff() <= 2);
    require(state->velocity_m_s.allFinite() && state->velocity_m_s.cwiseAbs().maxCoeff() <= 50);
    require(!state->orientation || std::abs(state->orientation->norm() - 1) < 1e-12);
    require(state->buttons.value_or(0) < 8);
  }
  return 0;
}

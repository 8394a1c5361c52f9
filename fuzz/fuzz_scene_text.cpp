// Text of a scene, and overrides: the first line is an override, the rest a scene file.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/scene_file/scene_file.h"

using namespace haptolith;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t line = text.find('\n');
  const std::vector<std::string> overrides{std::string(text.substr(0, line))};
  try {
    const SceneFile scene =
        sceneFileFromText(line == std::string_view::npos ? "" : text.substr(line + 1), "scene", overrides);
    (void)changed(scene, overrides);
  } catch (const InvalidParameter&) {
  } catch (const Failure&) {
  }
  return 0;
}

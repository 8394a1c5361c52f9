// A client's messages: whatever they are, they are understood or refused, and a scene that results is one that can be
// made.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/viewer/command.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace haptolith;
  const ClientMessage message = parseClientMessage({reinterpret_cast<const char*>(data), size});
  if (int{message.command.has_value()} + int{message.for_guest} + int{!message.refused.empty()} != 1) {
    std::abort();  // one of the three
  }
  if (message.command && std::holds_alternative<command::Change>(*message.command)) {
    try {
      validate(changed(SceneFile{}, std::get<command::Change>(*message.command).change));
    } catch (const InvalidParameter&) {  // as it should
    } catch (const Failure&) {
    }
  }
  return 0;
}

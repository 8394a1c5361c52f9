// Messages of a client: each is parsed or refused, and a resulting scene is valid.

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
    std::abort();  // exactly one of the three must hold
  }
  if (message.command && std::holds_alternative<command::Change>(*message.command)) {
    try {
      validate(changed(SceneFile{}, std::get<command::Change>(*message.command).change));
    } catch (const InvalidParameter&) {  // expected
    } catch (const Failure&) {
    }
  }
  return 0;
}

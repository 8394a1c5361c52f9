// Training from an untrusted source: an accepted one can be written, and is read as it was written.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "haptolith/core/error.h"
#include "haptolith/identify/training/training_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace haptolith;
  try {
    const Training training = parseTraining({reinterpret_cast<const char*>(data), size}, "fuzz");
    const std::string text = trainingText(training);
    if (trainingText(parseTraining(text, "again")) != text) {
      std::abort();
    }
  } catch (const InvalidParameter&) {  // refused with a message
  }
  return 0;
}

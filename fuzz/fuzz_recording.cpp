// Recording from an untrusted source: it is read or refused.

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/child_process.h"
#include "haptolith/recording/recording_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace haptolith;
  const Descriptor file(memfd_create("recording", MFD_CLOEXEC));
  if (write(file.number(), data, size) != static_cast<ssize_t>(size)) {
    std::abort();
  }
  constexpr std::uint64_t kSome = 1000;
  try {
    const RecordingReader recording("/proc/self/fd/" + std::to_string(file.number()));
    (void)recording.readTicks(0, kSome);
    (void)recording.readEvents(0, kSome);
    for (const FrameRow& row : recording.readFrameRows(0, kSome)) {
      if (recording.readFrame(row).position_m.size() != row.count) {
        std::abort();
      }
    }
  } catch (const Failure&) {  // expected
  }
  return 0;
}

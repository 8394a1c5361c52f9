// Table from an untrusted source: it is read or refused by each of the readers. The first byte selects the reader.

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/device/hand/pose_file.h"
#include "haptolith/identify/measured_movement.h"
#include "haptolith/psychometrics/answers_file.h"
#include "haptolith/scene_file/given_grains.h"
#include "haptolith/teleop/link/link_parameters.h"

namespace {

using namespace haptolith;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void readBy(char reader, const std::filesystem::path& path) {
  if (reader == 'p') {
    require(std::isfinite(PoseFile::read(path).at(1).position_m.norm()));
  } else if (reader == 'd') {
    validate(LinkParameters{.delays = readDelays(path)});
  } else if (reader == 'g') {
    require(readGrains(path, 0.007).grains != nullptr);
  } else if (reader == 'm') {
    static const ToolMovement kMovement({{0, {}}, {1, {{0.1, 0, 0}, Quat::Identity()}}});
    (void)matchForces(kMovement, readMeasured(path), Vec3::Zero());
  } else {
    for (const AnswersOf& of : readAnswersFile(path).people) {
      require(!of.levels.empty());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = memfd_create("table", 0);
  static const std::filesystem::path path("/proc/self/fd/" + std::to_string(file));
  if (size == 0) {
    return 0;
  }
  require(ftruncate(file, 0) == 0 && pwrite(file, data + 1, size - 1, 0) == static_cast<ssize_t>(size - 1));
  try {
    readBy(static_cast<char>(data[0]), path);
  } catch (const InvalidParameter&) {  // refused with a message
  }
  return 0;
}

// A program that records, for tests in which it is killed or its disk is full.
//
//   recording_helper record FILE          1000 ticks a second until it is killed; the number added so far is
//                                         eight bytes in FILE.added
//   recording_helper full FILE BYTES      no file may grow beyond BYTES: records until there is a problem, and prints
//   it recording_helper make FILE TICKS PARTICLES   a finished file

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "haptolith/core/platform/clock.h"
#include "haptolith/recording/recording_writer.h"

#include "made_up.h"

namespace haptolith {
namespace {

void addTenTicks(RecordingWriter& writer, std::uint64_t first) {
  std::vector<TickRecord> ticks;
  for (std::uint64_t n = first; n < first + 10; ++n) {
    ticks.push_back(madeUpTick(n));
  }
  writer.add(ticks);
  if (first % 30 == 0) {
    writer.add(madeUpFrame(first / 30, 256 + first % 7));
  }
}

int record(const std::string& path) {
  RecordingWriter writer(path, madeUpHeader(), {.overwrite = true});
  const int added = open((path + ".added").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  const std::int64_t start_ns = monotonicNs();
  for (std::uint64_t n = 0;; n += 10) {
    addTenTicks(writer, n);
    const std::uint64_t so_far = n + 10;
    if (pwrite(added, &so_far, sizeof(so_far), 0) != sizeof(so_far) || !writer.problem().empty()) {
      return 1;
    }
    sleepUntilNs(start_ns + static_cast<std::int64_t>(so_far) * 1'000'000);
  }
}

int recordUntilFull(const std::string& path, rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{.rlim_cur = bytes, .rlim_max = bytes};
  if (setrlimit(RLIMIT_FSIZE, &limit) != 0) {
    return 1;
  }
  RecordingWriter writer(path, madeUpHeader());
  for (std::uint64_t n = 0; writer.problem().empty(); n += 10) {
    addTenTicks(writer, n);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  addTenTicks(writer, 0);  // without effect
  writer.finish();
  std::puts(writer.problem().c_str());
  return 0;
}

int make(const std::string& path, std::uint64_t ticks, std::size_t particles) {
  RecordingWriter writer(path, madeUpHeader(), {.overwrite = true, .wait_when_full = true});
  for (std::uint64_t n = 0; n < ticks; ++n) {
    writer.add(std::vector<TickRecord>{madeUpTick(n)});
    if (n % 33 == 0) {
      writer.add(madeUpFrame(n / 33, particles + n % 2));
    }
  }
  writer.add(RecordingEvent{.time_s = 0, .tick = 0, .kind = "start", .text = "made up"});
  writer.finish();
  return writer.problem().empty() ? 0 : 1;
}

}  // namespace
}  // namespace haptolith

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 2 && arguments[0] == "record") {
    return haptolith::record(arguments[1]);
  }
  if (arguments.size() == 3 && arguments[0] == "full") {
    return haptolith::recordUntilFull(arguments[1], std::stoull(arguments[2]));
  }
  if (arguments.size() == 4 && arguments[0] == "make") {
    return haptolith::make(arguments[1], std::stoull(arguments[2]), std::stoull(arguments[3]));
  }
  std::fputs("usage: recording_helper record|full|make FILE ...\n", stderr);
  return 2;
}

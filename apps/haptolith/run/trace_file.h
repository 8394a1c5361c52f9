#pragma once

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/haptics/loop/haptic_loop.h"

namespace haptolith {

/// CSV file of every tick of a run, columns as in header(); the first eight are a pose file. Written atomically.
class TraceFile {
 public:
  explicit TraceFile(const OutputFile& file);
  void write(const TickRecord& record);
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
};

}  // namespace haptolith

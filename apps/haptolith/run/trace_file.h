#pragma once

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/haptics/loop/haptic_loop.h"

namespace haptolith {

/// Every tick of a run as CSV, columns as in header(): the first eight make a pose file. Appears whole or not at all.
class TraceFile {
 public:
  explicit TraceFile(const OutputFile& file);
  void write(const TickRecord& record);
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
};

}  // namespace haptolith

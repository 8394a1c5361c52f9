#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <vector>

#include "haptolith/recording/recording_types.h"

namespace haptolith::hdf5 {

/// A dataset that grows at its end.
class Growing {
 public:
  /// Rows of `columns` values each, or of one value when that is 0.
  struct Layout {
    Handle file_type, memory_type;
    std::uint64_t chunk_rows = 0, columns = 0;
    bool deflated = false;
  };

  Growing() = default;
  /// @throws Failure.
  Growing(const Handle& file, const char* path, Layout layout);

  /// @throws Failure; the rows in the file are then those before.
  void append(const void* values, std::uint64_t rows);
  /// Hands everything to the system. @throws Failure.
  void flush();
  void close() noexcept { dataset_.close(); }

  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }
  /// Those that the system has been given.
  [[nodiscard]] std::uint64_t flushedRows() const noexcept { return flushed_rows_; }

 private:
  Handle dataset_, memory_type_;
  std::uint64_t columns_ = 0, rows_ = 0, flushed_rows_ = 0;
};

/// @throws Failure when the file is there and may not be overwritten.
void requireFree(const std::filesystem::path& path, bool overwrite);

/// Rows to be written.
struct Batch {
  std::vector<TickRecord> ticks = {};
  std::vector<ParticleFrame> frames = {};
  std::vector<RecordingEvent> events = {};
  std::vector<RobotRow> reports = {};
  std::vector<SiteRow> site = {};
};

/// A recording's file while it is written, in HDF5's SWMR mode: at any moment what is on the disk is a file that opens.
/// From one thread.
class RecordingFile {
 public:
  /// @throws as RecordingWriter.
  /// @param robot  whether it has tables for a robot's reports.
  RecordingFile(std::filesystem::path path, const RecordingHeader& header, bool overwrite, bool robot);
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  /// Takes what is to be written; nothing is written yet.
  void take(const Batch& batch);

  [[nodiscard]] bool hasUnwritten() const noexcept;

  /// Writes all when at least one more chunk of ticks is full, except the ticks of the next chunk: a compressed chunk
  /// that is written twice leaves a hole in the file. False when there was nothing to do. @throws Failure.
  bool writeWholeChunks();
  /// @throws Failure.
  void writeAll() { write(unwritten_ticks_.size()); }

  /// Number of ticks between the first and the last to be recorded that never arrived. take() has noticed those
  /// before others; the rest were the last. Recorded as events, and on close() in the header.
  void countLost(std::uint64_t lost);

  /// Marks the file as complete. @throws Failure.
  void close();
  /// After a failure: leaves the file on the disk as it was after the last write that went well.
  void abandon() noexcept;

  // Amount that is safe on the disk.
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_.flushedRows(); }
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_.flushedRows(); }
  [[nodiscard]] std::uint64_t events() const noexcept { return events_.flushedRows(); }
  [[nodiscard]] std::uint64_t bytes() const;

  /// Ticks that were to be in the file and never came.
  [[nodiscard]] std::uint64_t missing() const noexcept { return missing_; }

 private:
  void makeTools(const RecordingHeader& header);
  void write(std::size_t ticks);
  [[nodiscard]] int descriptor() const;
  void noteMissing(std::uint64_t ticks, double time_s);

  std::filesystem::path path_;
  std::uint64_t ticks_per_chunk_;
  double tick_s_;
  bool whole_run_;
  std::uint64_t last_number_ = 0, missing_ = 0;
  double last_time_s_ = 0;
  Handle file_;
  Growing ticks_, position_, frames_, events_, reports_, site_;
  /// Tables of a tool, in addition to those that all tools share.
  struct Tool {
    std::optional<Growing> ticks, joint;  ///< none of the first tool, or without a joint
    std::vector<TickRecord> unwritten_ticks = {};
    std::vector<JointRow> unwritten_joint = {};
  };
  std::deque<Tool> tools_;
  std::vector<Growing*> all_;  ///< that the file has; positions before the frames that point at them

  std::vector<TickRecord> unwritten_ticks_;
  std::vector<std::array<float, 3>> unwritten_positions_;
  std::vector<FrameRow> unwritten_frames_;
  std::vector<EventRow> unwritten_events_;
  std::vector<RobotRow> unwritten_reports_;
  std::vector<SiteRow> unwritten_site_;
};

}  // namespace haptolith::hdf5

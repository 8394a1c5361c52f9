#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "haptolith/recording/recording_format.h"

namespace haptolith {

/// Reads a recording, also one whose writer was killed or still writes: it has what was in the file when it was opened.
/// Lengths and types that the file claims are checked before memory is taken. Not for the tick.
class RecordingReader {
 public:
  /// @throws Failure when the file cannot be read, is no recording, is one of another version, or is damaged.
  explicit RecordingReader(const std::filesystem::path& path);
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;

  [[nodiscard]] const RecordingHeader& header() const noexcept;
  /// False when its writer was killed or still writes.
  [[nodiscard]] bool finished() const noexcept;

  /// Ticks that were to be recorded and could not be, as its writer has counted them; 0 when that was an older program,
  /// or one that was killed: gaps then show only in the numbers of the ticks.
  [[nodiscard]] std::uint64_t missingTicks() const noexcept;

  [[nodiscard]] std::uint64_t ticks() const noexcept;
  [[nodiscard]] std::uint64_t frames() const noexcept;
  [[nodiscard]] std::uint64_t events() const noexcept;
  /// Number of reports of a robot that followed the tool; 0 without one.
  [[nodiscard]] std::uint64_t reports() const noexcept;
  [[nodiscard]] std::uint64_t siteRows() const noexcept;

  /// Tools of the scene, in order; at least one.
  [[nodiscard]] const std::vector<RecordedTool>& tools() const noexcept;

  /// `count` of them beginning with number `first`, or as many as there are. @throws Failure when the file is damaged.
  /// @param tool  its number; its joint is that of the same row.
  [[nodiscard]] std::vector<TickRecord> readTicks(std::uint64_t first, std::uint64_t count, std::size_t tool = 0) const;
  [[nodiscard]] std::vector<FrameRow> readFrameRows(std::uint64_t first, std::uint64_t count) const;
  [[nodiscard]] std::vector<RecordingEvent> readEvents(std::uint64_t first, std::uint64_t count) const;
  [[nodiscard]] std::vector<RobotRow> readReports(std::uint64_t first, std::uint64_t count) const;
  [[nodiscard]] std::vector<SiteRow> readSite(std::uint64_t first, std::uint64_t count) const;
  /// The particles of a frame. @throws Failure as readTicks(), and when the row is of another file.
  [[nodiscard]] ParticleFrame readFrame(const FrameRow& row) const;

 private:
  class File;
  std::unique_ptr<File> file_;
};

}  // namespace haptolith

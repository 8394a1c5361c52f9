#pragma once

#include <string>
#include <string_view>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/platform/child_process.h"

namespace haptolith {

/// Animation encoded by ffmpeg: .mp4 (H.264) or .webm (VP9). It is written atomically.
class FilmFile {
 public:
  /// @throws InvalidParameter for another ending; Failure if the file cannot be written or ffmpeg is not installed.
  FilmFile(const OutputFile& file, double pictures_per_s);

  /// Adds a frame, the bytes of a PNG. @throws Failure with ffmpeg's message; when the work is stopped.
  void add(std::string_view png);

  /// Waits for ffmpeg and renames the file into place. @throws Failure with ffmpeg's message.
  void save();

 private:
  [[noreturn]] void fail() const;

  std::string path_;
  AtomicFile file_;
  Pipe pictures_;
  Descriptor words_;  ///< ffmpeg's error messages
  ChildProcess ffmpeg_;
};

}  // namespace haptolith

#pragma once

#include <string>
#include <string_view>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/process/child_process.h"

namespace haptolith {

/// A film that ffmpeg makes of pictures: .mp4 (H.264) or .webm (VP9). It appears whole or not at all.
class FilmFile {
 public:
  /// @throws InvalidParameter for another ending; Failure when the file cannot be written or ffmpeg is not installed.
  FilmFile(const OutputFile& file, double pictures_per_s);

  /// Adds a picture, the bytes of a PNG. @throws Failure with ffmpeg's words; when the work is stopped.
  void add(std::string_view png);

  /// Waits for ffmpeg and renames the file into place. @throws Failure with ffmpeg's words.
  void save();

 private:
  [[noreturn]] void fail() const;

  std::string path_;
  AtomicFile file_;
  Pipe pictures_;
  Descriptor words_;  ///< what ffmpeg has to complain about
  ChildProcess ffmpeg_;
};

}  // namespace haptolith

#include "run/film_file.h"

#include <fmt/format.h>

#include <chrono>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {

namespace {

using Words = std::vector<std::string>;

/// Max. processor time of the encoder; an animation of an hour takes a few hours.
constexpr std::chrono::hours kMostCpu{24};

/// Timeout between two frames, and after the last one.
constexpr std::chrono::minutes kTimeout{10};

/// Returns the encoder's command: sharp particles, within acceptable time.
Words encoderFor(const std::filesystem::path& path) {
  if (path.extension() == ".mp4") {
    return {"-c:v", "libx264", "-crf", "20", "-movflags", "+faststart"};
  }
  if (path.extension() == ".webm") {
    return {"-c:v", "libvpx-vp9", "-crf", "32", "-b:v", "0", "-cpu-used", "4", "-row-mt", "1"};
  }
  throw InvalidParameter("out", fmt::format("'{}'", path.string()), "a file name ending in .mp4 or .webm for a film");
}

ChildProcess::Command commandFor(const std::filesystem::path& path, const std::string& output, double pictures_per_s) {
  Words words{"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostats", "-f", "image2pipe", "-c:v", "png",
              "-framerate", fmt::format("{}", pictures_per_s), "-i", "pipe:0",
              // Players expect these for an animation of this size, and guess values that are not set.
              "-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p", "-colorspace", "bt709",
              "-color_primaries", "bt709", "-color_trc", "bt709"};
  const Words encoder = encoderFor(path);
  words.insert(words.end(), encoder.begin(), encoder.end());
  words.insert(words.end(), {"-y", "file:" + output});  // for any file name
  return {.arguments = std::move(words), .package = "ffmpeg", .environment = {}, .most_cpu = kMostCpu};
}

AtomicFile fileFor(const OutputFile& file) {
  (void)encoderFor(file.path);  // reports a wrong ending before any output is written
  return AtomicFile(file);
}

}  // namespace

FilmFile::FilmFile(const OutputFile& file, double pictures_per_s)
    : path_(file.path.string()),
      file_(fileFor(file)),
      words_(temporaryFile()),
      ffmpeg_(commandFor(file.path, file_.temporaryPath().string(), pictures_per_s),
              {{pictures_.to_read, kStandardInput}, {words_, kStandardOutput}, {words_, kStandardError}}) {
  pictures_.to_read.close();
}

void FilmFile::add(std::string_view png) {
  if (!writeAll(pictures_.to_write, png,
                {.until = std::chrono::steady_clock::now() + kTimeout, .stopped = [] { return stopAsked().load(); }})) {
    fail();
  }
}

void FilmFile::save() {
  pictures_.to_write.close();
  if (!ffmpeg_.wait(kTimeout)) {
    fail();
  }
  file_.commit();
}

void FilmFile::fail() const {
  throw Failure(fmt::format("ffmpeg cannot make {}:\n{}", path_, contentOf(words_)));
}

}  // namespace haptolith

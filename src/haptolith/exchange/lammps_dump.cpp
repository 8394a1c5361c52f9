#include "haptolith/exchange/lammps_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/input_file.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

constexpr TextLimits kLimits{.bytes = 1ULL << 40U, .line_bytes = 4000, .rows = 10'000'000};
constexpr std::array<std::string_view, 9> kColumns{"id", "x", "y", "z", "radius", "type", "vx", "vy", "vz"};
constexpr std::size_t kNeeded = 5, kType = 5, kVelocity = 6;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::string_view nextWord(std::string_view& rest) {
  const std::size_t from = rest.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) {
    rest = {};
    return {};
  }
  const std::size_t to = std::min(rest.find_first_of(" \t\r", from), rest.size());
  const std::string_view word = rest.substr(from, to - from);
  rest.remove_prefix(to);
  return word;
}

/// A dump on its way into the program, picture by picture.
class DumpReader {
 public:
  explicit DumpReader(const std::filesystem::path& path)
      : path_(path.string()), file_(openInput(path, kLimits.bytes)), lines_(file_, path_, kLimits) {}

  /// The next picture that is whole; false at the end of the file. Where `wanted` is not its number, its grains are
  /// passed over.
  bool next(LammpsPicture& picture, std::optional<std::size_t> wanted) {
    if (!lines_.next(line_)) {
      return false;
    }
    LammpsPicture read;
    read.number = ++count_;
    std::size_t grains = 0;
    while (!line_.starts_with("ITEM: ATOMS")) {
      if (!line_.starts_with("ITEM: ")) {
        refuse(line_, "a dump of LAMMPS: a line that begins with ITEM:");
      }
      const bool is_step = line_.starts_with("ITEM: TIMESTEP"), is_count = line_.starts_with("ITEM: NUMBER OF ATOMS");
      const bool is_time = line_ == "ITEM: TIME";
      bool ended = !lines_.next(line_);
      while (!ended && !line_.starts_with("ITEM: ")) {
        if (is_step) {
          read.step = whole(line_);
        } else if (is_time) {
          std::string_view rest = line_;
          read.time_s = number(nextWord(rest));
        } else if (is_count) {
          grains = count(line_);
        }
        ended = !lines_.next(line_);
      }
      if (ended) {
        return false;
      }
    }
    if (!readGrains(read, grains, !wanted || *wanted == read.number)) {
      return false;
    }
    picture = std::move(read);
    return true;
  }

  [[noreturn]] void refuse(std::string_view value, std::string_view valid) const {
    throw InvalidParameter(fmt::format("{}:{}", path_, lines_.number()), inQuotes(value), std::string(valid));
  }

 private:
  bool readGrains(LammpsPicture& picture, std::size_t grains, bool keeps) {
    const std::array<std::size_t, kColumns.size()> places = keeps ? placesOf(line_) : decltype(placesOf(line_)){};
    picture.has_velocities = keeps && std::all_of(places.begin() + kVelocity, places.end(),
                                                  [](std::size_t place) { return place != kNone; });
    picture.grains.reserve(keeps ? grains : 0);
    for (std::size_t i = 0; i < grains; ++i) {
      if (!lines_.next(line_)) {
        return false;
      }
      if (keeps) {
        picture.grains.push_back(grain(places));
      }
    }
    return true;
  }

  [[nodiscard]] std::array<std::size_t, kColumns.size()> placesOf(std::string_view heading) const {
    std::array<std::size_t, kColumns.size()> places{};
    places.fill(kNone);
    std::string_view rest = heading.substr(std::string_view("ITEM: ATOMS").size());
    std::size_t place = 0;
    for (std::string_view word = nextWord(rest); !word.empty(); word = nextWord(rest), ++place) {
      for (std::size_t c = 0; c < kColumns.size(); ++c) {
        // A variable of the script's that tells the grains' radii goes before those of LAMMPS' spheres.
        const bool is_own = word.starts_with("v_") && word.substr(2) == kColumns.at(c);
        places.at(c) = is_own || (word == kColumns.at(c) && places.at(c) == kNone) ? place : places.at(c);
      }
    }
    for (std::size_t c = 0; c < kNeeded; ++c) {
      if (places.at(c) == kNone) {
        refuse(heading, fmt::format("with a column {}: dump ... custom ... id type x y z radius", kColumns.at(c)));
      }
    }
    return places;
  }

  [[nodiscard]] DumpedGrain grain(const std::array<std::size_t, kColumns.size()>& places) const {
    std::array<double, kColumns.size()> numbers{};
    numbers.at(kType) = 1;  // the type, where nobody tells it
    std::size_t found = 0;
    std::string_view rest = line_;
    std::size_t place = 0;
    for (std::string_view word = nextWord(rest); !word.empty(); word = nextWord(rest), ++place) {
      for (std::size_t c = 0; c < kColumns.size(); ++c) {
        if (places.at(c) == place) {
          numbers.at(c) = number(word);
          found += c < kNeeded ? 1 : 0;
        }
      }
    }
    if (found < kNeeded) {
      refuse(line_, "as many numbers as the heading has columns");
    }
    return {.id = static_cast<std::int64_t>(numbers[0]),
            .type = static_cast<int>(numbers[kType]),
            .centre_m = {numbers[1], numbers[2], numbers[3]},
            .radius_m = numbers[4],
            .velocity_m_s = {numbers[6], numbers[7], numbers[8]}};
  }

  [[nodiscard]] double number(std::string_view word) const {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    constexpr double kMost = 1e15;
    if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= kMost)) {
      refuse(word, "a finite number");
    }
    return value;
  }
  [[nodiscard]] std::int64_t whole(std::string_view line) const {
    return static_cast<std::int64_t>(number(nextWord(line)));
  }
  [[nodiscard]] std::size_t count(std::string_view line) const {
    const std::int64_t value = whole(line);
    if (value < 1 || value > kLimits.rows) {
      refuse(line, fmt::format("1 to {} grains", kLimits.rows));
    }
    return static_cast<std::size_t>(value);
  }

  std::string path_;
  std::ifstream file_;
  LineReader lines_;
  std::string line_;
  std::size_t count_ = 0;
};

}  // namespace

LammpsPicture readLammpsDump(const std::filesystem::path& path, std::optional<std::size_t> number,
                             const std::function<bool(std::size_t)>& progress) {
  DumpReader reader(path);
  LammpsPicture picture;
  while (picture.number != number && reader.next(picture, number)) {
    if (progress && !progress(picture.number)) {
      throw Failure("interrupted");
    }
  }
  if (picture.grains.empty()) {
    const std::string whole = fmt::format("has {} whole pictures", picture.number);
    throw InvalidParameter(path.string(), whole,
                           number ? fmt::format("at least {}", *number) : "a dump of LAMMPS with at least one");
  }
  std::ranges::sort(picture.grains, {}, &DumpedGrain::id);
  return picture;
}

void forEachLammpsPicture(const std::filesystem::path& path, const std::function<void(const LammpsPicture&)>& visit) {
  DumpReader reader(path);
  LammpsPicture picture;
  while (reader.next(picture, {})) {
    std::ranges::sort(picture.grains, {}, &DumpedGrain::id);
    visit(picture);
  }
  if (picture.number == 0) {
    throw InvalidParameter(path.string(), "has 0 whole pictures", "a dump of LAMMPS with at least one");
  }
}

}  // namespace haptolith

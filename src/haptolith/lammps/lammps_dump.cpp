#include "haptolith/lammps/lammps_dump.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/input_file.h"
#include "haptolith/core/plain_text.h"

namespace haptolith {

namespace {

constexpr TextLimits kLimits{.bytes = 1ULL << 40U, .line_bytes = 4000, .rows = 10'000'000};
constexpr std::array<std::string_view, 9> kColumns{"id", "x", "y", "z", "radius", "type", "vx", "vy", "vz"};
constexpr std::size_t kNeeded = 5;
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

/// Indices of a dump's columns, in the order of kColumns.
constexpr std::size_t kX = 1, kRadius = 4, kType = 5, kVelocity = 6;

/// Conversion of a column's numbers to those of kColumns.
enum class Meaning {
  kAsItIs,
  kWrapped,   ///< xu: continues where x wraps to the other side of the box
  kScaled,    ///< xs: 0 to 1 in the box
  kDiameter,  ///< twice the radius
};

/// A name that a column may have.
struct ColumnName {
  std::string_view name;
  std::size_t column;
  Meaning meaning = Meaning::kAsItIs;
};
/// If two columns have one meaning, the earlier one in this list is read.
constexpr std::array kNames{
    ColumnName{"id", 0},
    ColumnName{"x", 1},
    ColumnName{"y", 2},
    ColumnName{"z", 3},
    ColumnName{"v_radius", kRadius},  // radius of the particles, where LAMMPS' spheres have another
    ColumnName{"radius", kRadius},
    ColumnName{"v_type", kType},
    ColumnName{"type", kType},
    ColumnName{"vx", 6},
    ColumnName{"vy", 7},
    ColumnName{"vz", 8},
    ColumnName{"xu", 1, Meaning::kWrapped},
    ColumnName{"yu", 2, Meaning::kWrapped},
    ColumnName{"zu", 3, Meaning::kWrapped},
    ColumnName{"xs", 1, Meaning::kScaled},
    ColumnName{"ys", 2, Meaning::kScaled},
    ColumnName{"zs", 3, Meaning::kScaled},
    ColumnName{"xsu", 1, Meaning::kScaled},
    ColumnName{"ysu", 2, Meaning::kScaled},
    ColumnName{"zsu", 3, Meaning::kScaled},
    ColumnName{"v_diameter", kRadius, Meaning::kDiameter},
    ColumnName{"diameter", kRadius, Meaning::kDiameter}};

/// Place of a column in the file.
struct Column {
  std::size_t place = kNone;
  std::size_t rank = kNames.size();  ///< in kNames
  [[nodiscard]] Meaning meaning() const { return kNames.at(rank).meaning; }
};
using Columns = std::array<Column, kColumns.size()>;

/// One axis of a picture's box.
struct Bounds {
  double low_m = 0, high_m = 0;
  bool periodic = false;
};

/// A dump on its way into the program, picture by picture.
class DumpReader {
 public:
  explicit DumpReader(const std::filesystem::path& path)
      : path_(path.string()), file_(openInput(path, kLimits.bytes)), lines_(file_, path_, kLimits) {
    file_.seekg(-1, std::ios::end);
    ends_with_line_ = file_.get() == '\n';
    file_.clear();
    file_.seekg(0);
  }

  /// The next picture that is whole; false at the end of the file. Where `wanted` is not its number, its grains are
  /// passed over.
  bool next(LammpsPicture& picture, std::optional<std::size_t> wanted) {
    if (!nextLine()) {
      return false;
    }
    LammpsPicture read;
    read.number = ++count_;
    std::size_t grains = 0;
    box_ = {};
    while (!line_.starts_with("ITEM: ATOMS")) {
      if (!line_.starts_with("ITEM: ")) {
        refuse(line_, "a dump of LAMMPS: a line that begins with ITEM:");
      }
      const std::string heading = line_;
      bool ended = !nextLine();
      for (std::size_t i = 0; !ended && !line_.starts_with("ITEM: "); ++i) {
        readHead(heading, i, read, grains);
        ended = !nextLine();
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
  /// Whether this line is the last of the file and its writer has not ended it: its last number may be part of one.
  [[nodiscard]] bool isCutOff() {
    return !ends_with_line_ && file_.rdbuf()->sgetc() == std::ifstream::traits_type::eof();
  }

  /// Reads the next line, with the line end of any system.
  bool nextLine() {
    if (!lines_.next(line_)) {
      return false;
    }
    if (lines_.number() == 1 && line_.starts_with("\xEF\xBB\xBF")) {
      line_.erase(0, 3);
    }
    line_.erase(line_.find_last_not_of(" \t\r") + 1);
    return true;
  }

  /// The line `i` of those below a heading.
  void readHead(std::string_view heading, std::size_t i, LammpsPicture& picture, std::size_t& grains) {
    if (heading == "ITEM: UNITS" && line_ != "si") {
      refuse(line_, "si: metres and seconds, in which haptolith reads a dump");
    } else if (heading == "ITEM: TIMESTEP") {
      picture.step = whole(line_);
    } else if (heading == "ITEM: TIME") {
      std::string_view rest = line_;
      picture.time_s = number(nextWord(rest));
    } else if (heading == "ITEM: NUMBER OF ATOMS") {
      grains = count(line_);
    } else if (heading.starts_with("ITEM: BOX BOUNDS") && i < box_.axes.size()) {
      constexpr std::string_view kBounds = "ITEM: BOX BOUNDS";
      std::string_view words = heading.substr(kBounds.size());
      box_.tilted = heading.find("xy xz yz") != std::string_view::npos || heading.find("abc") != std::string_view::npos;
      std::string_view ends;
      for (std::size_t axis = 0; axis <= i + (box_.tilted ? 3 : 0); ++axis) {
        ends = nextWord(words);
      }
      std::string_view rest = line_;
      const double low_m = number(nextWord(rest));
      box_.axes.at(i) = {low_m, number(nextWord(rest)), ends == "pp"};
    }
  }

  bool readGrains(LammpsPicture& picture, std::size_t grains, bool keeps) {
    const Columns columns = keeps && grains > 0 ? columnsOf(line_) : Columns{};
    picture.has_velocities = keeps && std::all_of(columns.begin() + kVelocity, columns.end(),
                                                  [](const Column& column) { return column.place != kNone; });
    picture.grains.reserve(keeps ? std::min(grains, kAtOnce) : 0);
    for (std::size_t i = 0; i < grains; ++i) {
      if (!nextLine() || isCutOff()) {
        return false;
      }
      if (keeps) {
        picture.grains.push_back(grain(columns));
      }
    }
    return true;
  }

  [[nodiscard]] Columns columnsOf(std::string_view heading) const {
    Columns columns{};
    std::string_view rest = heading.substr(std::string_view("ITEM: ATOMS").size());
    std::size_t place = 0;
    for (std::string_view word = nextWord(rest); !word.empty(); word = nextWord(rest), ++place) {
      const auto named = std::ranges::find(kNames, word, &ColumnName::name);
      const auto rank = static_cast<std::size_t>(named - kNames.begin());
      if (named != kNames.end() && rank < columns.at(named->column).rank) {
        columns.at(named->column) = {place, rank};
      }
    }
    for (std::size_t c = 0; c < kNeeded; ++c) {
      if (columns.at(c).place == kNone) {
        refuse(heading, fmt::format("with a column {}: dump ... custom ... id type x y z radius", kColumns.at(c)));
      }
    }
    const bool scaled = std::ranges::any_of(std::span(columns).subspan(kX, 3),
                                            [](const Column& column) { return column.meaning() == Meaning::kScaled; });
    if (scaled && box_.tilted) {
      refuse(heading, "x, y and z in metres where the box is not upright (xs, ys and zs are read in boxes that are)");
    }
    return columns;
  }

  [[nodiscard]] DumpedGrain grain(const Columns& columns) const {
    std::array<double, kColumns.size()> numbers{};
    numbers.at(kType) = 1;  // default of the type
    std::size_t found = 0;
    std::string_view rest = line_;
    std::size_t place = 0;
    for (std::string_view word = nextWord(rest); !word.empty(); word = nextWord(rest), ++place) {
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (columns.at(c).place == place) {
          numbers.at(c) = inMetres(number(word), columns.at(c), c);
          found += c < kNeeded ? 1 : 0;
        }
      }
    }
    if (found < kNeeded) {
      refuse(line_, "as many numbers as the heading has columns");
    }
    constexpr double kLargestType = 1e9;
    if (!(numbers[kRadius] > 0) || std::abs(numbers[kType]) > kLargestType) {
      refuse(line_, "a radius above 0, and a type of LAMMPS");
    }
    return {.id = static_cast<std::int64_t>(numbers[0]),
            .type = static_cast<int>(numbers[kType]),
            .centre_m = {numbers[1], numbers[2], numbers[3]},
            .radius_m = numbers[kRadius],
            .velocity_m_s = {numbers[6], numbers[7], numbers[8]}};
  }

  [[nodiscard]] double inMetres(double value, const Column& column, std::size_t c) const {
    switch (column.meaning()) {
      case Meaning::kAsItIs: return value;
      case Meaning::kDiameter: return value / 2;
      case Meaning::kScaled:
      case Meaning::kWrapped: break;
    }
    const Bounds& box = box_.axes.at(c - kX);
    const double width_m = box.high_m - box.low_m;
    const double at_m = column.meaning() == Meaning::kScaled ? box.low_m + value * width_m : value;
    return box.periodic && width_m > 0 ? at_m - width_m * std::floor((at_m - box.low_m) / width_m) : at_m;
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
    if (value < 0 || value > kLimits.rows) {
      refuse(line, fmt::format("0 to {} grains", kLimits.rows));
    }
    return static_cast<std::size_t>(value);
  }

  static constexpr std::size_t kAtOnce = 100'000;  ///< rows that room is made for before they are read

  std::string path_;
  std::ifstream file_;
  LineReader lines_;
  std::string line_;
  bool ends_with_line_ = false;
  std::size_t count_ = 0;
  struct Box {
    std::array<Bounds, 3> axes;
    bool tilted = false;
  } box_;
};

/// In the order of their ids.
void sortById(const std::filesystem::path& path, LammpsPicture& picture) {
  std::ranges::sort(picture.grains, {}, &DumpedGrain::id);
  const auto twice = std::ranges::adjacent_find(picture.grains, {}, &DumpedGrain::id);
  if (twice != picture.grains.end()) {
    throw InvalidParameter(fmt::format("{}: frame {} (step {})", path.string(), picture.number, picture.step),
                           fmt::format("with id {} twice", twice->id), "with each grain once");
  }
}

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
  if (picture.number == 0 || (number && picture.number != *number)) {
    const std::string whole = fmt::format("has {} complete frames", picture.number);
    throw InvalidParameter(path.string(), whole,
                           number ? fmt::format("at least {}", *number)
                                  : "a dump of LAMMPS with at least one; its last line must be complete");
  }
  if (picture.grains.empty()) {
    throw InvalidParameter(fmt::format("{}: frame {} (step {})", path.string(), picture.number, picture.step),
                           "without a grain", "one with grains");
  }
  sortById(path, picture);
  return picture;
}

void forEachLammpsPicture(const std::filesystem::path& path, const std::function<void(const LammpsPicture&)>& visit) {
  DumpReader reader(path);
  LammpsPicture picture;
  while (reader.next(picture, {})) {
    sortById(path, picture);
    visit(picture);
  }
  if (picture.number == 0) {
    throw InvalidParameter(path.string(), "has 0 complete frames", "a dump of LAMMPS with at least one");
  }
}

}  // namespace haptolith

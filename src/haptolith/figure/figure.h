#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/files/atomic_file.h"

namespace haptolith {

/// `text` as a gnuplot string that shows it letter by letter, whatever it holds: on one line in single quotes, where
/// gnuplot substitutes nothing, without a quote inside, and with a backslash before every mark of enhanced text. At
/// most kFigureTextLetters letters of it.
[[nodiscard]] std::string gnuplotQuoted(std::string_view text);
inline constexpr std::size_t kFigureTextLetters = 300;

/// A figure drawn by gnuplot into an .svg or .png file that appears whole or not at all. Not for the tick.
///
///     Figure figure("profile.svg", 900, 600);
///     figure.data("lunar", rows);                       // becomes the gnuplot data block $lunar
///     figure.command("plot $lunar using 1:2 with lines title 'lunar law'");
///     figure.save();
class Figure {
 public:
  /// @throws InvalidParameter when the extension is neither .svg nor .png; Failure as AtomicFile, or when
  /// gnuplot is not installed.
  Figure(const OutputFile& file, int width_px, int height_px);
  ~Figure();

  /// Defines the data block `$name`, one row a line; NaN leaves a gap.
  /// @throws InvalidParameter for a name that is not letters, digits and underscores.
  void data(std::string_view name, const std::vector<std::vector<double>>& rows);

  /// Passes gnuplot commands through: text from a file must be passed as gnuplotQuoted().
  void command(std::string_view gnuplot_commands);

  /// Waits for gnuplot and renames the file into place. @throws Failure with gnuplot's own words when it failed.
  void save();

 private:
  struct Process;
  std::unique_ptr<Process> process_;
};

}  // namespace haptolith

#include "haptolith/figure/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/core/platform/child_process.h"

// gnuplot reads its commands from an unnamed temporary file and writes picture and complaints to two others, so that it
// never receives the name of a file: "|command" would be one. A pipe would be shorter, but when gnuplot stops at an
// error, writing on into the pipe kills us (SIGPIPE) before its words are read.

namespace haptolith {

namespace {

struct GnuplotAnswer {
  bool succeeded = false;
  std::string picture;  ///< its standard output
  std::string words;    ///< and on standard error
};

/// Runs gnuplot on `script`, or with --version when it is empty. @throws Failure when it is not installed.
GnuplotAnswer runGnuplot(const std::string& script) {
  const Descriptor input = temporaryFile(script);
  const Descriptor picture = temporaryFile();
  const Descriptor words = temporaryFile();
  // No user's settings, which are also commands.
  ChildProcess::Command command{
      .arguments = {"gnuplot", "--default-settings"}, .package = "gnuplot-nox", .environment = {}};
  if (script.empty()) {
    command.arguments.emplace_back("--version");
  }
  ChildProcess gnuplot(command, {{input, kStandardInput}, {picture, kStandardOutput}, {words, kStandardError}});
  const bool succeeded = gnuplot.wait();
  return {succeeded, contentOf(picture), contentOf(words)};
}

std::string terminalFor(const std::filesystem::path& path, int width_px, int height_px) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  if (extension == ".svg") {
    return fmt::format("svg size {},{} dynamic enhanced font 'sans-serif,14' background 'white'", width_px, height_px);
  }
  if (extension == ".png") {
    return fmt::format("pngcairo size {},{} enhanced font 'sans,11' background 'white'", width_px, height_px);
  }
  throw InvalidParameter("figure", fmt::format("'{}'", path.string()), "a file name ending in .svg or .png");
}

/// Common style of all figures: a thin grey frame on two sides, a pale grid, no legend box.
constexpr std::string_view kStyle = R"(
set encoding utf8
set border 3 linecolor rgb '#444444'
set tics out nomirror textcolor rgb '#222222'
set grid linecolor rgb '#dddddd' linewidth 1 linetype 1
set key noautotitle
)";

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "NaN";
}

}  // namespace

struct Figure::Process {
  AtomicFile file;
  std::string path;
  std::string script;
};

Figure::Figure(const OutputFile& file, int width_px, int height_px) {
  const std::string terminal = terminalFor(file.path, width_px, height_px);
  runGnuplot("");  // before anyone computes for minutes: is it there?
  process_.reset(new Process{AtomicFile(file), file.path.string(), {}});
  command(fmt::format("set terminal {}", terminal));
  command(kStyle);
}

std::string gnuplotQuoted(std::string_view text) {
  constexpr std::string_view kMarks = "\\@^_{}&~";  // marks of enhanced text
  std::string result = "'{}";  // gnuplot reads a text without a mark as plain, and shows its backslashes
  for (const char letter : shortened(text, kFigureTextLetters)) {
    if (letter == '\'') {
      result += "\\047";  // gnuplot 5.4 takes a string that begins with '' for an empty one
    } else {
      result += kMarks.find(letter) != std::string_view::npos ? "\\" : "";
      result += letter;
    }
  }
  return result + "'";
}

Figure::~Figure() = default;

void Figure::data(std::string_view name, const std::vector<std::vector<double>>& rows) {
  if (!std::ranges::all_of(name, [](unsigned char c) { return c < 0x80 && (std::isalnum(c) != 0 || c == '_'); })) {
    throw InvalidParameter("data", inQuotes(name), "a name of letters, digits and underscores");
  }
  process_->script += fmt::format("${} << END_OF_DATA\n", name);
  for (const std::vector<double>& row : rows) {
    for (const double value : row) {
      process_->script += number(value) + ' ';
    }
    process_->script += '\n';
  }
  process_->script += "END_OF_DATA\n";
}

void Figure::command(std::string_view gnuplot_commands) {
  process_->script.append(gnuplot_commands).push_back('\n');
}

void Figure::save() {
  const GnuplotAnswer answer = runGnuplot(process_->script);
  if (!answer.succeeded) {
    throw Failure(fmt::format("gnuplot could not draw {}:\n{}", process_->path, answer.words));
  }
  process_->file.write(answer.picture);
  process_->file.commit();
}

}  // namespace haptolith

#include "haptolith/figure/figure.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "haptolith/core/atomic_file.h"
#include "haptolith/core/child_process.h"
#include "haptolith/core/error.h"

// gnuplot reads its commands from an unnamed temporary file and writes its complaints to another. A pipe would be
// shorter, but when gnuplot stops at an error, writing on into the pipe kills us (SIGPIPE) before its words are read.

namespace haptolith {

namespace {

struct GnuplotAnswer {
  bool succeeded = false;
  std::string words;  ///< stdout and stderr
};

/// Runs gnuplot on `script`, or with --version when it is empty. @throws Failure when it is not installed.
GnuplotAnswer runGnuplot(const std::string& script) {
  const Descriptor input = temporaryFile(script);
  const Descriptor output = temporaryFile();
  ChildProcess::Command command{.arguments = {"gnuplot"}, .package = "gnuplot-nox", .environment = {}};
  if (script.empty()) {
    command.arguments.emplace_back("--version");
  }
  ChildProcess gnuplot(command, {{input, STDIN_FILENO}, {output, STDOUT_FILENO}, {output, STDERR_FILENO}});
  const bool succeeded = gnuplot.wait();
  return {succeeded, contentOf(output)};
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

/// What all figures have in common: a thin grey frame on two sides, a pale grid, no legend box.
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

Figure::Figure(const std::filesystem::path& path, int width_px, int height_px) {
  const std::string terminal = terminalFor(path, width_px, height_px);
  runGnuplot("");  // before anyone computes for minutes: is it there?
  process_.reset(new Process{AtomicFile(path), path.string(), {}});
  command(
      fmt::format("set terminal {}\nset output {}", terminal, gnuplotQuoted(process_->file.temporaryPath().string())));
  command(kStyle);
}

std::string gnuplotQuoted(std::string_view text) {
  std::string result = "'";
  for (const char letter : text) {
    result += letter == '\'' ? "''" : std::string(1, letter);
  }
  return result + "'";
}

Figure::~Figure() = default;

void Figure::data(std::string_view name, const std::vector<std::vector<double>>& rows) {
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
  command("unset output");
  const GnuplotAnswer answer = runGnuplot(process_->script);
  if (!answer.succeeded) {
    throw Failure(fmt::format("gnuplot could not draw {}:\n{}", process_->path, answer.words));
  }
  process_->file.commit();
}

}  // namespace haptolith

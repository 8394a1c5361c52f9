#include "runs.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <stdexcept>
#include <utility>

namespace hand_in_the_loop {

namespace {

volatile std::sig_atomic_t interrupted = 0;

/// Process that plays one run and writes its result to a pipe.
struct Worker {
  const Settings* settings;
  pid_t pid;
  int pipe;
  std::string said;
};

void writeAll(int file, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = write(file, text.data() + at, text.size() - at);
    if (n < 0 && errno != EINTR) {
      return;
    }
    at += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
}

[[noreturn]] void work(const Settings& settings, int again, int pipe, pid_t parent) {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) {
    _exit(1);
  }
  Json result;
  try {
    int tries = 0;
    do {
      result = judgeProgram(settings);
      result["row"]["tries"] = ++tries;
    } while (tries <= again && settings.task == Task::kHold && noisy(result["row"]) && failed(result["row"]));
  } catch (const std::exception& error) {
    result = {{"failure", error.what()}};
  }
  writeAll(pipe, result.dump());
  _exit(0);
}

Worker begin(const Settings& settings, int again) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("cannot make a pipe");
  }
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) {
    throw std::runtime_error("cannot start another process");
  }
  if (pid == 0) {
    close(ends[0]);
    work(settings, again, ends[1], parent);
  }
  close(ends[1]);
  return {&settings, pid, ends[0], {}};
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> parts(1);
  for (const char c : line) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

Json valueOf(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' ? Json(number) : Json(text);
}

std::string cellOf(const Json& value) {
  if (value.is_number()) {
    return shortNumber(value.get<double>());
  }
  std::string text = value.get<std::string>();
  std::ranges::replace_if(
      text, [](char c) { return c == ',' || c == '\n' || c == '"'; }, ';');
  return text;
}

/// Returns the undisturbed run with this soil: a stiff hand, no delay, no quantisation, no noise.
const Json* undisturbed(const std::vector<Json>& rows, const Json& soil) {
  for (const Json& row : rows) {
    if (row["soil"] == soil && row["grip"] == "stiff" && row["delay_ms"] == 0.0 && row["step_mm"] == 0.0 &&
        row["noise_mm"] == 0.0) {
      return &row;
    }
  }
  return nullptr;
}

}  // namespace

bool failed(const Json& row) {
  return row["verdict"] != "ok" && row["verdict"] != "let-go";
}

bool noisy(const Json& row) {
  return row["late_max_ms"].get<double>() > 4 || row["longest_gap_ms"].get<double>() > 3;
}

std::string shortNumber(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), std::abs(x) >= 1e4 ? "%.0f" : "%.5g", x);
  return text.data();
}

bool playAll(const std::vector<Settings>& runs, int jobs, int again,
             const std::function<void(const Settings&, const Json*, const std::string&)>& tell) {
  struct sigaction stop {};
  stop.sa_handler = [](int) { interrupted = 1; };
  sigaction(SIGINT, &stop, nullptr);
  sigaction(SIGTERM, &stop, nullptr);
  std::vector<Worker> workers;
  std::size_t next = 0;
  while (interrupted == 0 && (next < runs.size() || !workers.empty())) {
    while (next < runs.size() && workers.size() < static_cast<std::size_t>(jobs)) {
      workers.push_back(begin(runs[next++], again));
    }
    std::vector<pollfd> waiting;
    waiting.reserve(workers.size());
    for (const Worker& worker : workers) {
      waiting.push_back({worker.pipe, POLLIN, 0});
    }
    if (poll(waiting.data(), waiting.size(), -1) < 0) {
      continue;  // a signal
    }
    for (std::size_t i = workers.size(); i-- > 0;) {
      if (waiting[i].revents == 0) {
        continue;
      }
      std::array<char, 4096> bytes{};
      const ssize_t n = read(workers[i].pipe, bytes.data(), bytes.size());
      if (n > 0) {
        workers[i].said.append(bytes.data(), static_cast<std::size_t>(n));
        continue;
      }
      const Worker done = workers[i];
      workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(i));
      close(done.pipe);
      waitpid(done.pid, nullptr, 0);
      const Json result = Json::parse(done.said, nullptr, false);
      if (result.is_discarded()) {
        tell(*done.settings, nullptr, "the process that judged it died");
      } else if (result.contains("failure")) {
        tell(*done.settings, nullptr, result["failure"]);
      } else {
        tell(*done.settings, &result, {});
      }
    }
  }
  for (const Worker& worker : workers) {
    kill(worker.pid, SIGKILL);  // also ends its program
    waitpid(worker.pid, nullptr, 0);
    close(worker.pipe);
  }
  return interrupted == 0;
}

Table::Table(std::string path) : path_(std::move(path)) {
  std::ifstream file(path_);
  std::string line;
  if (path_.empty() || !std::getline(file, header_)) {
    return;
  }
  const std::vector<std::string> columns = split(header_);
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = split(line);
    if (cells.size() != columns.size()) {
      throw std::runtime_error(path_ + ": a row has " + std::to_string(cells.size()) + " cells instead of " +
                               std::to_string(columns.size()) + "; name another file");
    }
    Json row;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      row[columns[i]] = valueOf(cells[i]);
    }
    rows_.push_back(std::move(row));
  }
}

bool Table::has(const std::string& name) const {
  return std::ranges::any_of(rows_, [&name](const Json& row) { return row["name"] == name; });
}

void Table::add(const Json& row) {
  rows_.push_back(row);
  if (path_.empty()) {
    return;
  }
  std::string header, line;
  for (const auto& [key, value] : row.items()) {
    const char* comma = header.empty() ? "" : ",";
    header.append(comma).append(key);
    line.append(comma).append(cellOf(value));
  }
  if (!header_.empty() && header != header_) {
    throw std::runtime_error(path_ + " has other columns; name another file");
  }
  const std::string text = (header_.empty() ? header + '\n' : std::string()) + line + '\n';
  header_ = header;
  std::ofstream file(path_, std::ios::app);
  file << text << std::flush;  // one write per row, so that an interruption leaves complete rows
  if (!file) {
    throw std::runtime_error("cannot write " + path_);
  }
}

std::string lineOf(const Json& row) {
  const auto number = [&row](const char* key) { return row[key].get<double>(); };
  std::array<char, 400> text{};
  std::snprintf(
      text.data(), text.size(),
      "%-15s %5.2f N %5.2f N/ms  energy %+8.2f mJ, end %+8.2f, rise %8.2f  vibration %6.3f mm %3.0f Hz (%.3f, "
      "%.3f)  press %.2f N, still %.2f sd %.2f N  let go %3.0f %%%s  gap %.0f ms, late %.1f ms%s",
      row["verdict"].get<std::string>().c_str(), number("largest_force_n"), number("largest_step_n_ms"),
      number("energy_max_mj"), number("energy_end_mj"), number("energy_rise_mj"), number("vibration_mm"),
      number("vibration_hz"), number("vibration_before_mm"), number("vibration_after_mm"), number("press_n"),
      number("still_n"), number("still_sd_n"), 100 * number("let_go_share"),
      number("first_let_go_s") < 0 ? "" : (" at " + shortNumber(number("first_let_go_s")) + " s").c_str(),
      number("longest_gap_ms"), number("late_max_ms"), noisy(row) ? ", NOISY" : "");
  return text.data();
}

void summarise(const std::vector<Json>& rows) {
  struct Cell {
    int runs = 0, failed = 0, failed_noisy = 0, let_go = 0, noisy = 0;
    double energy_mj = 0, rise_mj = 0, vibration_mm = 0, after_mm = 0, force_n = 0, step_n_ms = 0, least_force = 1e9;
  };
  std::map<std::pair<std::string, std::string>, Cell> cells;
  for (const Json& row : rows) {
    const auto most = [&row](double& x, const char* key) { x = std::max(x, row[key].get<double>()); };
    Cell& cell = cells[{row["soil"], row["grip"]}];
    ++cell.runs;
    cell.failed += failed(row) ? 1 : 0;
    cell.failed_noisy += failed(row) && noisy(row) ? 1 : 0;
    cell.let_go += row["first_let_go_s"].get<double>() >= 0 ? 1 : 0;
    cell.noisy += noisy(row) ? 1 : 0;
    most(cell.energy_mj, "energy_max_mj");
    most(cell.rise_mj, "energy_rise_mj");
    most(cell.vibration_mm, "vibration_mm");
    most(cell.after_mm, "vibration_after_mm");
    most(cell.force_n, "largest_force_n");
    most(cell.step_n_ms, "largest_step_n_ms");
    const Json* reference = undisturbed(rows, row["soil"]);
    if (reference != nullptr && (*reference)["press_n"].get<double>() > 0) {
      cell.least_force =
          std::min(cell.least_force, row["press_n"].get<double>() / (*reference)["press_n"].get<double>());
    }
  }
  std::printf("\n%-6s %-7s %5s %7s %6s %7s %6s %10s %9s %13s %11s %8s %6s %6s\n", "soil", "grip", "runs", "failed",
              "noisy", "let go", "noisy", "energy mJ", "rise mJ", "vibration mm", "last s mm", "force N", "N/ms",
              "left");
  for (const auto& [key, cell] : cells) {
    std::printf("%-6s %-7s %5d %7d %6d %7d %6d %10.2f %9.2f %13.3f %11.3f %8.2f %6.2f %5s%%\n", key.first.c_str(),
                key.second.c_str(), cell.runs, cell.failed, cell.failed_noisy, cell.let_go, cell.noisy, cell.energy_mj,
                cell.rise_mj, cell.vibration_mm, cell.after_mm, cell.force_n, cell.step_n_ms,
                cell.least_force < 1e9 ? std::to_string(std::lround(100 * cell.least_force)).c_str() : "-");
  }
  std::printf(
      "noisy, of the failed and of all: the judge was more than 4 ms late or the program silent for more than 3 ms\n"
      "left: the least mean force while pressing and just after, against a stiff hand's with nothing wrong\n");
  bool any = false;
  for (const Json& row : rows) {
    if (failed(row)) {
      std::printf("%s%-34s %s\n", any ? "" : "\nFailed:\n", row["name"].get<std::string>().c_str(),
                  lineOf(row).c_str());
      any = true;
    }
  }
}

}  // namespace hand_in_the_loop

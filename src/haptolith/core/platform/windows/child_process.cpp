#include "haptolith/core/platform/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <io.h>
#include <windows.h>

#include <algorithm>
#include <array>
#include <map>
#include <system_error>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/windows/command_line.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

std::string lastReason() {
  return std::system_category().message(static_cast<int>(GetLastError()));
}

Descriptor descriptorOf(HANDLE handle, int flags) {
  const int number = _open_osfhandle(reinterpret_cast<std::intptr_t>(handle), flags | _O_BINARY);
  if (number < 0) {
    CloseHandle(handle);
    throw Failure("cannot keep a file open: too many are");
  }
  return Descriptor(number);
}

HANDLE handleOf(const Descriptor& descriptor) {
  return reinterpret_cast<HANDLE>(_get_osfhandle(descriptor.number()));
}

void requireTime(const Deadline& deadline) {
  if (deadline.stopped && deadline.stopped()) {
    throw Failure("interrupted");
  }
  if (std::chrono::steady_clock::now() > deadline.until) {
    throw Failure("no response in time");
  }
}

/// Names of variables differ in more than the case of their letters.
struct NoCase {
  bool operator()(const std::wstring& a, const std::wstring& b) const { return _wcsicmp(a.c_str(), b.c_str()) < 0; }
};

/// This process's environment with more variables, each ended by a zero.
std::wstring environmentWith(const std::vector<std::string>& more) {
  std::map<std::wstring, std::wstring, NoCase> variables;
  const auto add = [&](const std::wstring& variable) {
    const std::size_t equals = variable.find(L'=', 1);  // names may begin with it: the folder of each drive
    if (equals != std::wstring::npos) {
      variables[variable.substr(0, equals)] = variable.substr(equals);
    }
  };
  wchar_t* const ours = GetEnvironmentStringsW();
  for (const wchar_t* variable = ours; *variable != L'\0'; variable += std::wcslen(variable) + 1) {
    add(variable);
  }
  FreeEnvironmentStringsW(ours);
  for (const std::string& variable : more) {
    add(wideOf(variable));
  }
  std::wstring block;
  for (const auto& [name, value] : variables) {
    block.append(name).append(value).push_back(L'\0');
  }
  block.push_back(L'\0');
  return block;
}

/// A job whose processes end with it, each of them after this much time of a processor.
HANDLE makeJob(std::chrono::seconds most_cpu) {
  const HANDLE job = CreateJobObjectW(nullptr, nullptr);
  JOBOBJECT_EXTENDED_LIMIT_INFORMATION limits{};
  limits.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE | JOB_OBJECT_LIMIT_PROCESS_TIME;
  limits.BasicLimitInformation.PerProcessUserTimeLimit.QuadPart = std::chrono::nanoseconds(most_cpu).count() / 100;
  SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limits, sizeof limits);
  return job;
}

}  // namespace

Pipe::Pipe() {
  HANDLE reads = nullptr;
  HANDLE writes = nullptr;
  if (CreatePipe(&reads, &writes, nullptr, 0) == 0) {
    throw Failure(fmt::format("cannot make a pipe: {}", lastReason()));
  }
  to_read = descriptorOf(reads, _O_RDONLY);
  to_write = descriptorOf(writes, 0);
}

// A pipe that does not wait takes as much as it has room for.
bool writeAll(const Descriptor& to, std::string_view bytes, const Deadline& deadline) {
  constexpr std::size_t kPiece = 4096;
  const HANDLE pipe = handleOf(to);
  DWORD mode = PIPE_NOWAIT;
  SetNamedPipeHandleState(pipe, &mode, nullptr, nullptr);
  while (!bytes.empty()) {
    DWORD written = 0;
    const DWORD piece = static_cast<DWORD>(std::min(bytes.size(), kPiece));
    if (WriteFile(pipe, bytes.data(), piece, &written, nullptr) == 0) {
      return false;
    }
    bytes.remove_prefix(written);
    if (written == 0) {
      requireTime(deadline);
      std::this_thread::sleep_for(1ms);
    }
  }
  return true;
}

bool readSome(const Descriptor& from, std::string& bytes, const Deadline& deadline) {
  const HANDLE pipe = handleOf(from);
  DWORD waiting = 0;
  while (PeekNamedPipe(pipe, nullptr, 0, nullptr, &waiting, nullptr) != 0 && waiting == 0) {
    requireTime(deadline);
    std::this_thread::sleep_for(1ms);
  }
  std::array<char, 65536> piece;
  DWORD size = 0;
  const bool read =
      waiting > 0 && ReadFile(pipe, piece.data(), static_cast<DWORD>(piece.size()), &size, nullptr) != 0 && size > 0;
  bytes.append(piece.data(), size);
  return read;
}

Descriptor temporaryFile(std::string_view content) {
  std::array<wchar_t, MAX_PATH + 1> folder{};
  std::array<wchar_t, MAX_PATH + 1> name{};
  if (GetTempPathW(static_cast<DWORD>(folder.size()), folder.data()) == 0 ||
      GetTempFileNameW(folder.data(), L"hap", 0, name.data()) == 0) {
    throw Failure(fmt::format("cannot create a temporary file: {}", lastReason()));
  }
  const HANDLE file =
      CreateFileW(name.data(), GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, nullptr, CREATE_ALWAYS,
                  FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
  if (file == INVALID_HANDLE_VALUE) {
    throw Failure(fmt::format("cannot create a temporary file: {}", lastReason()));
  }
  Descriptor made = descriptorOf(file, _O_RDWR);
  if (!writeBytes(made.number(), content)) {
    throw Failure(fmt::format("cannot write a temporary file: {}", lastReason()));
  }
  _lseek(made.number(), 0, SEEK_SET);
  return made;
}

std::string contentOf(const Descriptor& file) {
  std::string content;
  std::array<char, 4096> piece;
  _lseek(file.number(), 0, SEEK_SET);
  for (int size = 0; (size = _read(file.number(), piece.data(), static_cast<unsigned>(piece.size()))) > 0;) {
    content.append(piece.data(), static_cast<std::size_t>(size));
  }
  return content;
}

ChildProcess::ChildProcess(const Command& command, const std::vector<Given>& given) : name_(command.arguments[0]) {
  STARTUPINFOW start{};
  start.cb = sizeof start;
  start.dwFlags = STARTF_USESTDHANDLES;
  std::array<HANDLE*, 3> standard{&start.hStdInput, &start.hStdOutput, &start.hStdError};
  for (const Given& one : given) {
    if (one.number < 0 || one.number > kStandardError) {
      throw Failure(fmt::format("{} cannot be started: Windows passes on no more than three files", name_));
    }
    *standard[static_cast<std::size_t>(one.number)] = handleOf(one.ours);
    SetHandleInformation(handleOf(one.ours), HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT);
  }
  std::wstring line = commandLine(command.arguments);
  std::wstring environment = environmentWith(command.environment);
  PROCESS_INFORMATION made{};
  const bool started =
      CreateProcessW(nullptr, line.data(), nullptr, nullptr, TRUE,
                     CREATE_SUSPENDED | CREATE_NEW_PROCESS_GROUP | CREATE_NO_WINDOW | CREATE_UNICODE_ENVIRONMENT,
                     environment.data(), nullptr, &start, &made) != 0;
  const DWORD error = GetLastError();
  for (const Given& one : given) {
    SetHandleInformation(handleOf(one.ours), HANDLE_FLAG_INHERIT, 0);
  }
  if (!started) {
    throw Failure(error == ERROR_FILE_NOT_FOUND ? fmt::format("{} is not installed, or not in PATH", name_)
                                                : fmt::format("cannot start {}: {}", name_,
                                                              std::system_category().message(static_cast<int>(error))));
  }
  const HANDLE job = makeJob(command.most_cpu);
  AssignProcessToJobObject(job, made.hProcess);
  ResumeThread(made.hThread);
  CloseHandle(made.hThread);
  process_ = reinterpret_cast<std::intptr_t>(made.hProcess);
  group_ = reinterpret_cast<std::intptr_t>(job);
}

ChildProcess::~ChildProcess() {
  TerminateJobObject(reinterpret_cast<HANDLE>(group_), 1);
  WaitForSingleObject(reinterpret_cast<HANDLE>(process_), INFINITE);
  CloseHandle(reinterpret_cast<HANDLE>(process_));
  CloseHandle(reinterpret_cast<HANDLE>(group_));
}

bool ChildProcess::endsWithin(std::chrono::milliseconds timeout) {
  if (running_ &&
      WaitForSingleObject(reinterpret_cast<HANDLE>(process_), static_cast<DWORD>(timeout.count())) == WAIT_OBJECT_0) {
    DWORD status = 1;
    GetExitCodeProcess(reinterpret_cast<HANDLE>(process_), &status);
    running_ = false;
    succeeded_ = status == 0;
  }
  return !running_;
}

}  // namespace haptolith

#include "haptolith/core/platform/this_program.h"

#include <fmt/format.h>
#include <shellapi.h>
#include <windows.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <system_error>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/windows/command_line.h"

namespace haptolith {

namespace fs = std::filesystem;

// The system keeps the line in UTF-16; main() gets it in an alphabet that lacks most letters.
std::vector<std::string> programArguments(int argc, const char* const* argv) {
  int count = 0;
  wchar_t** const wide = CommandLineToArgvW(GetCommandLineW(), &count);
  if (wide == nullptr || count != argc) {
    return {argv, argv + argc};
  }
  std::vector<std::string> arguments;
  for (int i = 0; i < count; ++i) {
    arguments.push_back(utf8Of(wide[i]));
  }
  LocalFree(static_cast<HLOCAL>(wide));
  return arguments;
}

fs::path programFile() {
  std::wstring name(MAX_PATH, L'\0');
  DWORD size = GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
  while (size == name.size()) {  // cut off
    name.resize(2 * name.size());
    size = GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
  }
  return name.substr(0, size);
}

std::string programFileName(std::string_view name) {
  return std::string(name) + ".exe";
}

// Ctrl-C reaches both: this process leaves it to the other.
void becomeProgram(const fs::path& file, const std::vector<std::string>& arguments) {
  std::wstring line = commandLine(arguments);
  STARTUPINFOW start{};
  start.cb = sizeof start;
  PROCESS_INFORMATION made{};
  SetConsoleCtrlHandler([](DWORD) -> BOOL { return TRUE; }, TRUE);
  if (CreateProcessW(file.c_str(), line.data(), nullptr, nullptr, TRUE, 0, nullptr, nullptr, &start, &made) == 0) {
    throw Failure(fmt::format("cannot start {}: {}", file.string(),
                              std::system_category().message(static_cast<int>(GetLastError()))));
  }
  CloseHandle(made.hThread);
  WaitForSingleObject(made.hProcess, INFINITE);
  DWORD status = EXIT_FAILURE;
  GetExitCodeProcess(made.hProcess, &status);
  std::_Exit(static_cast<int>(status));
}

fs::path programInPath(const std::string& name) {
  std::wstring found(32768, L'\0');
  const DWORD size =
      SearchPathW(nullptr, fs::path(name).c_str(), L".exe", static_cast<DWORD>(found.size()), found.data(), nullptr);
  return size < found.size() ? fs::path(found.substr(0, size)) : fs::path();
}

bool isProgram(const fs::path& file) noexcept {
  const DWORD attributes = GetFileAttributesW(file.c_str());
  return attributes != INVALID_FILE_ATTRIBUTES && (attributes & FILE_ATTRIBUTE_DIRECTORY) == 0;
}

std::int64_t processNumber() noexcept {
  return GetCurrentProcessId();
}

bool hasAllRights() noexcept {
  return false;
}

std::string hostName() {
  std::array<wchar_t, 256> name{};
  DWORD size = name.size();
  return GetComputerNameExW(ComputerNameDnsHostname, name.data(), &size) != 0 ? utf8Of(name.data()) : "";
}

// GetVersionEx() reports the version that the program was made for.
std::string systemName() {
  using GetVersion = LONG(WINAPI*)(OSVERSIONINFOW*);
  const auto get_version = reinterpret_cast<GetVersion>(
      reinterpret_cast<void*>(GetProcAddress(GetModuleHandleW(L"ntdll"), "RtlGetVersion")));
  OSVERSIONINFOW version{};
  version.dwOSVersionInfoSize = sizeof version;
  if (get_version == nullptr || get_version(&version) != 0) {
    return "Windows";
  }
  return fmt::format("Windows {}.{}.{} x86_64", version.dwMajorVersion, version.dwMinorVersion, version.dwBuildNumber);
}

// Sockets are no files here, and are limited by memory.
std::size_t raiseFileLimit(std::size_t most) noexcept {
  return most;
}

void makeClosedPipesErrors() noexcept {}  // which they are

namespace {

std::atomic<void (*)()> end_handler{nullptr};

BOOL WINAPI askToEnd(DWORD event) {
  end_handler.load()();
  if (event == CTRL_CLOSE_EVENT || event == CTRL_LOGOFF_EVENT || event == CTRL_SHUTDOWN_EVENT) {
    Sleep(INFINITE);  // when this returns, the system ends the program; it does so after 5 s in any case
  }
  return TRUE;
}

}  // namespace

void onEndAsked(void (*handler)()) noexcept {
  if (end_handler.exchange(handler) == nullptr) {
    SetConsoleCtrlHandler(askToEnd, TRUE);
  }
}

}  // namespace haptolith

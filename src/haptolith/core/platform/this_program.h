#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace haptolith {

// Facts about this program and its machine, and its relation to the system. Not for the tick.

/// Arguments of main() as UTF-8.
[[nodiscard]] std::vector<std::string> programArguments(int argc, const char* const* argv);

/// File of the running program. @throws std::filesystem::filesystem_error.
[[nodiscard]] std::filesystem::path programFile();

/// File name of a program: with ".exe" on Windows.
[[nodiscard]] std::string programFileName(std::string_view name);

/// Runs another program in place of this one, with arguments that begin with its name. Where the system cannot replace
/// a program, waits for the other and ends with its exit status. @throws Failure when it cannot be started.
[[noreturn]] void becomeProgram(const std::filesystem::path& file, const std::vector<std::string>& arguments);

/// Path of a program in the folders of PATH; empty if none has it. @param name  without ".exe"
[[nodiscard]] std::filesystem::path programInPath(const std::string& name);

/// Whether the file exists and this user may run it.
[[nodiscard]] bool isProgram(const std::filesystem::path& file) noexcept;

[[nodiscard]] std::int64_t processNumber() noexcept;

/// Whether this process may do everything (root).
[[nodiscard]] bool hasAllRights() noexcept;

/// Name of this machine in its network; empty if it has none.
[[nodiscard]] std::string hostName();

/// Name, version and processor of the operating system's core: "Linux 6.1.0-18-amd64 x86_64".
[[nodiscard]] std::string systemName();

/// Raises the limit of open files and sockets as far as the system allows, to `most`. Returns the limit; 0 if it is
/// unknown.
[[nodiscard]] std::size_t raiseFileLimit(std::size_t most) noexcept;

/// Lets a write to a closed pipe fail like one to a full disk.
void makeClosedPipesErrors() noexcept;

/// Calls `handler` instead of ending the program when the user or the system asks it to end: Ctrl-C, SIGTERM, a closed
/// terminal unless started by nohup. The handler may only set atomic flags.
void onEndAsked(void (*handler)()) noexcept;

}  // namespace haptolith

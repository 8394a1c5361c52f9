#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace haptolith {

// Program, device and machine of a session: a row of the table `session` for each run, resume or simulation of a
// participant.

/// Description of the machine, without its name.
struct Machine {
  std::string os;      ///< "Debian GNU/Linux 12 (bookworm)"
  std::string kernel;  ///< "Linux 6.1.0-28-rt-amd64 x86_64"
  std::string cpu;     ///< "13th Gen Intel(R) Core(TM) i7-13700"
};

/// Describes this machine; unknown values are empty. @param root  folder with etc/ and proc/; another one in tests.
[[nodiscard]] Machine thisMachine(const std::filesystem::path& root = "/");

/// Returns the SHA-256 of a text as 64 hexadecimal digits (FIPS 180-4).
[[nodiscard]] std::string sha256Of(std::string_view text);

struct SessionBegun {
  std::string kind = {};  ///< "run", "resume" or "simulate"
  std::string program_version = {};
  std::string device = {};  ///< driver and model
  Machine machine = {};
  std::optional<double> loop_rate_hz = {};  ///< none: no loop
  std::string simulation = {};              ///< parameters of the simulation, as JSON; empty: a person took part
};

/// Counts of the loop during a session.
struct SessionCounts {
  std::uint64_t ticks = 0, missed_ticks = 0;
  std::uint64_t safety_trips = 0;  ///< number of safety trips
};

struct SessionRow : SessionBegun {
  std::int64_t id = 0, participant = 0;
  std::string begun_at = {}, ended_at = {};  ///< ended_at empty: under way, or cut off by a crash
  std::optional<SessionCounts> counts = {};  ///< none: no loop, or not ended
  std::string protocol_sha256 = {};          ///< hash of the protocol's text
};

/// Consent of a participant.
struct ConsentRow {
  std::int64_t participant = 0;
  std::string at = {}, version = {}, language = {};
  std::string text = {};  ///< text as shown to the participant
};

}  // namespace haptolith

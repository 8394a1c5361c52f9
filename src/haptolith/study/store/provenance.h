#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace haptolith {

// What ran a part of a study: a row of the table `session`, for each run, resume or simulation of a participant.

/// The machine, without its name.
struct Machine {
  std::string os;      ///< "Debian GNU/Linux 12 (bookworm)"
  std::string kernel;  ///< "Linux 6.1.0-28-rt-amd64 x86_64"
  std::string cpu;     ///< "13th Gen Intel(R) Core(TM) i7-13700"
};

/// What cannot be found out is empty. @param root  where etc/ and proc/ are; another folder in tests.
[[nodiscard]] Machine thisMachine(const std::filesystem::path& root = "/");

/// SHA-256 of a text, as 64 hexadecimal digits (FIPS 180-4).
[[nodiscard]] std::string sha256Of(std::string_view text);

struct SessionBegun {
  std::string kind = {};  ///< "run", "resume" or "simulate"
  std::string program_version = {};
  std::string device = {};  ///< driver and model
  Machine machine = {};
  std::optional<double> loop_rate_hz = {};  ///< none: there was no loop
  std::string simulation = {};              ///< what it was simulated with, as JSON; empty: a person took part
};

/// What the loop counted from the beginning of a session to its end.
struct SessionCounts {
  std::uint64_t ticks = 0, missed_ticks = 0;
  std::uint64_t safety_trips = 0;  ///< how often the safety layer let go of the hand
};

struct SessionRow : SessionBegun {
  std::int64_t id = 0, participant = 0;
  std::string begun_at = {}, ended_at = {};  ///< ended_at empty: under way, or cut off by a crash
  std::optional<SessionCounts> counts = {};  ///< none: no loop, or not at its end
  std::string protocol_sha256 = {};          ///< of the protocol's text
};

/// What a participant has agreed to.
struct ConsentRow {
  std::int64_t participant = 0;
  std::string at = {}, version = {}, language = {};
  std::string text = {};  ///< as it was shown
};

}  // namespace haptolith

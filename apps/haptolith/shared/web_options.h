#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "haptolith/viewer/web_server.h"

namespace CLI {
class App;
}

namespace haptolith {

/// Entrances of a study (WebOptions::forStudy).
inline constexpr std::size_t kParticipants = 0, kExperimenters = 1;

/// Options for access to the page.
struct WebOptions {
  std::string bind = WebServerOptions{}.bind;
  std::optional<std::uint16_t> port;  ///< empty: 8080, or the next free one
  std::string token, token_file, participant_token;
  bool read_only = false;

  /// Returns the message for a page at another port than the default; otherwise empty.
  [[nodiscard]] std::string portNotice(std::uint16_t port_served) const;

  /// Adds --port, --bind, --token, --token-file and --read-only.
  void addToRun(CLI::App& command);
  /// As above without --read-only, with --participant-token.
  void addToStudy(CLI::App& command);

  /// Returns options for a page shared by all clients, with a token if one is given, or required because other machines
  /// can connect. @throws InvalidParameter as validate(), and for a token that is too short; Failure if its file cannot
  /// be read.
  [[nodiscard]] WebServerOptions forAll() const;
  /// Returns options for the two pages of a study. Each needs a token, even on this machine, where the participant's
  /// browser also runs: it does not receive the conditions and cannot act as the experimenter. @throws as forAll().
  [[nodiscard]] WebServerOptions forStudy() const;

 private:
  [[nodiscard]] WebServerOptions whereItListens() const;
  void addTo(CLI::App& command);
  [[nodiscard]] std::string givenToken() const;
};

}  // namespace haptolith

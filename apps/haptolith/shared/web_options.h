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

/// The entrances of a study (WebOptions::forStudy).
inline constexpr std::size_t kParticipants = 0, kExperimenters = 1;

/// Who may come to the page, and from where.
struct WebOptions {
  std::string bind = WebServerOptions{}.bind;
  std::optional<std::uint16_t> port;  ///< left out: 8080, or the next that is free
  std::string token, token_file, participant_token;
  bool read_only = false;

  /// What to tell when the page is at another port than the usual one; empty when it is not.
  [[nodiscard]] std::string portNotice(std::uint16_t port_served) const;

  /// --port, --bind, --token, --token-file and --read-only.
  void addToRun(CLI::App& command);
  /// The same without --read-only, and --participant-token.
  void addToStudy(CLI::App& command);

  /// For a page that everybody shares: with a token where one is given, or needed because other machines can connect.
  /// @throws InvalidParameter as validate(), and for a token that is too short; Failure when its file cannot be read.
  [[nodiscard]] WebServerOptions forAll() const;
  /// For the two pages of a study, which need a token each, on this machine too: the participant's browser is on the
  /// same one, is not told what is shown, and can never act as the experimenter. @throws as forAll().
  [[nodiscard]] WebServerOptions forStudy() const;

 private:
  [[nodiscard]] WebServerOptions whereItListens() const;
  void addTo(CLI::App& command);
  [[nodiscard]] std::string givenToken() const;
};

}  // namespace haptolith

#include "shared/web_options.h"

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "haptolith/core/error.h"
#include "haptolith/viewer/access.h"

#include "shared/option_checks.h"

namespace haptolith {

namespace {

constexpr const char* kTokenVariable = "HAPTOLITH_TOKEN";
constexpr const char* kParticipantVariable = "HAPTOLITH_PARTICIPANT_TOKEN";

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// Returns the first line of a file, which may be a pipe.
std::string firstLine(const std::string& name) {
  std::ifstream file(name);
  std::string line(kLongestToken + 2, '\0');
  file.read(line.data(), static_cast<std::streamsize>(line.size()));
  if (!file.is_open() || file.bad()) {
    throw Failure(fmt::format("cannot read {}: {}", name, std::strerror(errno)));
  }
  line.resize(static_cast<std::size_t>(file.gcount()));
  line.resize(std::min(line.size(), line.find_first_of("\r\n")));
  return line;
}

std::string checked(std::string token, std::string_view from) {
  if (!token.empty()) {
    requireGoodToken(token, from);
  }
  return token;
}

}  // namespace

void WebOptions::addTo(CLI::App& command) {
  command.add_option("--port", port, "Port of the page; 0: any [8080, or the next free port]")
      ->check(wholeNumberIn({0, 65535}))
      ->option_text("PORT");
  command.add_option("--bind", bind, "Address to listen on; other than this machine requires a token [127.0.0.1]")
      ->option_text("ADDRESS");
  CLI::Option* text =
      command
          .add_option("--token", token,
                      "Access token, 16 to 128 characters. Other users of this machine can read it in the list of "
                      "processes; prefer --token-file or HAPTOLITH_TOKEN [generated when required]")
          ->option_text("TEXT");
  command.add_option("--token-file", token_file, "File whose first line is the access token")
      ->option_text("FILE")
      ->excludes(text);
}

void WebOptions::addToRun(CLI::App& command) {
  addTo(command);
  command.add_flag("--read-only", read_only, "Show the scene only; browsers cannot dig or change it");
}

void WebOptions::addToStudy(CLI::App& command) {
  addTo(command);
  command
      .add_option(
          "--participant-token", participant_token,
          "Access token of the participant, or HAPTOLITH_PARTICIPANT_TOKEN; --token is the experimenter's [generated]")
      ->option_text("TEXT");
}

std::string WebOptions::givenToken() const {
  if (!token_file.empty()) {
    std::string line = firstLine(token_file);
    requireGoodToken(line, token_file);
    return line;
  }
  return token.empty() ? checked(variable(kTokenVariable), kTokenVariable) : checked(token, "token");
}

WebServerOptions WebOptions::whereItListens() const {
  WebServerOptions options{.bind = bind};
  options.port = port.value_or(options.port);
  options.other_ports = !port.has_value();
  return options;
}

std::string WebOptions::portNotice(std::uint16_t port_served) const {
  const std::uint16_t usual = WebServerOptions{}.port;
  return port || port_served == usual ? "" : fmt::format("port {} is in use: serving on {}\n", usual, port_served);
}

WebServerOptions WebOptions::forAll() const {
  WebServerOptions options = whereItListens();
  options.takes_uploads = !read_only;
  Entrance& entrance = options.entrances.front();
  entrance.token = givenToken();
  options.guessable = !entrance.token.empty();
  if (!isLoopback(bind) && entrance.token.empty()) {
    entrance.token = newToken();
  }
  validate(options);
  return options;
}

WebServerOptions WebOptions::forStudy() const {
  std::string experimenters = givenToken();
  std::string participants = participant_token.empty() ? checked(variable(kParticipantVariable), kParticipantVariable)
                                                       : checked(participant_token, "participant-token");
  WebServerOptions options = whereItListens();
  options.guessable = !participants.empty() || !experimenters.empty();
  options.entrances.resize(2);
  options.entrances[kParticipants] = {.token = participants.empty() ? newToken() : std::move(participants),
                                      .nameless = true};
  options.entrances[kExperimenters] = {.token = experimenters.empty() ? newToken() : std::move(experimenters)};
  validate(options);
  return options;
}

}  // namespace haptolith

#include "web_options.h"

#include <CLI/CLI.hpp>

#include "haptolith/viewer/access.h"

namespace haptolith {

void addWebOptions(CLI::App& command, WebServerOptions& options) {
  command.add_option("--port", options.port, "Port of the page, or the next that is free; 0: any [8080]")
      ->option_text("PORT");
  command
      .add_option("--bind", options.bind, "Address to listen on [127.0.0.1]; any but this machine's own wants a token")
      ->option_text("ADDRESS");
  command.add_option("--token", options.token, "What a browser must know; default beyond this machine: made up")
      ->option_text("TEXT");
}

void completeWebOptions(WebServerOptions& options) {
  if (!isLoopback(options.bind) && options.token.empty()) {
    options.token = newToken();
  }
  validate(options);
}

}  // namespace haptolith

#pragma once

#include "haptolith/viewer/web_server.h"

namespace CLI {
class App;
}

namespace haptolith {

/// --port, --bind and --token.
void addWebOptions(CLI::App& command, WebServerOptions& options);

/// Makes up a token where one is needed and none was given. @throws InvalidParameter as validate().
void completeWebOptions(WebServerOptions& options);

}  // namespace haptolith

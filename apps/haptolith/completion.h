#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// Adds `completion bash|zsh|fish`, which prints a completion script made from the commands and options of `app`:
/// a new command needs nothing here.
void addCompletionCommand(CLI::App& app);

}  // namespace haptolith

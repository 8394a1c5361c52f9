#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>

#include "haptolith/core/error.h"

#include "soil_commands.h"

namespace {
constexpr int kFailed = 1;
constexpr int kWrongUse = 2;
}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"haptolith: lunar and planetary regolith, felt through a haptic device at 1 kHz"};
  app.require_subcommand(1);
  haptolith::addSoilCommands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kWrongUse;
  } catch (const haptolith::InvalidParameter& error) {
    fmt::print(stderr, "haptolith: {}\n", error.what());
    return kWrongUse;
  } catch (const haptolith::Failure& error) {
    fmt::print(stderr, "haptolith: {}\n", error.what());
    return kFailed;
  }
  return 0;
}

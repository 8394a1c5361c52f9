#pragma once

#include <CLI/App.hpp>

#include "shared/option_checks.h"

namespace haptolith {

/// Adds options for the lapses of simulated participants: `--lapse`, the asymptotes as in `study fit`, or `--blind`,
/// the fraction of responses without attention, half of which are correct by chance.
inline void addLapseOptions(CLI::App& command, double& lapse) {
  CLI::Option* asymptote =
      command.add_option("--lapse", lapse, "Distance of psi from 0 and from 1, as in study fit [0]")
          ->option_text("RATE");
  command
      .add_option_function<double>(
          "--blind", [&lapse](double share) { lapse = share / 2; },
          "Fraction of responses given without attention, twice --lapse [0]")
      ->check(numberIn({0.0, 1.0}))
      ->excludes(asymptote)
      ->option_text("SHARE");
}

}  // namespace haptolith

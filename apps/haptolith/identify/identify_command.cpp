#include <CLI/App.hpp>

#include "commands.h"
#include "identify/identify_commands.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

constexpr const char* kIdentifyExamples = R"(Examples:
  haptolith identify probe --out probe.csv            write the trajectory of a robot's shovel
  haptolith identify soil measured.csv                estimate the soil from the measured forces
  haptolith identify next first.csv --out second.csv  choose the most informative next part
  haptolith identify train --poses mine.csv --scene mine.toml --out mine.json
                                                      train for another trajectory and tool

Guide: docs/how-to/identify-a-soil.md; methods and accuracy: docs/reports/identification.md)";

}  // namespace

void addIdentifyCommand(CLI::App& app) {
  CLI::App* identify = app.add_subcommand("identify", kIdentifyDescription);
  identify->require_subcommand(1);
  identify->footer(kIdentifyExamples);
  addIdentifyProbe(*identify);
  addIdentifySoil(*identify);
  addIdentifyNext(*identify);
  addIdentifyDensity(*identify);
  addIdentifyTrain(*identify);
  addIdentifyEvaluate(*identify);
}

}  // namespace haptolith

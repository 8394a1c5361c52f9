#include <CLI/App.hpp>

#include "commands.h"
#include "identify/identify_commands.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

constexpr const char* kIdentifyExamples = R"(Examples:
  haptolith identify probe --out probe.csv            where a robot's shovel goes to learn about soil
  haptolith identify soil measured.csv                what soil it was that the robot met there
  haptolith identify next first.csv --out second.csv  which part of the probe would tell the most after that
  haptolith identify train --poses mine.csv --scene mine.toml --out mine.json    another movement, another tool

Guide: docs/how-to/identify-a-soil.md. Results: docs/reports/identification.md.)";

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
  addIdentifyCheck(*identify);
}

}  // namespace haptolith

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <memory>

#include "haptolith/core/error.h"
#include "haptolith/identify/soil_belief.h"

#include "identify/identify_commands.h"
#include "identify/training_options.h"
#include "shared/output.h"
#include "shared/saved.h"

namespace haptolith {

namespace {

constexpr const char* kIdentifyTrainExamples = R"(Examples:
  haptolith identify train --out probe.json                        repeat the built-in training
  haptolith identify train --poses mine.csv --scene mine.toml --out mine.json
  haptolith identify train --out probe.json --soils 200 --resume   continue, with more soils

A soil takes about one minute on one core. Fewer than 100 soils are not sufficient.
Method: docs/reports/identification.md)";

void train(const SoilsOptions& options) {
  Training training = dugSoils(options, trainingNumber);
  if (!training.temper) {
    try {
      training.temper = LeaveOneOut(training).calibratedTemper();
      keep(options, training);
    } catch (const InvalidParameter& too_few) {  // the finished runs stay in the file
      printNotice(fmt::format("not enough soils yet: {}\n", too_few.what()));
    }
  }
  printNotice(savedText());
}

}  // namespace

void addIdentifyTrain(CLI::App& identify) {
  auto options = std::make_shared<SoilsOptions>();
  CLI::App* command =
      identify.add_subcommand("train", "Simulate a movement in many soils, and save their forces on the tool");
  command->footer(kIdentifyTrainExamples);
  command->add_option("--out", options->out_file, "Training file to write")->option_text("FILE.json")->required();
  options->addTo(*command, 121);
  command->callback([options] { train(*options); });
}

}  // namespace haptolith

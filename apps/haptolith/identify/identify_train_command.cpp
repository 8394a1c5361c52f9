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
  haptolith identify train --out probe.json                                  as the built-in one was made
  haptolith identify train --poses mine.csv --scene mine.toml --out mine.json
  haptolith identify train --out probe.json --soils 200 --resume             goes on, with more soils

Every soil takes about a minute of one processor; fewer than 100 tell little. docs/reports/identification.md describes the training.)";

void train(const SoilsOptions& options) {
  Training training = dugSoils(options, trainingNumber);
  if (!training.temper) {
    try {
      training.temper = LeaveOneOut(training).calibratedTemper();
      keep(options, training);
    } catch (const InvalidParameter& too_few) {  // the finished runs stay in the file
      printNotice(fmt::format("not enough to learn from yet: {}\n", too_few.what()));
    }
  }
  printNotice(savedText());
}

}  // namespace

void addIdentifyTrain(CLI::App& identify) {
  auto options = std::make_shared<SoilsOptions>();
  CLI::App* command =
      identify.add_subcommand("train", "Dig along a movement in many soils, to learn what each does to the tool");
  command->footer(kIdentifyTrainExamples);
  command->add_option("--out", options->out_file, "Where to write what was learned")
      ->option_text("FILE.json")
      ->required();
  options->addTo(*command, 121);
  command->callback([options] { train(*options); });
}

}  // namespace haptolith

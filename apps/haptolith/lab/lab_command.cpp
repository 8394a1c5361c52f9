#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/lab/catalogue/lab_test.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "lab/specimens.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/progress.h"
#include "shared/stop_on_signal.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

constexpr Range kSeeds{1, 100};

struct TestCommand {
  LabOptions lab;
  int seeds = 1;
  std::map<std::string, std::string> given;  ///< the test's options on the command line
};

/// Returns the test's options that differ from their defaults.
std::map<std::string, std::string> givenOptions(const CLI::App& command, const LabTest& test) {
  std::map<std::string, std::string> given;
  for (const LabOption& option : test.options) {
    const CLI::Option* of_command = command.get_option(flagOf(option));
    const std::string text = fmt::format("{}", fmt::join(of_command->results(), ","));
    if (of_command->count() > 0 && text != option.usual) {
      given.emplace(option.key, text);
    }
  }
  return given;
}

void runSpecimen(const LabTest& test, const TestCommand& command) {
  StatusLine status;
  const LabOptions& options = command.lab;
  requireWritable({options.overwrite(options.trace_file), options.overwrite(options.figure_file)});
  const LabSoil soil = labSoil(options, test.radius_mm);
  Progress progress(status);
  const LabConditions conditions = labConditions(options, soil, progress.part(0, 1));
  progress.expect(test.typical_s, conditions.threads);
  const LabOutput output = test.run(soil, conditions);
  status.clear();
  if (!options.trace_file.empty()) {
    saveTrace(options.overwrite(options.trace_file), output.trace);
  }
  const std::string circumstances = circumstancesText(options, soil, conditions);
  if (!options.figure_file.empty()) {
    output.draw(options.overwrite(options.figure_file), circumstances);
  }
  if (options.json) {
    printJson(specimenJson(test.name, options, soil, conditions, output, command.given));
  } else {
    printText(fmt::format("lab {}: {}\n\n{}", test.name, circumstances, output.text));
  }
}

/// Runs specimens in sequence and prints their statistics.
void runSpecimens(const LabTest& test, const TestCommand& command) {
  StatusLine status;
  LabOptions options = command.lab;
  const LabSoil soil = labSoil(options, test.radius_mm);
  Progress progress(status);
  progress.expect(command.seeds * test.typical_s, threadsFor(options.threads));
  std::vector<Specimen> specimens;
  for (int i = 0; i < command.seeds; ++i) {
    options.seed = command.lab.seed + static_cast<std::uint64_t>(i);
    const LabConditions conditions =
        labConditions(options, soil, progress.part(1.0 * i / command.seeds, (1.0 + i) / command.seeds));
    specimens.push_back({options.seed,
                         specimenJson(test.name, options, soil, conditions, test.run(soil, conditions), command.given),
                         ""});
  }
  status.clear();
  const Collection collection = collected(std::move(specimens));
  options.json ? printJson(collection.json) : printText(collection.text);
}

void runTest(const LabTest& test, const TestCommand& command) {
  const StopOnSignal stop_on_signal;
  if (command.seeds == 1) {
    return runSpecimen(test, command);
  }
  for (const auto& [option, file] :
       {std::pair("--figure", command.lab.figure_file), {"--trace", command.lab.trace_file}}) {
    if (!file.empty()) {
      throw InvalidParameter(option, file, "left out with --seeds: it shows one specimen");
    }
  }
  runSpecimens(test, command);
}

void addTest(CLI::App& lab, const LabTest& test) {
  auto options = std::make_shared<TestCommand>();
  CLI::App* command = lab.add_subcommand(test.name, test.description);
  options->lab.addTo(*command);
  command
      ->add_option("--seeds", options->seeds,
                   "Number of specimens, each with its own seed from --seed on; report mean and standard deviation")
      ->check(wholeNumberIn(kSeeds))
      ->capture_default_str();
  for (const LabOption& option : test.options) {
    addOption(*command, option);
  }
  command->footer("Examples:\n" + test.examples);
  command->callback([test, options, command] {
    options->given = givenOptions(*command, test);
    runTest(test, *options);
  });
}

}  // namespace

void addLabCommand(CLI::App& app) {
  CLI::App* lab = app.add_subcommand("lab", kLabDescription);
  lab->require_subcommand(1);
  lab->footer("Example:\n  haptolith lab shear --soil lunar-0-15cm\nRun a test with --help for its options.");
  for (const LabTest& test : labTests()) {
    addTest(*lab, test);
  }
  addCollect(*lab);
  addReport(*lab);
  addValidate(*lab);
  addBand(*lab);
}

}  // namespace haptolith

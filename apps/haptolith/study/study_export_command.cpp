#include <CLI/App.hpp>

#include <memory>
#include <string>

#include "haptolith/study/export/export.h"
#include "haptolith/study/store/store.h"

#include "commands.h"
#include "shared/option_checks.h"

namespace haptolith {

namespace {

constexpr const char* kStudyExportExamples = R"(Examples:
  haptolith study export friction.study --to friction.csv               a row for each trial
  haptolith study export friction.study --to friction --format bids     a folder for archives
  haptolith study export friction.study --to all.csv --personal         with answers that tell who somebody is)";

struct ExportCommandOptions {
  std::string file, to, format = "csv";
  ExportOptions what;
};

void exportStudy(const ExportCommandOptions& options) {
  const StudyStore study(options.file, StudyStore::Access::kRead);
  if (options.format == "bids") {
    exportBids(study, options.to, options.what);
  } else {
    exportCsv(study, options.to, options.what);
  }
}

}  // namespace

void addStudyExportCommand(CLI::App& study) {
  auto options = std::make_shared<ExportCommandOptions>();
  options->what.program_version = HAPTOLITH_VERSION;
  CLI::App* command = study.add_subcommand("export", "Convert a study for other programs: CSV or BIDS");
  command->footer(kStudyExportExamples);
  command->add_option("file", options->file, "A study")->required()->option_text("FILE");
  command->add_option("--to", options->to, "Where to: a file, for bids a folder")
      ->required()
      ->check(outputName())
      ->option_text("PATH");
  command
      ->add_option(
          "--format", options->format,
          "csv: a table of trials, one of sessions and what their columns mean; bids: a folder of tables [csv]")
      ->check(oneOf({"csv", "bids"}))
      ->option_text("csv|bids");
  command->add_flag("--personal", options->what.personal, "With the answers to personal items");
  command->add_option("--author", options->what.authors, "Of a BIDS folder, several times; default: the protocol's")
      ->option_text("NAME");
  command->add_flag("--overwrite", options->what.overwrite, "Replace an earlier export");
  command->callback([options] { exportStudy(*options); });
}

}  // namespace haptolith

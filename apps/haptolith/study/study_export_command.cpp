#include <CLI/App.hpp>

#include <memory>
#include <string>

#include "haptolith/study/export/export.h"
#include "haptolith/study/store/store.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"

namespace haptolith {

namespace {

constexpr const char* kStudyExportExamples = R"(Examples:
  haptolith study export friction.study --out friction.csv               one row per trial
  haptolith study export friction.study --out friction --format bids     a folder for archives
  haptolith study export friction.study --out all.csv --personal         with personal data)";

struct ExportCommandOptions {
  std::string file, out, format = "csv";
  ExportOptions what;
};

void exportStudy(const ExportCommandOptions& options) {
  const StudyStore study(options.file, StudyStore::Access::kRead);
  if (options.format == "bids") {
    exportBids(study, options.out, options.what);
  } else {
    exportCsv(study, options.out, options.what);
  }
}

}  // namespace

void addStudyExportCommand(CLI::App& study) {
  auto options = std::make_shared<ExportCommandOptions>();
  options->what.program_version = HAPTOLITH_VERSION;
  CLI::App* command = study.add_subcommand("export", "Export a study as CSV or BIDS");
  command->footer(kStudyExportExamples);
  command->add_option("file", options->file, kStudyFileHelp)->required()->option_text("FILE");
  command->add_option("--out", options->out, "Output file; a folder for bids")
      ->required()
      ->check(outputName())
      ->option_text("PATH");
  command
      ->add_option("--format", options->format,
                   "Format. csv: tables of trials and sessions, and descriptions of their columns; bids: a folder of "
                   "tables [csv]")
      ->check(oneOf({"csv", "bids"}))
      ->option_text("csv|bids");
  command->add_flag("--personal", options->what.personal, "Include the answers to personal items");
  command
      ->add_option("--author", options->what.authors, "Author named in a BIDS folder; can be repeated [the protocol's]")
      ->option_text("NAME");
  command->add_flag("--overwrite", options->what.overwrite, "Replace an earlier export");
  command->callback([options] { exportStudy(*options); });
}

}  // namespace haptolith

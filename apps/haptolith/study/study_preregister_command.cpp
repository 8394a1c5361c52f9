#include <CLI/App.hpp>

#include <memory>
#include <string>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/study/export/preregistration.h"
#include "haptolith/study/protocol/protocol.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/output.h"
#include "shared/overwrite.h"

namespace haptolith {

namespace {

constexpr const char* kStudyPreregisterExamples = R"(Examples:
  haptolith study preregister mine.toml
  haptolith study preregister mine.toml --out preregistration.md)";

struct PreregisterOptions {
  std::string protocol, file;
  Overwrite overwrite;
};

void preregister(const PreregisterOptions& options) {
  const ProtocolText text = findProtocol(options.protocol);
  const std::string written = preregistrationText(loadProtocolText(text.text, text.name),
                                                  {.protocol_text = text.text, .version = HAPTOLITH_VERSION});
  if (options.file.empty()) {
    printText(written);
    return;
  }
  AtomicFile file(options.overwrite(options.file));
  file.write(written);
  file.commit();
  printNotice("Fill in the text in [BRACKETS].\n");
}

}  // namespace

void addStudyPreregisterCommand(CLI::App& study) {
  auto options = std::make_shared<PreregisterOptions>();
  CLI::App* command = study.add_subcommand("preregister", "Write a preregistration from a protocol");
  command->footer(kStudyPreregisterExamples);
  command->add_option("protocol,--protocol", options->protocol, kProtocolHelp)->required()->option_text("PROTOCOL");
  command->add_option("--out", options->file, "Output file (.md) [standard output]")->option_text("FILE");
  options->overwrite.addTo(*command);
  command->callback([options] { preregister(*options); });
}

}  // namespace haptolith

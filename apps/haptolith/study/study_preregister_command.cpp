#include <CLI/App.hpp>

#include <memory>
#include <string>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/study/export/preregistration.h"
#include "haptolith/study/protocol/protocol.h"

#include "commands.h"
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
  printNotice("What stands in [BRACKETS] is for you to fill in.\n");
}

}  // namespace

void addStudyPreregisterCommand(CLI::App& study) {
  auto options = std::make_shared<PreregisterOptions>();
  CLI::App* command = study.add_subcommand("preregister", "Write the text of a preregistration from a protocol");
  command->footer(kStudyPreregisterExamples);
  command->add_option("protocol,--protocol", options->protocol, "A built-in protocol, or a file")
      ->required()
      ->option_text("PROTOCOL");
  command->add_option("--out", options->file, "Write it to FILE.md instead of the terminal")->option_text("FILE");
  options->overwrite.addTo(*command);
  command->callback([options] { preregister(*options); });
}

}  // namespace haptolith

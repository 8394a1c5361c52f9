#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/pluralise.h"
#include "haptolith/scene_file/site_task.h"
#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/protocol/sequence.h"
#include "haptolith/study/store/store.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"

namespace haptolith {

namespace {

constexpr const char* kStudyNewExamples = R"(Examples:
  haptolith study new friction.study --protocol icra2021-friction
  haptolith study new mine.study --protocol mine.toml

Built-in protocols:
{}
To write a protocol, see docs/reference/protocol-keys.md)";

struct NewOptions {
  std::string file, protocol;
  std::optional<std::uint64_t> seed;
};

/// Returns a random seed below 2^53, which tables and JSON represent exactly.
std::uint64_t drawnSeed() {
  std::random_device device;
  return ((std::uint64_t{device()} << 32) | device()) >> 11;
}

std::string summaryOf(const StudyProtocol& protocol) {
  std::string text;
  const std::vector<PlannedBlock> sequence = sequenceFor(protocol, 0, 1);
  for (std::size_t i = 0; i < protocol.blocks.size(); ++i) {
    const StudyBlock& block = protocol.blocks[i];
    std::size_t trials = 0;
    for (const PlannedBlock& planned : sequence) {
      trials += planned.block == i ? planned.trials.size() : 0;
    }
    if (block.teleop) {
      text += fmt::format("  {:<16} robot task: {}, {}, {}\n", block.name, wordFor(kSiteTaskWords, block.teleop->task),
                          block.reference.name, pluralise(trials, "trial"));
      continue;
    }
    const bool adaptive = block.procedure != ProcedureKind::kConstant;
    text += fmt::format("  {:<16} {} against {}, {}\n", block.name, pluralise(block.levels.size(), "level"),
                        block.reference.name, adaptive ? std::string("chosen adaptively") : pluralise(trials, "trial"));
  }
  for (const ParticipantGroup& group : protocol.groups) {
    std::vector<std::string_view> blocks;
    for (const std::size_t block : group.blocks) {
      blocks.push_back(protocol.blocks[block].name);
    }
    text += fmt::format("  group {:<10} {}, share {}\n", group.name, fmt::join(blocks, ", "), group.share);
  }
  return text;
}

void makeStudy(const NewOptions& options) {
  const ProtocolText text = findProtocol(options.protocol);
  const StudyProtocol protocol = loadProtocolText(text.text, text.name);
  // The built-in ones are examples for a trial run.
  const std::vector<std::string_view> names = protocolNames();
  const bool built_in = std::ranges::find(names, text.name) != names.end();
  if (!built_in) {
    requireFilledIn(protocol);
  }
  const std::uint64_t seed = options.seed ? *options.seed : drawnSeed();
  StudyStore::create(options.file, protocol, text.text, seed);
  printText(fmt::format("{}: {} (seed {})\n{}", options.file, protocol.title, seed, summaryOf(protocol)));
  if (built_in && protocol.consent.find('[') != std::string::npos) {
    printNotice(
        fmt::format("The consent page has text in [BRACKETS]. Use this study for 'study simulate' and 'study run "
                    "--trial-run' only; for a real study, write a protocol (docs/reference/protocol-keys.md).\n"));
  }
}

}  // namespace

namespace {

/// Names of the built-in protocols, four per line.
std::string protocolLines() {
  std::string lines;
  constexpr std::size_t kPerLine = 4;
  const auto names = protocolNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    lines += fmt::format("{}{}", i == 0 ? "  " : i % kPerLine == 0 ? ",\n  " : ", ", names[i]);
  }
  return lines;
}

}  // namespace

void addStudyNewCommand(CLI::App& study) {
  auto options = std::make_shared<NewOptions>();
  CLI::App* command = study.add_subcommand("new", "Create a study file from a protocol");
  command->footer(fmt::format(kStudyNewExamples, protocolLines()));
  command->add_option("file", options->file, "Study file to create; it must not exist")
      ->required()
      ->check(outputName())
      ->option_text("FILE");
  command->add_option("--protocol", options->protocol, kProtocolHelp)->required()->option_text("PROTOCOL");
  command->add_option("--seed", options->seed, "Seed of all random orders [random]")->option_text("N");
  command->callback([options] { makeStudy(*options); });
}

}  // namespace haptolith

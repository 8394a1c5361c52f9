#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "haptolith/core/stop_asked.h"
#include "haptolith/teleop/link/udp_relay.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/option_checks.h"
#include "shared/output.h"
#include "shared/stop_on_signal.h"
#include "teleop/link_options.h"
#include "teleop/teleop_commands.h"
#include "workbench_commands.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kLinkMs = 1e-3;
constexpr double kLinkKbit = 1e3;
constexpr double kLook_s = 0.1;

constexpr const char* kTeleopLinkExamples = R"(Examples:
  haptolith teleop link --list
                              list the profiles
  haptolith teleop link --profile earth-moon --connect 127.0.0.1:9050
                              forward from 127.0.0.1:7400 to port 9050 with 1.3 s delay each way
  haptolith teleop link --round-trip-s 1 --jitter-ms 50 --loss 0.1 --connect 127.0.0.1:9050
  haptolith teleop link --profile lan --outage 20,10 --connect 127.0.0.1:9050
                              outage of 10 s)";

struct RelayOptions {
  UdpRelayOptions relay;
  LinkOptions link;
  std::optional<double> duration_s;
  bool lists = false;  ///< whether the profiles are listed
  bool json = false;
};

Json countsJson(const LinkCounts& counts) {
  return {{"sent", counts.sent},          {"arrived", counts.arrived}, {"lost", counts.lost},
          {"cut_off", counts.cut_off},    {"dropped", counts.dropped}, {"duplicated", counts.duplicated},
          {"overtaken", counts.overtaken}};
}

std::string countsText(const LinkCounts& up, const LinkCounts& down, std::uint64_t ignored) {
  const auto way = [](const char* name, const LinkCounts& counts) {
    return fmt::format("  {:5} {:9} sent {:9} arrived {:8} lost {:8} cut off {:8} dropped by the queue\n", name,
                       counts.sent, counts.arrived, counts.lost, counts.cut_off, counts.dropped);
  };
  return fmt::format("{}{}        {:9} rejected: from other senders, or too many in transit\n", way("up", up),
                     way("down", down), ignored);
}

void runLink(const RelayOptions& options) {
  const LinkProfile link = options.link.link();
  UdpRelay relay(link.up, link.down, options.relay);
  const StopOnSignal stop;
  const bool measured = !link.up.delays.empty() || !link.down.delays.empty();
  printNotice(fmt::format("a link with a round trip of {}, from port {} to {}; Ctrl-C ends it\n",
                          measured ? "delays from a table" : fmt::format("{:g} s", link.roundTrip()), relay.port(),
                          options.relay.to));
  double left_s = options.duration_s.value_or(LinkRanges::time_s.highest);
  StatusLine status;
  while (!stopAsked() && left_s > 0) {
    const double next_s = std::min(left_s, kLook_s);
    relay.run(next_s);
    left_s -= next_s;
    if (status.visible()) {
      status.update(fmt::format("{} up, {} down, {} in transit", relay.up().arrived, relay.down().arrived,
                                relay.up().onTheWay() + relay.down().onTheWay()));
    }
  }
  status.clear();
  if (options.json) {
    printJson({{"profile", options.link.profile},
               {"round_trip_s", measured ? Json(nullptr) : Json(link.roundTrip())},
               {"up", countsJson(relay.up())},
               {"down", countsJson(relay.down())},
               {"ignored", relay.ignored()}});
    return;
  }
  printText(countsText(relay.up(), relay.down(), relay.ignored()));
}

Json profileJson(const LinkProfile& profile) {
  return {{"name", profile.name},
          {"what", profile.what},
          {"round_trip_s", profile.roundTrip()},
          {"jitter_s", profile.up.jitter_s},
          {"loss", profile.up.meanLoss()},
          {"rate_bit_s", profile.up.rate_bit_s}};
}

void listProfiles(bool json) {
  if (json) {
    Json list = Json::array();
    for (const LinkProfile& profile : linkProfiles()) {
      list.push_back(profileJson(profile));
    }
    printJson({{"profiles", list}});
    return;
  }
  std::string text = fmt::format("{:17} {:>10} {:>9} {:>6} {:>10}\n", "", "round", "jitter", "loss", "kbit/s");
  text += fmt::format("{:17} {:>10} {:>9} {:>6} {:>10}\n", "name", "trip, s", "ms", "%", "each way");
  for (const LinkProfile& profile : linkProfiles()) {
    text += fmt::format("{:17} {:10g} {:9g} {:6.1f} {:10g}  {}\n", profile.name, profile.roundTrip(),
                        profile.up.jitter_s / kLinkMs, 100 * profile.up.meanLoss(), profile.up.rate_bit_s / kLinkKbit,
                        profile.what);
  }
  printText(text);
}

void addLink(CLI::App& teleop) {
  auto options = std::make_shared<RelayOptions>();
  CLI::App* command =
      teleop.add_subcommand("link", "Relay UDP packets between two programs with delay, jitter and loss");
  command->footer(kTeleopLinkExamples);
  CLI::Option* connect =
      command->add_option("--connect", options->relay.to, "Address of the robot; required unless with --list")
          ->option_text("HOST:PORT");
  command->add_flag("--list", options->lists, "List the link profiles and exit")->excludes(connect);
  command->add_option("--listen", options->relay.listen, "Address to listen on for the operator")
      ->option_text("HOST:PORT [127.0.0.1:7400]");
  command->add_option("--profile", options->link.profile, "Link profile (haptolith teleop link --list)")
      ->option_text("NAME [lan]");
  command
      ->add_option("--round-trip-s", options->link.round_trip_s,
                   "Round-trip delay, half of it each way [the profile's]")
      ->option_text("SECONDS")
      ->check(numberIn({0, 2 * LinkRanges::delay_s.highest}));
  options->link.addTo(*command);
  command->add_option("--duration-s", options->duration_s, "Duration [until Ctrl-C]")
      ->option_text("SECONDS")
      ->check(numberIn({0, LinkRanges::time_s.highest}));
  addJson(*command, options->json);
  command->callback([options] {
    if (options->lists) {
      listProfiles(options->json);
    } else if (options->relay.to.empty()) {
      throw CLI::RequiredError("--connect or --list");
    } else {
      runLink(*options);
    }
  });
}

}  // namespace

void addTeleopCommand(CLI::App& app) {
  CLI::App* teleop = app.add_subcommand("teleop", kTeleopDescription);
  teleop->require_subcommand(1);
  teleop->footer(
      "Examples, each in a separate terminal:\n  haptolith teleop robot\n  haptolith teleop link --profile earth-moon "
      "--connect 127.0.0.1:7410\n  haptolith teleop operator --connect 127.0.0.1:7400\nRun a command with --help for "
      "its options. Guide: docs/how-to/teleoperate.md");
  addLink(*teleop);
  addTeleopRobot(*teleop);
  addTeleopRos2(*teleop);
  addTeleopOperator(*teleop);
  addTeleopBench(*teleop);
}

}  // namespace haptolith

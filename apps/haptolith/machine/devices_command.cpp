#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>

#include "haptolith/core/platform/descriptor.h"
#include "haptolith/device/drivers/open_device.h"
#include "haptolith/scene_file/scene_words.h"

#include "commands.h"
#include "shared/common_options.h"
#include "shared/output.h"

namespace haptolith {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDevicesExamples = R"(Examples:
  haptolith devices                             list devices, and why some are not available
  haptolith devices --device-library /opt/sdk   use Force Dimension's SDK in this folder
  haptolith run --device force-dimension        run a scene with this device)";

struct DevicesOptions {
  DeviceParameters parameters;
  bool json = false;
};

Json reportJson(const DeviceReport& report) {
  return {{"device", wordFor(kDeviceWords, report.kind)},
          {"name", report.name},
          {"id", report.id},
          {"usable", report.usable},
          {"why_not", report.why_not},
          {"remedy", report.remedy}};
}

std::string reportText(const DeviceReport& report, bool coloured) {
  const std::string_view word = wordFor(kDeviceWords, report.kind);
  const std::string name = report.name.empty() ? std::string(word) : report.name;
  std::string text = fmt::format("{}{:3}{}  {:16} {}{}\n",
                                 !coloured       ? ""
                                 : report.usable ? "\033[32m"
                                                 : "\033[2m",
                                 report.usable ? "yes" : "no", coloured ? "\033[0m" : "", word, name,
                                 report.id.empty() || report.id == name ? "" : fmt::format(" (id {})", report.id));
  for (const std::string* lines : {&report.why_not, &report.remedy}) {
    for (std::size_t from = 0; from < lines->size();) {
      const std::size_t to = std::min(lines->find('\n', from), lines->size());
      text += fmt::format("     {}\n", lines->substr(from, to - from));
      from = to + 1;
    }
  }
  return text;
}

void listDevices(const DevicesOptions& options) {
  const std::vector<DeviceReport> reports = findDevices(options.parameters);
  if (options.json) {
    Json list = Json::array();
    for (const DeviceReport& report : reports) {
      list.push_back(reportJson(report));
    }
    printJson({{"devices", list}});
    return;
  }
  std::string text;
  for (const DeviceReport& report : reports) {
    text += reportText(report, isColoured(kStandardOutput));
  }
  printText(text);
}

}  // namespace

void addDevicesCommand(CLI::App& app) {
  auto options = std::make_shared<DevicesOptions>();
  CLI::App* command =
      app.add_subcommand("devices", "List the available haptic devices, and why others are not available");
  command->footer(kDevicesExamples);
  command->add_option("--device-library", options->parameters.library, "Folder or file of Force Dimension's SDK")
      ->option_text("PATH");
  addJson(*command, options->json);
  command->callback([options] { listDevices(*options); });
}

}  // namespace haptolith

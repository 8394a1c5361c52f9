#pragma once

#include <optional>
#include <string>

#include "haptolith/teleop/robot/robot_server.h"

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// Options for the packets of one end of a teleoperation.
struct TeleopEndOptions {
  std::optional<std::string> key_file;
  std::optional<double> rate_kbit_s;
  bool insecure = false;

  void addTo(CLI::App& command);

  /// Returns the options of the end. @throws Failure if the key cannot be read.
  [[nodiscard]] EndOptions end() const;
};

}  // namespace haptolith

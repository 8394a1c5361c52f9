#pragma once

#include <optional>
#include <string>

#include "haptolith/teleop/robot/robot_server.h"

namespace CLI {
class App;
}  // namespace CLI

namespace haptolith {

/// How one end of a teleoperation sends packets, as the command line says it.
struct TeleopEndOptions {
  std::optional<std::string> key_file;
  std::optional<double> rate_kbit_s;
  bool insecure = false;

  void addTo(CLI::App& command);

  /// @throws Failure when the key cannot be read.
  [[nodiscard]] EndOptions end() const;
};

}  // namespace haptolith

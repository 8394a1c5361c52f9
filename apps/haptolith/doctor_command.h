#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith doctor`: can this machine run the loop in real time, and if not, what mends it?
void addDoctorCommand(CLI::App& app);

}  // namespace haptolith

#pragma once

namespace CLI {
class App;
}

namespace haptolith {

/// `haptolith lab report`: every test with both models of friction, on one HTML page.
void addReport(CLI::App& lab);

}  // namespace haptolith

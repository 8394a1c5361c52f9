#pragma once

namespace CLI {
class App;
}

namespace haptolith {

void addIdentifyProbe(CLI::App& identify);
void addIdentifySoil(CLI::App& identify);
void addIdentifyNext(CLI::App& identify);
void addIdentifyDensity(CLI::App& identify);
void addIdentifyTrain(CLI::App& identify);
void addIdentifyEvaluate(CLI::App& identify);

}  // namespace haptolith

#pragma once

#include <string>
#include <vector>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/teleop/operator/force_agreement.h"

namespace haptolith {

/// One run: force felt and force met, by the time of the command.
struct AgreementPanel {
  std::string title;
  std::vector<AgreementPoint> points;
};

/// Draws runs one below the other, two in a row, with the same scales. Not for the tick.
/// @throws InvalidParameter, Failure: as Figure; InvalidParameter without panels.
void drawAgreement(const OutputFile& file, const std::vector<AgreementPanel>& panels);

}  // namespace haptolith

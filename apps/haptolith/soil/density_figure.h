#pragma once

#include <string>

#include "haptolith/core/files/atomic_file.h"
#include "haptolith/soil/soil_parameters.h"

namespace haptolith {

/// Content of the density figure, in addition to the lunar law and the measured bands.
struct DensityFigure {
  SoilParameters soil;
  double gravity_m_s2 = 1.625;
  std::string preset;  ///< name of the preset `soil`; empty if given by its numbers
};

/// Draws bulk density against depth (paper, Fig. 2). For a preset: all presets under the same conditions, `preset`
/// emphasised, and the linear model with the paper's k = 100 N/m (at R = 7 mm). Otherwise the soil alone. The lunar law
/// and the measured band means are always drawn.
/// @throws as Figure.
void drawDensityFigure(const OutputFile& path, const DensityFigure& wanted);

}  // namespace haptolith

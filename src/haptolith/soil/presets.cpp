#include "haptolith/soil/presets.h"

#include "haptolith/soil/find_by_name.h"

namespace haptolith {

namespace {

constexpr SoilParameters tableTwoSoil(double mu_hat, double gamma_nm, double rho0_kg_m3, double rho_max_kg_m3) {
  SoilParameters soil;
  soil.mu_hat = mu_hat;
  soil.gamma_nm = gamma_nm;
  soil.rho0_kg_m3 = rho0_kg_m3;
  soil.rho_max_kg_m3 = rho_max_kg_m3;
  return soil;
}

constexpr std::array kPresets{
    Preset{"P1", 1.210, tableTwoSoil(0.494, 3.0e-5, 1270, 1824), {1501, 1593, 1759, 1676}},
    Preset{"P2", 1.000, tableTwoSoil(0.409, 3.5e-5, 1300, 1824), {1498, 1584, 1747, 1666}},
    Preset{"P3", 0.835, tableTwoSoil(0.342, 4.0e-5, 1330, 1824), {1501, 1579, 1737, 1658}},
    Preset{"P4", 0.735, tableTwoSoil(0.300, 6.0e-5, 1360, 1880), {1501, 1575, 1744, 1660}},
    Preset{"P5", 0.648, tableTwoSoil(0.265, 8.0e-5, 1400, 1920), {1516, 1582, 1745, 1664}},
    Preset{"P6", 0.600, tableTwoSoil(0.245, 1.2e-4, 1400, 2000), {1503, 1566, 1741, 1654}},
};

}  // namespace

std::span<const Preset> presets() {
  return kPresets;
}

const Preset& findPreset(std::string_view name) {
  return findByName(kPresets, "preset", name);
}

}  // namespace haptolith

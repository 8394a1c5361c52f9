#include "haptolith/identify/training/strength_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptolith/core/error.h"
#include "haptolith/core/find_root.h"

namespace haptolith {

namespace {

constexpr double kMapLambda = 0.3;
constexpr double kLeastMeasured_pa = 15;  ///< a fitted line's cohesion below it is scatter

double contactStress(const SoilParameters& soil) {
  return soil.contact_cohesion_n / (soil.radius_m * soil.radius_m);
}

double relativeStiffness(const SoilParameters& soil) {
  const SoilParameters lunar = lunarContacts();
  return std::log(soil.stiffness_n_m / soil.radius_m * lunar.radius_m / lunar.stiffness_n_m);
}

/// Returns the stiffening of contacts relative to lunar contacts of that size.
double relativeStiffening(const SoilParameters& soil) {
  return std::log(soil.gamma_nm / rescaled(lunarContacts(), soil.radius_m).gamma_nm);
}

Eigen::RowVectorXd angleColumns(const SoilParameters& soil) {
  const double mu = soil.contact_friction;
  const double q = std::log1p(contactStress(soil) / 300);
  Eigen::RowVectorXd columns(10);
  columns << mu, mu * mu, q, q * q, q * mu, soil.size_spread, soil.tangential_ratio, relativeStiffness(soil),
      soil.cohesion_range_ratio, relativeStiffening(soil);
  return columns;
}

Eigen::RowVectorXd cohesionColumns(const SoilParameters& soil) {
  const double mu = soil.contact_friction;
  Eigen::RowVectorXd columns(8);
  columns << mu, mu * mu, std::log(contactStress(soil)), soil.cohesion_range_ratio, soil.size_spread,
      soil.tangential_ratio, relativeStiffness(soil), relativeStiffening(soil);
  return columns;
}

Ridge fitted(const std::vector<Eigen::RowVectorXd>& rows, const std::vector<double>& observed) {
  if (rows.size() < 2) {
    throw InvalidParameter("training", "one soil with cohesion that was sheared", "more of them");
  }
  Eigen::MatrixXd columns(rows.size(), rows.front().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    columns.row(static_cast<Eigen::Index>(i)) = rows[i];
  }
  return {columns, Eigen::Map<const Eigen::VectorXd>(observed.data(), static_cast<Eigen::Index>(observed.size())),
          kMapLambda};
}

bool hasCohesion(const TrainingRun& run, const ShearStrength& measured) {
  return contactStress(run.sample.soil) > 0 && measured.cohesion_pa > kLeastMeasured_pa;
}

Ridge angleFit(const std::vector<TrainingRun>& runs, ShearStrength MeasuredStrength::*which) {
  std::vector<Eigen::RowVectorXd> rows;
  std::vector<double> observed;
  for (const TrainingRun& run : runs) {
    if (run.strength) {
      rows.push_back(angleColumns(run.sample.soil));
      observed.push_back(((*run.strength).*which).angle_deg);
    }
  }
  if (rows.size() < StrengthMap::kLeastSheared) {
    throw InvalidParameter("training", fmt::format("{} soils that were sheared", rows.size()),
                           fmt::format("{} or more", StrengthMap::kLeastSheared));
  }
  return fitted(rows, observed);
}

Ridge cohesionFit(const std::vector<TrainingRun>& runs, ShearStrength MeasuredStrength::*which) {
  std::vector<Eigen::RowVectorXd> rows;
  std::vector<double> observed;
  for (const TrainingRun& run : runs) {
    if (run.strength && hasCohesion(run, (*run.strength).*which)) {
      rows.push_back(cohesionColumns(run.sample.soil));
      observed.push_back(std::log(((*run.strength).*which).cohesion_pa / contactStress(run.sample.soil)));
    }
  }
  return fitted(rows, observed);
}

double deviation(const std::vector<double>& differences) {
  double squares = 0;
  for (const double difference : differences) {
    squares += difference * difference;
  }
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, differences.size())));
}

}  // namespace

StrengthMap::StrengthMap(const std::vector<TrainingRun>& runs)
    : residual_{angleFit(runs, &MeasuredStrength::residual), cohesionFit(runs, &MeasuredStrength::residual)},
      peak_{angleFit(runs, &MeasuredStrength::peak), cohesionFit(runs, &MeasuredStrength::peak)} {
  std::vector<double> angles_deg, cohesions;
  for (const TrainingRun& run : runs) {
    if (run.strength) {
      const ShearStrength mapped = of(run.sample.soil);
      angles_deg.push_back(run.strength->residual.angle_deg - mapped.angle_deg);
      if (hasCohesion(run, run.strength->residual)) {
        cohesions.push_back(std::log(run.strength->residual.cohesion_pa / mapped.cohesion_pa));
      }
    }
  }
  angle_scatter_deg_ = deviation(angles_deg);
  cohesion_scatter_ = deviation(cohesions);
}

ShearStrength StrengthMap::of(const SoilParameters& soil, SoilStrength kind) const {
  const Fit& fit = kind == SoilStrength::kPeak ? peak_ : residual_;
  const double stress_pa = contactStress(soil);
  return {fit.angle.of(angleColumns(soil))(0, 0),
          stress_pa > 0 ? stress_pa * std::exp(fit.cohesion.of(cohesionColumns(soil))(0, 0)) : 0};
}

SoilParameters StrengthMap::with(SoilParameters soil, const ShearStrength& residual) const {
  const Range friction = kNearRanges.contact_friction;
  const double area = soil.radius_m * soil.radius_m;
  const Range stress_pa{kNearRanges.contact_cohesion_n.lowest / std::pow(kTabulatedRadius_m, 2),
                        kNearRanges.contact_cohesion_n.highest / std::pow(kTabulatedRadius_m, 2)};
  const auto cohesive = [&](double mu) {
    soil.contact_friction = mu;
    const auto wrong_by = [&](double of_contact_pa) {
      soil.contact_cohesion_n = of_contact_pa * area;
      return of(soil).cohesion_pa - residual.cohesion_pa;
    };
    soil.contact_cohesion_n = wrong_by(stress_pa.lowest) >= 0 ? 0 : findRoot(stress_pa, wrong_by) * area;
  };
  cohesive(findRoot(friction, [&](double mu) {
    cohesive(mu);
    return of(soil).angle_deg - residual.angle_deg;
  }));
  return soil;
}

}  // namespace haptolith

#include "haptolith/identify/training/ridge.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace haptolith {

Ridge::Ridge(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& observed, double lambda)
    : mean_(columns.colwise().mean()), constant_(observed.colwise().mean()) {
  constexpr double kNothing = 1e-12;
  Eigen::MatrixXd centred = columns.rowwise() - mean_;
  scale_ = (centred.colwise().squaredNorm() / static_cast<double>(columns.rows())).cwiseSqrt().cwiseMax(kNothing);
  centred = centred.array().rowwise() / scale_.array();
  const Eigen::MatrixXd normal =
      centred.transpose() * centred + lambda * Eigen::MatrixXd::Identity(columns.cols(), columns.cols());
  slopes_ = normal.ldlt().solve(centred.transpose() * (observed.rowwise() - constant_));
}

Eigen::MatrixXd Ridge::of(const Eigen::MatrixXd& columns) const {
  const Eigen::MatrixXd scaled = (columns.rowwise() - mean_).array().rowwise() / scale_.array();
  return (scaled * slopes_).rowwise() + constant_;
}

Eigen::MatrixXd shrunkCovariance(const Eigen::MatrixXd& rows, double freedom) {
  const auto n = static_cast<double>(rows.rows());
  const Eigen::MatrixXd scaled = rows * std::sqrt(n / freedom);
  Eigen::MatrixXd covariance = scaled.transpose() * scaled / n;
  Eigen::MatrixXd of_squares = scaled.cwiseAbs2().transpose() * scaled.cwiseAbs2() / n - covariance.cwiseAbs2();
  Eigen::MatrixXd beside = covariance;
  of_squares.diagonal().setZero();
  beside.diagonal().setZero();
  constexpr double kLeast = 0.02;  // keeps the matrix invertible for few rows
  const double share = std::clamp(of_squares.sum() / n / std::max(beside.squaredNorm(), 1e-300), kLeast, 1.0);
  covariance -= share * beside;
  return covariance;
}

}  // namespace haptolith

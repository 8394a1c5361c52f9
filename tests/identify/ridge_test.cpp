#include "haptolith/identify/training/ridge.h"

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include <random>

#include "haptolith/core/math/random.h"

namespace haptolith {
namespace {

Eigen::MatrixXd chance(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniformSigned(random); });
}

TEST(Ridge, FindsALinearLawAgain) {
  const Eigen::MatrixXd x = chance(50, 3, 1);
  Eigen::MatrixXd slopes(3, 2);
  slopes << 1, -2, 0.5, 30, 0, 4;
  const Eigen::RowVector2d constant(7, -3);
  const Eigen::MatrixXd y = (x * slopes).rowwise() + constant;
  const Eigen::MatrixXd other = chance(5, 3, 2);
  EXPECT_LT((Ridge(x, y, 1e-9).of(other) - ((other * slopes).rowwise() + constant)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Ridge, IsTheMeanWhereNothingIsLearned) {
  const Eigen::MatrixXd x = chance(50, 3, 1), y = chance(50, 1, 3);
  EXPECT_NEAR(Ridge(x, y, 1e12).of(chance(1, 3, 4))(0, 0), y.mean(), 1e-6);
}

TEST(Ridge, ToleratesAColumnThatNeverChanges) {
  Eigen::MatrixXd x = chance(50, 3, 1);
  x.col(1).setConstant(0.2);
  const Eigen::MatrixXd y = 3 * x.col(0);
  EXPECT_NEAR(Ridge(x, y, 1e-9).of(x.topRows(1))(0, 0), y(0, 0), 1e-6);
}

TEST(ShrunkCovariance, OfIndependentNumbersIsNearlyDiagonal) {
  const Eigen::MatrixXd covariance = shrunkCovariance(chance(40, 20, 5), 40);
  Eigen::MatrixXd beside = covariance;
  beside.diagonal().setZero();
  EXPECT_LT(beside.cwiseAbs().maxCoeff(), 0.05);
  EXPECT_NEAR(covariance.diagonal().mean(), 1.0 / 3, 0.03) << "of an even number between -1 and 1";
}

TEST(ShrunkCovariance, KeepsWhatBelongsTogether) {
  Eigen::MatrixXd rows = chance(200, 2, 6);
  rows.col(1) = rows.col(0) + 0.3 * rows.col(1);
  const Eigen::MatrixXd covariance = shrunkCovariance(rows, 200);
  EXPECT_GT(covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1)), 0.9);
}

TEST(ShrunkCovariance, CanBeInvertedWithFewerRowsThanNumbers) {
  const Eigen::MatrixXd covariance = shrunkCovariance(chance(15, 60, 7), 10);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance).eigenvalues().minCoeff(), 1e-4);
}

}  // namespace
}  // namespace haptolith

#pragma once

#include <Eigen/Core>

namespace haptolith {

/// Ridge regression of several numbers on the same columns, standardised to a mean of 0 and a standard deviation of 1:
///
///     |Y - 1 m^T - A B|^2 + lambda |B|^2        is minimal
///
/// (Hoerl and Kennard, Ridge regression, Technometrics 12(1), 1970).
class Ridge {
 public:
  /// @param columns  one row per observation, without a constant column; two rows or more.
  Ridge(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& observed, double lambda);

  /// Returns predictions for other rows.
  [[nodiscard]] Eigen::MatrixXd of(const Eigen::MatrixXd& columns) const;

 private:
  Eigen::RowVectorXd mean_, scale_, constant_;
  Eigen::MatrixXd slopes_;
};

/// Returns the covariance of rows with mean 0, shrunk towards its diagonal by the estimated sampling error.
///
///     S' = (1 - a) S + a diag(S),    a = sum over i != j of var(s_ij) / sum of s_ij^2
///
/// (Ledoit and Wolf, J. Multivariate Analysis 88(2), 2004, with the target of Schaefer and Strimmer, Stat. Appl. Genet.
/// Mol. Biol. 4(1), 2005.)
/// @param freedom  degrees of freedom of the rows: their number minus that of the fitted parameters.
[[nodiscard]] Eigen::MatrixXd shrunkCovariance(const Eigen::MatrixXd& rows, double freedom);

}  // namespace haptolith

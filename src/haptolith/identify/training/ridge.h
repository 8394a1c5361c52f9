#pragma once

#include <Eigen/Core>

namespace haptolith {

/// Linear regression of several numbers on the same columns, with small slopes preferred to large ones: columns are
/// brought to a mean of 0 and a deviation of 1, and
///
///     |Y - 1 m^T - A B|^2 + lambda |B|^2        is least
///
/// (Hoerl and Kennard, Ridge regression, Technometrics 12(1), 1970).
class Ridge {
 public:
  /// @param columns  one row for each observation, no constant among them; two rows or more.
  Ridge(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& observed, double lambda);

  /// What the observations would be of other rows.
  [[nodiscard]] Eigen::MatrixXd of(const Eigen::MatrixXd& columns) const;

 private:
  Eigen::RowVectorXd mean_, scale_, constant_;
  Eigen::MatrixXd slopes_;
};

/// Covariance of rows whose mean is 0, drawn towards its own diagonal by as much as chance has put beside it.
///
///     S' = (1 - a) S + a diag(S),    a = sum over i != j of var(s_ij) / sum of s_ij^2
///
/// (Ledoit and Wolf, J. Multivariate Analysis 88(2), 2004, with the target of Schaefer and Strimmer, Stat. Appl. Genet.
/// Mol. Biol. 4(1), 2005.)
/// @param freedom  degrees of freedom of the rows: their count less what was fitted.
[[nodiscard]] Eigen::MatrixXd shrunkCovariance(const Eigen::MatrixXd& rows, double freedom);

}  // namespace haptolith

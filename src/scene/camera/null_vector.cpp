// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/null_vector.h"

#include <Eigen/Eigenvalues>

namespace ssdo {

std::vector<double> null_vector(const double* normal_matrix, int size) {
  const Eigen::Map<const Eigen::MatrixXd> matrix(normal_matrix, size, size);
  const Eigen::VectorXd x =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvectors().col(0);
  return {x.begin(), x.end()};
}

}  // namespace ssdo

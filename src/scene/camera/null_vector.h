// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace ssdo {

/// The unit vector x that makes |A x| least, from the `size` x `size` matrix A^T A: the eigenvector
/// of its smallest eigenvalue.
std::vector<double> null_vector(const double* normal_matrix, int size);

}  // namespace ssdo

#include "core/io/sequences/matrix_text.h"

#include <Eigen/LU>

#include "core/io/text_scanner.h"

namespace sonoloft {

Result<Eigen::Affine3d> parse_matrix(std::string_view text, const std::string& name) {
  TextScanner in(text, name);
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = in.real("a number of the matrix");
  if (!in.failed() && !in.at_end()) in.set_error(ErrorCode::parse_failed, "more than 16 numbers: mend the matrix");
  if (in.failed()) return in.failure();
  const Eigen::FullPivLU<Eigen::Matrix3d> axes(matrix.topLeftCorner<3, 3>());
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1) || !axes.isInvertible())
    return fail(ErrorCode::parse_failed, name + ": not the matrix of an affine map with an inverse: mend it");
  return Eigen::Affine3d(matrix);
}

}  // namespace sonoloft

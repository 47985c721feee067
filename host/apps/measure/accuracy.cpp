#include "host/apps/measure/accuracy.h"

#include "core/voxels/line_scan.h"
#include "host/apps/measure/distance.h"
#include "host/apps/measure/mesh_tree.h"

namespace sonoloft {
namespace {

constexpr double kMargin = 0.02, kBand = 0.01;  // of the diagonal
constexpr double kLargePiece = 1e-5;            // of the box with its margin

double enclosed_mm3(const IndexedMesh& mesh) {
  double volume = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = corners(mesh, t);
    const int outwards = (mesh.label_front[t] == kOutside) - (mesh.label_back[t] == kOutside);
    volume += outwards * a.dot(b.cross(c)) / 6;
  }
  return volume;
}

}  // namespace

Result<Accuracy> measure_accuracy(const IndexedMesh& mesh, std::span<const TrackedSlice> slices, const TrueBody& truth,
                                  int threads) {
  const auto box = used_box(truth.surface, "the true mesh");
  if (!box) return tl::unexpected<Error>(box.error());
  if (!(enclosed_mm3(truth.surface) > 0))
    return fail(
        ErrorCode::invalid_argument,
        "the true mesh encloses less than nothing: turn its triangles round, so that they are counter-clockwise "
        "seen from outside");
  const MeshTree tree(mesh), truth_tree(truth.surface);
  const auto label_at = [&](const Eigen::Vector3d& p) { return tree.label_at(p); };
  const auto true_label_at = [&](const Eigen::Vector3d& p) { return truth_tree.label_at(p); };
  const double diagonal_mm = box->diagonal().norm();
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kMargin * diagonal_mm);
  const Eigen::AlignedBox3d wide(box->min() - margin, box->max() + margin);
  return Accuracy{diagonal_mm,
                  agreement(wide, label_at, truth.label_at ? truth.label_at : true_label_at, threads),
                  surface_distance(mesh, truth.surface, threads),
                  count_pieces(mesh, kLargePiece * wide.volume()),
                  count_pieces(truth.surface, kLargePiece * wide.volume()),
                  compare_passage(normals_at_slices(mesh, slices, kBand * diagonal_mm),
                                  normals_at_slices(truth.surface, slices, kBand * diagonal_mm))};
}

std::vector<std::pair<std::string, double>> figures_of(const Accuracy& a) {
  return {{"iou", a.agreement.mean_iou()},
          {"mislabelled", a.agreement.mislabelled},
          {"mean_percent", 100 * a.distance.mean_mm / a.diagonal_mm},
          {"hausdorff_percent", 100 * a.distance.max_mm / a.diagonal_mm},
          {"pieces", static_cast<double>(a.pieces.all)},
          {"truth_pieces", static_cast<double>(a.truth_pieces.all)},
          {"large_pieces", static_cast<double>(a.pieces.large)},
          {"truth_large_pieces", static_cast<double>(a.truth_pieces.large)},
          {"genus", static_cast<double>(a.pieces.genus)},
          {"truth_genus", static_cast<double>(a.truth_pieces.genus)},
          {"turn_deg", a.passage.turn_deg},
          {"truth_turn_deg", a.passage.truth_turn_deg},
          {"crease_deg", a.passage.crease_deg},
          {"lean_deg", a.passage.lean_deg},
          {"turn_quarter_deg", a.passage.turn_quartiles_deg[0]},
          {"turn_median_deg", a.passage.turn_quartiles_deg[1]},
          {"turn_three_quarters_deg", a.passage.turn_quartiles_deg[2]},
          {"along_deg", a.passage.along_deg},
          {"truth_along_deg", a.passage.truth_along_deg}};
}

}  // namespace sonoloft

#include "tests/integration/igtl/printed.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

namespace sonoloft::test {
namespace {

/// What stands between the last "(" of a line and the ")" behind it.
std::string bracketed(const std::string& line) {
  const auto open = line.rfind('('), close = line.find(')', open);
  REQUIRE(close != std::string::npos);
  return line.substr(open + 1, close - open - 1);
}

PrintedTriangle turned(PrintedTriangle corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

/// "(0, 0, 1, 2)": the client prints the first corner twice.
std::array<std::size_t, 3> corners(const std::string& line) {
  std::istringstream numbers(bracketed(line));
  std::array<std::size_t, 3> corners;
  std::size_t again;
  char comma;
  numbers >> again >> comma >> corners[0] >> comma >> corners[1] >> comma >> corners[2];
  REQUIRE(!numbers.fail());
  CHECK(again == corners[0]);
  return corners;
}

std::string point_text(float x, float y, float z) {
  std::ostringstream text;  // with the digits that any stream prints
  text << x << ", " << y << ", " << z;
  return text.str();
}

}  // namespace

std::vector<PrintedSurface> surfaces_in(const std::string& printed) {
  std::vector<PrintedSurface> surfaces;
  std::vector<std::string> points;
  std::istringstream lines(printed);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("PolyData Contents") != std::string::npos) {
      surfaces.emplace_back();
      points.clear();
    } else if (line.starts_with("  point[")) {
      points.push_back(bracketed(line));
      surfaces.back().points = points.size();
    } else if (line.starts_with("  cell[")) {
      const auto [a, b, c] = corners(line);
      surfaces.back().triangles.insert(turned({points.at(a), points.at(b), points.at(c)}));
    } else if (line.starts_with("  data[")) {
      surfaces.back().labels.insert(bracketed(line));
      ++surfaces.back().labelled;
    }
  }
  return surfaces;
}

PrintedSurface expected(const IndexedMesh& mesh, Label label) {
  PrintedSurface surface;
  std::set<std::uint32_t> used;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.label_front[t] != label && mesh.label_back[t] != label) continue;
    PrintedTriangle texts;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f& p = mesh.positions[mesh.triangles[t][k]];
      texts[k] = point_text(-p.x(), -p.y(), p.z());
      used.insert(mesh.triangles[t][k]);
    }
    if (mesh.label_front[t] == label) std::swap(texts[0], texts[1]);
    surface.triangles.insert(turned(texts));
  }
  surface.points = surface.labelled = used.size();
  surface.labels = {std::to_string(label)};
  return surface;
}

std::vector<Eigen::Matrix4d> matrices_in(const std::string& printed) {
  const std::string announced = "Receiving TRANSFORM data type.\n=============\n", last_row = "\n0, 0, 0, 1\n";
  std::vector<Eigen::Matrix4d> matrices;
  for (auto at = printed.find(announced); at != std::string::npos; at = printed.find(announced, at)) {
    at += announced.size();
    const auto end = printed.find(last_row, at);
    if (end == std::string::npos) break;  // it is still printing
    std::string text = printed.substr(at, end + last_row.size() - at);
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream numbers(text);
    Eigen::Matrix4d matrix;
    for (double& value : matrix.reshaped<Eigen::RowMajor>()) numbers >> value;
    REQUIRE(!numbers.fail());
    matrices.push_back(matrix);
  }
  return matrices;
}

}  // namespace sonoloft::test

#include "core/slice/mask/mask_net.h"

#include <algorithm>
#include <cassert>

namespace sonoloft::mask {
namespace {

constexpr double kReach = 0.4;  // pixels; with the thinning, the centre of every pixel keeps its side
constexpr int kRounds = 40;
constexpr double kStep = 0.5;  // of each round: inwards, then as far outwards, which leaves what is wide as it is

class Builder {
 public:
  explicit Builder(const LabelMask& mask) : mask_(mask), above_(columns(), kNoVertex), row_(columns(), kNoVertex) {}

  MaskNet build() {
    for (std::int32_t y = 0; y <= mask_.height; ++y) {
      for (std::int32_t x = 0; x <= mask_.width; ++x) add_corner(x, y);
      std::swap(above_, row_);
    }
    return std::move(net_);
  }

 private:
  [[nodiscard]] std::size_t columns() const { return static_cast<std::size_t>(mask_.width) + 1; }

  [[nodiscard]] Label label(std::int32_t x, std::int32_t y) const {
    const bool inside = x >= 0 && y >= 0 && x < mask_.width && y < mask_.height;
    return inside ? mask_.labels[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask_.width) +
                                 static_cast<std::size_t>(x)]
                  : kOutside;
  }

  void add_corner(std::int32_t x, std::int32_t y) {
    const Label north_west = label(x - 1, y - 1), north_east = label(x, y - 1);
    const Label south_west = label(x - 1, y), south_east = label(x, y);
    std::uint32_t& here = row_[static_cast<std::size_t>(x)];
    here = kNoVertex;
    if (north_west == north_east && north_west == south_west && north_west == south_east) return;
    here = static_cast<std::uint32_t>(net_.vertices.size());
    // Rows go down: what is left of a border that goes east lies north of it.
    MaskNet::Vertex vertex{x,
                           y,
                           {},
                           {north_east, south_east, south_west, north_west},
                           0,
                           x == 0 || x == mask_.width,
                           y == 0 || y == mask_.height};
    vertex.to.fill(kNoVertex);
    net_.vertices.push_back(vertex);
    net_.position.emplace_back(x - 0.5, y - 0.5);
    if (north_west != north_east) join(here, kNorth, above_[static_cast<std::size_t>(x)]);
    if (north_west != south_west) join(here, kWest, row_[static_cast<std::size_t>(x) - 1]);
  }

  void join(std::uint32_t a, Direction direction, std::uint32_t b) {
    assert(b != kNoVertex);
    net_.vertices[a].to[direction] = b;
    net_.vertices[b].to[(direction + 2) % 4] = a;
    ++net_.vertices[a].degree;
    ++net_.vertices[b].degree;
  }

  const LabelMask& mask_;
  MaskNet net_;
  std::vector<std::uint32_t> above_, row_;
};

// Where a vertex is drawn to: the middle of its neighbours. Where four borders meet it stays.
Eigen::Vector2d middle_of_neighbours(const MaskNet& net, std::size_t v) {
  const MaskNet::Vertex& vertex = net.vertices[v];
  if (vertex.degree == 4) return net.position[v];
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const std::uint32_t to : vertex.to) {
    if (to != kNoVertex) sum += net.position[to];
  }
  return sum / vertex.degree;
}

void move_all(MaskNet& net, double step, std::vector<Eigen::Vector2d>& moved) {
  for (std::size_t v = 0; v < net.vertices.size(); ++v) {
    const MaskNet::Vertex& vertex = net.vertices[v];
    const Eigen::Vector2d corner(vertex.x - 0.5, vertex.y - 0.5);
    const Eigen::Vector2d reach(vertex.on_vertical_edge ? 0 : kReach, vertex.on_horizontal_edge ? 0 : kReach);
    const Eigen::Vector2d wanted = net.position[v] + step * (middle_of_neighbours(net, v) - net.position[v]);
    moved[v] = wanted.cwiseMax(corner - reach).cwiseMin(corner + reach);
  }
  std::swap(net.position, moved);
}

double distance_to_line(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 == 0 ? 0 : std::clamp((p - a).dot(along) / length2, 0.0, 1.0);
  return (p - a - t * along).norm();
}

// Borders from one end to the other, each taken once.
class Thinning {
 public:
  Thinning(const MaskNet& net, double tolerance)
      : net_(net), tolerance_(tolerance), needed_(net.vertices.size(), 0), taken_(net.vertices.size()) {}

  std::vector<char> run() {
    for (std::uint32_t v = 0; v < net_.vertices.size(); ++v) {
      if (is_end(v)) take_all_from(v);
    }
    for (std::uint32_t v = 0; v < net_.vertices.size(); ++v) take_all_from(v);  // borders without an end
    return std::move(needed_);
  }

 private:
  // Corners of the image are ends, so that they stay.
  [[nodiscard]] bool is_end(std::uint32_t v) const {
    const MaskNet::Vertex& vertex = net_.vertices[v];
    return vertex.degree != 2 || (vertex.on_vertical_edge && vertex.on_horizontal_edge);
  }

  void take_all_from(std::uint32_t v) {
    for (std::uint8_t d = 0; d < 4; ++d) {
      if (net_.vertices[v].to[d] == kNoVertex || taken_[v][d]) continue;
      follow(v, d);
      thin();
    }
  }

  // Fills line_ with the border that leaves v in that direction, up to its end or back to v.
  void follow(std::uint32_t v, std::uint8_t direction) {
    line_.assign(1, v);
    std::uint32_t at = v;
    do {
      const std::uint32_t next = net_.vertices[at].to[direction];
      const auto back = static_cast<std::uint8_t>((direction + 2) % 4);
      taken_[at][direction] = taken_[next][back] = true;
      line_.push_back(next);
      at = next;
      for (std::uint8_t d = 0; d < 4; ++d) {
        if (d != back && net_.vertices[at].to[d] != kNoVertex) direction = d;
      }
    } while (!is_end(at) && at != v);
  }

  void thin() {
    needed_[line_.front()] = needed_[line_.back()] = 1;
    spans_.assign(1, {0, line_.size() - 1});
    while (!spans_.empty()) {
      const auto [first, last] = spans_.back();
      spans_.pop_back();
      std::size_t farthest = first;
      double distance = tolerance_;
      for (std::size_t i = first + 1; i < last; ++i) {
        const double d = distance_to_line(at(i), at(first), at(last));
        if (d <= distance) continue;
        distance = d;
        farthest = i;
      }
      if (farthest == first) continue;
      needed_[line_[farthest]] = 1;
      spans_.push_back({first, farthest});
      spans_.push_back({farthest, last});
    }
  }

  [[nodiscard]] const Eigen::Vector2d& at(std::size_t i) const { return net_.position[line_[i]]; }

  const MaskNet& net_;
  const double tolerance_;
  std::vector<char> needed_;
  std::vector<std::array<bool, 4>> taken_;  ///< [#V] by direction
  std::vector<std::uint32_t> line_;
  std::vector<std::pair<std::size_t, std::size_t>> spans_;
};

}  // namespace

MaskNet make_net(const LabelMask& mask) {
  return Builder(mask).build();
}

void smooth(MaskNet& net) {
  std::vector<Eigen::Vector2d> moved(net.position.size());
  for (int round = 0; round < kRounds; ++round) {
    move_all(net, kStep, moved);
    move_all(net, -kStep, moved);
  }
}

std::vector<char> needed_vertices(const MaskNet& net, double tolerance) {
  return Thinning(net, tolerance).run();
}

}  // namespace sonoloft::mask

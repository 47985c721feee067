#include "core/methods/straight_skeleton/surface/assembly.h"

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <unordered_map>

#include "core/methods/straight_skeleton/surface/facet_net.h"
#include "core/slice/parallel.h"

namespace sonoloft::skeleton {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

struct NameHash {
  template <class Name>
  std::size_t operator()(const Name& name) const {
    std::uint64_t hash = 0;
    for (const Residue r : name) hash = (hash ^ r.value()) * 0x9E3779B97F4A7C15u;
    return hash ^ hash >> 32;
  }
};

class Assembler {
 public:
  Assembler(const Space& space, std::span<const Facet> facets, int threads)
      : space_(space), facets_(facets), threads_(threads) {}

  Assembly run() {
    make_nets();
    name_points();
    put_lines_in_order();
    std::vector<std::vector<NetTriangle>> triangles(nets_.size());
    for_each_net([&](std::size_t n) { triangles[n] = nets_[n]->triangles(); });
    name_vertices(triangles);
    for (std::size_t n = 0; n < nets_.size(); ++n) add(n, triangles[n]);
    return {std::move(out_), std::move(used_)};
  }

 private:
  template <class Visit>
  void for_each_net(const Visit& visit) {
    parallel_for(nets_.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n)
        if (nets_[n]) visit(n);
    });
  }

  void make_nets() {
    nets_.resize(facets_.size());
    parallel_for(facets_.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
      for (std::size_t f = first; f < last; ++f) {
        nets_[f].emplace(space_, facets_[f]);
        if (nets_[f]->is_plain()) nets_[f].reset();
      }
    });
  }

  void name_points() {
    std::unordered_map<std::array<Residue, 3>, std::uint32_t, NameHash> names;
    points_.resize(nets_.size());
    for (std::size_t n = 0; n < nets_.size(); ++n) {
      if (!nets_[n]) continue;
      for (const Corner& corner : nets_[n]->points) {
        const auto [place, is_new] = names.try_emplace(corner.name(), static_cast<std::uint32_t>(corners_.size()));
        if (is_new) corners_.push_back(corner);
        points_[n].push_back(place->second);
      }
    }
  }

  struct OrderedLine {
    std::size_t axis;
    std::vector<std::uint32_t> at{};  ///< corners
  };
  void put_lines_in_order() {
    std::unordered_map<LineName, std::uint32_t, NameHash> names;
    std::vector<OrderedLine> ordered;
    std::vector<std::vector<std::uint32_t>> line_of(nets_.size());  // [net, line]
    for (std::size_t n = 0; n < nets_.size(); ++n) {
      if (!nets_[n]) continue;
      const Form& support = *facets_[n].polygon.support;
      for (const FacetNet::Line& line : nets_[n]->lines) {
        const auto [place, is_new] =
            names.try_emplace(name_of_line(support, *line.form), static_cast<std::uint32_t>(ordered.size()));
        if (is_new) ordered.push_back({axis_of_line(support, *line.form)});
        line_of[n].push_back(place->second);
        for (const std::uint32_t p : line.at) ordered[place->second].at.push_back(points_[n][p]);
      }
    }
    for (OrderedLine& line : ordered) {
      std::ranges::sort(line.at);
      line.at.erase(std::unique(line.at.begin(), line.at.end()), line.at.end());
      std::ranges::sort(line.at, [&](std::uint32_t p, std::uint32_t q) {
        return is_before(corners_[p], corners_[q], line.axis, space_.box.doubt_mm);
      });
    }
    for (std::size_t n = 0; n < nets_.size(); ++n) {
      if (!nets_[n]) continue;
      std::unordered_map<std::uint32_t, std::uint32_t> local;
      for (std::uint32_t p = 0; p < points_[n].size(); ++p) local.emplace(points_[n][p], p);
      for (std::size_t l = 0; l < line_of[n].size(); ++l) extend(n, nets_[n]->lines[l], ordered[line_of[n][l]], local);
    }
  }
  /// Gives a line of a net all corners between its ends.
  void extend(std::size_t n, FacetNet::Line& line, const OrderedLine& whole,
              std::unordered_map<std::uint32_t, std::uint32_t>& local) {
    const auto place_of = [&](std::uint32_t p) {
      return static_cast<std::size_t>(std::ranges::find(whole.at, points_[n][p]) - whole.at.begin());
    };
    const std::pair<std::size_t, std::size_t> ends = std::minmax(place_of(line.at[0]), place_of(line.at[1]));
    line.at.clear();
    for (std::size_t i = ends.first; i <= ends.second; ++i) {
      const auto [place, is_new] = local.try_emplace(whole.at[i], static_cast<std::uint32_t>(nets_[n]->points.size()));
      if (is_new) {
        nets_[n]->points.push_back(corners_[whole.at[i]]);
        points_[n].push_back(whole.at[i]);
      }
      line.at.push_back(place->second);
    }
  }

  /// Vertices on slices come first, and those that are one place in doubles are one.
  void name_vertices(const std::vector<std::vector<NetTriangle>>& triangles) {
    std::vector<int> use(corners_.size(), 0);  // 1: between slices, 2: on one
    for (std::size_t n = 0; n < nets_.size(); ++n)
      for (const NetTriangle& t : triangles[n])
        for (const std::uint32_t p : t.corners) {
          int& of = use[points_[n][p]];
          if (of == 0) of = facets_[n].negative.distance().is_zero_at(nets_[n]->points[p]) ? 2 : 1;
        }
    vertices_.assign(corners_.size(), kNone);
    std::map<std::array<double, 3>, std::uint32_t> places;
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      if (use[c] != 2) continue;
      const Corner& corner = corners_[c];
      const Eigen::Vector3d p = canonical(corner.at());
      const auto [place, is_new] = places.try_emplace({p.x(), p.y(), p.z()}, vertex_count());
      vertices_[c] = place->second;
      if (is_new) out_.surfaces.positions.push_back(p);
    }
    out_.surfaces.on_slices = vertex_count();
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      if (use[c] != 1) continue;
      vertices_[c] = vertex_count();
      out_.surfaces.positions.push_back(corners_[c].rough);
    }
  }
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(out_.surfaces.positions.size()); }

  void add(std::size_t n, const std::vector<NetTriangle>& triangles) {
    if (triangles.empty()) return;
    used_.push_back(&facets_[n]);
    const std::uint32_t cell = cell_of(facets_[n]);
    for (const NetTriangle& t : triangles) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i) corners[i] = vertices_[points_[n][t.corners[i]]];
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      out_.surfaces.triangles.push_back(corners);
      out_.surfaces.label_front.push_back(t.front);
      out_.surfaces.label_back.push_back(t.back);
      out_.cell_of.push_back(cell);
    }
  }
  /// Facets that the same planes keep off the patches lie in one convex cell.
  std::uint32_t cell_of(const Facet& facet) {
    std::vector<std::array<Residue, 4>> planes;
    for (const FormPtr& f : facet.off)
      planes.push_back({f->c[0].residue, f->c[1].residue, f->c[2].residue, f->c[3].residue});
    std::ranges::sort(planes);
    planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
    const auto [place, is_new] = cells_.try_emplace(planes, static_cast<std::uint32_t>(out_.walls.size()));
    if (!is_new) return place->second;
    auto& walls = out_.walls.emplace_back();
    for (const FormPtr& f : facet.off) {
      const double size = f->rough.head<3>().norm();
      walls.emplace_back(f->rough.head<3>() / size, f->rough.w() / size);
    }
    return place->second;
  }

  const Space& space_;
  std::span<const Facet> facets_;
  int threads_;
  std::vector<std::optional<FacetNet>> nets_;       ///< [#facets]
  std::vector<std::vector<std::uint32_t>> points_;  ///< [net, point] corner
  std::deque<Corner> corners_;
  std::vector<std::uint32_t> vertices_;  ///< [#corners]
  std::map<std::vector<std::array<Residue, 4>>, std::uint32_t> cells_;
  JoinedCells out_;
  std::vector<const Facet*> used_;
};

}  // namespace

Assembly assemble(const Space& space, std::span<const Facet> facets, int threads) {
  return Assembler(space, facets, threads).run();
}

}  // namespace sonoloft::skeleton

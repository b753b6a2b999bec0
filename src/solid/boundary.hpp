// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where a mesh has holes, and the caps that close them.

#include "solid/edges.hpp"
#include "solid/polygon.hpp"

#include <Eigen/Core>

#include <cstdlib>
#include <numbers>
#include <utility>

namespace clearance {

// Caps over the holes of one body of a mesh: from the walks along its rim to triangles that close it.

/// Triangles over one hole. After inner sides cancel, their sides are the rim's.
struct cap {
  std::uint32_t body;
  std::vector<std::uint32_t> rim;
  polygon_triangles triangles;
  double off = 0;  ///< How far from the rim it lies where nothing is missing, metres.
};

namespace detail {

/// A hole in a cap's plane, as the end of a pipe with a wall has it: its rim and the one around it are one polygon.
class nested_rims {
 public:
  nested_rims(std::span<const Eigen::Vector3d> vertices, std::vector<std::vector<std::uint32_t>> rims,
              std::size_t& patience)
      : vertices_(vertices), patience_(patience) {
    for (auto& rim : rims) {
      const Eigen::Vector3d area = vector_area(vertices, rim);
      rims_.push_back({std::move(rim), area, 0});
      for (const std::uint32_t v : rims_.back().corners)
        rims_.back().size = std::max(rims_.back().size, (at(v) - at(rims_.back().corners[0])).norm());
    }
    std::stable_sort(rims_.begin(), rims_.end(), [](const flat& a, const flat& b) { return a.size > b.size; });
  }

  std::vector<std::vector<std::uint32_t>> joined() && {
    for (std::size_t inner = rims_.size(); inner-- > 1;)
      for (std::size_t outer = inner; outer-- > 0 && patience_ > 0; --patience_)
        if (holds(rims_[outer], rims_[inner])) {
          rims_[outer].corners = bridged(rims_[outer].corners, rims_[inner].corners);
          rims_[inner].corners.clear();
          break;
        }
    std::vector<std::vector<std::uint32_t>> polygons;
    for (flat& rim : rims_)
      if (!rim.corners.empty()) polygons.push_back(std::move(rim.corners));
    return polygons;
  }

 private:
  struct flat {
    std::vector<std::uint32_t> corners;
    Eigen::Vector3d area;
    double size;
  };
  const Eigen::Vector3d& at(std::uint32_t v) const { return vertices_[v]; }

  /// Do both lie in one plane, in opposite directions, one within the other?
  bool holds(const flat& outer, const flat& inner) {
    const double same_plane = 1e-3 * outer.size;
    if (!(outer.area.dot(inner.area) < -0.999 * outer.area.norm() * inner.area.norm())) return false;
    const std::size_t looks = outer.corners.size() * inner.corners.size();  // for a bridge
    if (looks >= patience_) return false;
    patience_ -= looks;
    const Eigen::Vector3d normal = outer.area.normalized(), origin = at(outer.corners[0]);
    for (const flat* rim : {&outer, &inner})
      for (const std::uint32_t v : rim->corners)
        if (!(std::abs((at(v) - origin).dot(normal)) <= same_plane)) return false;
    const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.cross(x), p = at(inner.corners[0]);
    bool within = false;
    for (std::size_t i = 0; i < outer.corners.size(); ++i) {
      const Eigen::Vector3d a = at(outer.corners[i]) - p, b = at(outer.corners[(i + 1) % outer.corners.size()]) - p;
      if ((a.dot(y) > 0) == (b.dot(y) > 0)) continue;
      if (a.dot(x) + (b.dot(x) - a.dot(x)) * a.dot(y) / (a.dot(y) - b.dot(y)) > 0) within = !within;
    }
    return within;
  }

  /// One polygon, along a bridge between the nearest corners and back.
  std::vector<std::uint32_t> bridged(const std::vector<std::uint32_t>& outer,
                                     const std::vector<std::uint32_t>& inner) const {
    double least = std::numeric_limits<double>::infinity();
    std::size_t i = 0, j = 0;
    for (std::size_t a = 0; a < outer.size(); ++a)
      for (std::size_t b = 0; b < inner.size(); ++b)
        if (const double d = (at(outer[a]) - at(inner[b])).squaredNorm(); d < least) {
          least = d;
          i = a;
          j = b;
        }
    std::vector<std::uint32_t> one(outer.begin(), outer.begin() + std::ptrdiff_t(i) + 1);
    for (std::size_t k = 0; k <= inner.size(); ++k) one.push_back(inner[(j + k) % inner.size()]);
    one.insert(one.end(), outer.begin() + std::ptrdiff_t(i), outer.end());
    return one;
  }

  std::span<const Eigen::Vector3d> vertices_;
  std::vector<flat> rims_;
  std::size_t& patience_;
};

/// How far do caps lie from where the surface is missing? There the winding number of the bodies as loaded is no
/// integer. With all their caps they are closed, so that of the caps alone is none there, either. A cap's own body is
/// asked, with those whose holes are beside it: two that meet in a seam have no surface missing but in the seam. Only
/// bent caps are asked about, where they are largest. One that `patience` does not reach counts as far off.
class stray_caps {
 public:
  /// `turned`: by body, whether it faces inwards.
  stray_caps(std::span<const Eigen::Vector3d> vertices, std::vector<cap>& caps, const std::vector<bool>& turned,
             std::size_t& patience)
      : vertices_(vertices), caps_(caps), turned_(turned), beside_(turned.size()), patience_(patience) {
    for (const cap& c : caps) {
      dipole& d = far_.emplace_back();
      d.area = vector_area(vertices, c.rim);
      for (const std::uint32_t v : c.rim) {
        d.middle += at(v) / double(c.rim.size());
        d.box.extend(at(v));
      }
      for (const std::uint32_t v : c.rim) d.radius = std::max(d.radius, (at(v) - d.middle).norm());
      size_ = std::max(size_, d.radius);
    }
  }

  void measure() {
    for (std::size_t k = 0; k < caps_.size(); ++k) {
      if (area_of(vertices_, caps_[k].triangles) <= nearly_flat * far_[k].area.norm()) continue;
      if (!find_beside(k)) {
        caps_[k].off = size_;
        continue;
      }
      polygon_triangles largest = caps_[k].triangles;
      const auto size = [&](const auto& t) { return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).squaredNorm(); };
      constexpr std::size_t most = 256;
      const std::size_t count = std::min(most, largest.size());
      std::partial_sort(largest.begin(), largest.begin() + std::ptrdiff_t(count), largest.end(),
                        [&](const auto& t, const auto& u) { return size(t) > size(u); });
      for (std::size_t i = 0; i < count; ++i) measure(caps_[k], largest[i]);
    }
  }

 private:
  struct dipole {
    Eigen::Vector3d area = Eigen::Vector3d::Zero(), middle = Eigen::Vector3d::Zero();
    double radius = 0;
    Eigen::AlignedBox3d box;
  };
  const Eigen::Vector3d& at(std::uint32_t v) const { return vertices_[v]; }

  /// All caps of the bodies that have a hole beside this one; false if patience ends.
  bool find_beside(std::size_t k) {
    if (!spend(caps_.size() / 4)) return false;
    std::fill(beside_.begin(), beside_.end(), false);
    for (std::size_t i = 0; i < caps_.size(); ++i)
      if (far_[i].box.intersects(far_[k].box)) beside_[caps_[i].body] = true;
    asked_.clear();
    for (std::size_t i = 0; i < caps_.size(); ++i)
      if (beside_[caps_[i].body]) asked_.push_back(i);
    return true;
  }
  void measure(cap& its, const std::array<std::uint32_t, 3>& t) {
    const Eigen::Vector3d &a = at(t[0]), &b = at(t[1]), &c = at(t[2]), normal = (b - a).cross(c - a);
    if (!(normal.norm() > 0)) return;
    const Eigen::Vector3d side = 1e-6 * size_ * normal.normalized();
    for (const auto& [u, v] : {std::pair{1 / 3.0, 1 / 3.0}, {0.1, 0.1}, {0.8, 0.1}, {0.1, 0.8}}) {
      const Eigen::Vector3d p = a + u * (b - a) + v * (c - a);
      const double far = spend(its.rim.size() + 2 * asked_.size()) ? to_rim(its, p) : size_;
      if (far > its.off && settled(p + side) && settled(p - side)) its.off = far;
    }
  }
  bool spend(std::size_t looks) {
    patience_ -= std::min(8 * looks, patience_);
    return patience_ > 0;
  }
  double to_rim(const cap& its, const Eigen::Vector3d& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < its.rim.size(); ++i) {
      const Eigen::Vector3d &a = at(its.rim[i]), e = at(its.rim[(i + 1) % its.rim.size()]) - a;
      const double along = e.squaredNorm() > 0 ? std::clamp((p - a).dot(e) / e.squaredNorm(), 0.0, 1.0) : 0;
      least = std::min(least, (p - a - along * e).norm());
    }
    return least;
  }
  bool settled(const Eigen::Vector3d& p) {
    double number = 0;
    for (const std::size_t k : asked_) {
      const Eigen::Vector3d r = far_[k].middle - p;
      double its = 0;
      if (const double d = r.norm(); d > 4 * far_[k].radius) {
        its = far_[k].area.dot(r) / (d * d * d) / (4 * std::numbers::pi);
      } else {
        if (!spend(caps_[k].triangles.size())) return true;
        for (const auto& t : caps_[k].triangles) its += winding_of(at(t[0]) - p, at(t[1]) - p, at(t[2]) - p);
      }
      number += turned_[caps_[k].body] ? -its : its;
    }
    constexpr double clearly = 0.1;
    return std::abs(number - std::round(number)) < clearly;
  }
  /// A triangle's part of the winding number at the origin (A. Van Oosterom and J. Strackee, 1983).
  static double winding_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const double x = a.norm(), y = b.norm(), z = c.norm();
    return std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y) /
           (2 * std::numbers::pi);
  }

  std::span<const Eigen::Vector3d> vertices_;
  std::vector<cap>& caps_;
  const std::vector<bool>& turned_;
  std::vector<bool> beside_;        // by body
  std::vector<std::size_t> asked_;  // caps
  std::vector<dipole> far_;         // what each cap looks like from afar
  double size_ = 0;
  std::size_t& patience_;
};

}  // namespace detail

/// Caps over all holes of one body, of about the least area that closes them. A rim and its reverse get the same
/// triangles, turned, so that two bodies that meet there leave nothing between their caps. `patience`: see
/// span_polygon.
inline void caps_over(std::span<const Eigen::Vector3d> vertices, std::uint32_t body,
                      std::vector<std::vector<std::uint32_t>> rims, std::size_t& patience, std::vector<cap>& caps) {
  for (auto& polygon : detail::nested_rims(vertices, std::move(rims), patience).joined()) {
    const std::size_t n = polygon.size(),
                      start = std::size_t(std::min_element(polygon.begin(), polygon.end()) - polygon.begin());
    const bool turned = polygon[(start + 1) % n] > polygon[(start + n - 1) % n];
    std::vector<std::uint32_t> walk(n);
    for (std::size_t i = 0; i < n; ++i) walk[i] = polygon[(turned ? start + n - i : start + i) % n];
    polygon_triangles triangles = span_polygon(vertices, walk, patience);
    if (turned)
      for (auto& t : triangles) std::swap(t[1], t[2]);
    caps.push_back({body, std::move(polygon), std::move(triangles)});
  }
}

/// How many more times a surface walks an edge from low to high than back; never 0.
struct boundary_edge {
  std::uint32_t low, high;
  std::int32_t excess;
};

/// The edges where the triangles' signed sides do not cancel. Without any, winding numbers are integers everywhere.
inline std::vector<boundary_edge> boundary(std::span<const edge_use> uses) {
  std::vector<boundary_edge> edges;
  for_each_edge(uses, [&](std::span<const edge_use> edge) {
    std::int32_t excess = 0;
    for (const edge_use& u : edge) excess += u.sign;
    if (excess != 0) edges.push_back({edge[0].low, edge[0].high, excess});
  });
  return edges;
}

/// The same for each body separately, one body after another.
struct body_rim {
  std::uint32_t body;
  std::vector<boundary_edge> edges;
};
inline std::vector<body_rim> boundaries(std::span<const edge_use> uses, std::span<const std::uint32_t> body) {
  std::vector<std::pair<std::uint32_t, boundary_edge>> all;
  std::vector<std::pair<std::uint32_t, std::int32_t>> signs;  // for one edge: bodies and the signs of their uses
  for_each_edge(uses, [&](std::span<const edge_use> edge) {
    signs.clear();
    for (const edge_use& u : edge) signs.emplace_back(body[u.triangle], u.sign);
    std::sort(signs.begin(), signs.end());
    for (std::size_t i = 0; i < signs.size();) {
      const std::uint32_t its = signs[i].first;
      std::int32_t excess = 0;
      for (; i < signs.size() && signs[i].first == its; ++i) excess += signs[i].second;
      if (excess != 0) all.push_back({its, {edge[0].low, edge[0].high, excess}});
    }
  });
  std::stable_sort(all.begin(), all.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
  std::vector<body_rim> rims;
  for (const auto& [b, edge] : all) {
    if (rims.empty() || rims.back().body != b) rims.push_back({b, {}});
    rims.back().edges.push_back(edge);
  }
  return rims;
}

/// Closed walks without repeated vertices. Together they walk each boundary edge `excess` times *against* the surface,
/// so a patch over each walk closes it. They always exist: as many sides enter a vertex as leave it. Where several
/// leave, a walk takes the one that turns back most sharply, because a crack's other side does.
inline std::vector<std::vector<std::uint32_t>> boundary_loops(std::span<const Eigen::Vector3d> places,
                                                              std::span<const boundary_edge> edges) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;  // from, to
  for (const boundary_edge& e : edges)
    for (std::int32_t k = 0; k < std::abs(e.excess); ++k)
      e.excess > 0 ? out.emplace_back(e.high, e.low) : out.emplace_back(e.low, e.high);
  std::sort(out.begin(), out.end());

  std::vector<std::uint32_t> vertices, begin;
  for (std::uint32_t i = 0; i < out.size(); ++i)
    if (i == 0 || out[i].first != out[i - 1].first) {
      vertices.push_back(out[i].first);
      begin.push_back(i);
    }
  const auto number = [&](std::uint32_t v) {
    return std::uint32_t(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin());
  };
  std::vector<std::uint32_t> next = begin;  // first unused side out of each vertex
  begin.push_back(std::uint32_t(out.size()));
  const auto cosine = [&](std::uint32_t back, std::uint32_t here, std::uint32_t on) {
    const Eigen::Vector3d u = places[back] - places[here], v = places[on] - places[here];
    return u.dot(v) / std::max(u.norm() * v.norm(), 1e-300);
  };
  const auto leave = [&](std::uint32_t here, const std::uint32_t* back) {
    const std::uint32_t end = begin[here + 1];
    std::uint32_t best = next[here];
    if (back != nullptr && end - best > 1 && end - best < 100)  // more than that is no crack
      for (std::uint32_t i = best + 1; i < end; ++i)
        if (cosine(*back, vertices[here], out[i].second) > cosine(*back, vertices[here], out[best].second)) best = i;
    std::swap(out[best], out[next[here]]);
    return number(out[next[here]++].second);
  };

  std::vector<std::vector<std::uint32_t>> loops;
  constexpr std::uint32_t absent = ~0u;
  std::vector<std::uint32_t> path, place(vertices.size(), absent);
  for (std::uint32_t start = 0; start < vertices.size(); ++start)
    while (next[start] < begin[start + 1]) {
      path.assign(1, start);
      place[start] = 0;
      while (!path.empty()) {
        const std::uint32_t here = path.back();
        if (next[here] == begin[here + 1]) {  // happens only at the start, when all its walks are cut off
          place[here] = absent;
          path.pop_back();
          continue;
        }
        const std::uint32_t to = leave(here, path.size() > 1 ? &vertices[path[path.size() - 2]] : nullptr);
        if (place[to] == absent) {
          place[to] = std::uint32_t(path.size());
          path.push_back(to);
          continue;
        }
        std::vector<std::uint32_t> loop;  // the walk meets itself: cut the loop off
        for (std::size_t i = place[to]; i < path.size(); ++i) loop.push_back(vertices[path[i]]);
        for (std::size_t i = place[to] + 1; i < path.size(); ++i) place[path[i]] = absent;
        path.resize(place[to] + 1);
        loops.push_back(std::move(loop));
      }
    }
  return loops;
}

}  // namespace clearance

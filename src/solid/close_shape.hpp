// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Closes one shape of a part: finds its bodies, welds cracks and caps holes.

#include <clearance/solid/close_mesh.hpp>
#include <clearance/solid/triangle_mesh.hpp>
#include "solid/boundary.hpp"
#include "solid/edges.hpp"
#include "solid/weld.hpp"

#include <Eigen/Geometry>

namespace clearance {

/// The connected surfaces of a mesh. An edge joins two triangles if exactly these two have it.
struct body_report {
  std::vector<std::uint32_t> body;  ///< By triangle; 0 for triangles that do not count.
  std::vector<bool> one_sided;      ///< By body: it cannot be oriented (a Moebius strip), so it stays as loaded.
  std::uint32_t flipped = 0;        ///< Triangles that were turned.
  double one_sided_area = 0;        ///< Square metres.
};

/// Finds the bodies. If `orient`, turns their triangles until neighbours agree: of a body's two orientations, the one
/// that covers more area stays.
template <class Counts>
body_report find_bodies(triangle_mesh& mesh, const Counts& counts, bool orient) {
  struct link {
    std::uint32_t to;
    bool agree;
  };
  const std::size_t n = mesh.triangles.size();
  const std::vector<edge_use> uses = edge_uses(mesh.triangles, counts);
  std::vector<std::array<link, 3>> links(n);
  std::vector<std::uint8_t> count(n, 0);
  for_each_edge(uses, [&](std::span<const edge_use> edge) {
    if (edge.size() != 2 || edge[0].triangle == edge[1].triangle) return;
    const bool agree = edge[0].sign != edge[1].sign;
    links[edge[0].triangle][count[edge[0].triangle]++] = {edge[1].triangle, agree};
    links[edge[1].triangle][count[edge[1].triangle]++] = {edge[0].triangle, agree};
  });

  body_report report;
  report.body.assign(n, 0);
  std::vector<std::int8_t> side(n, 0);
  std::vector<std::uint32_t> piece;
  for (std::uint32_t first = 0; first < n; ++first) {
    if (!counts[first] || side[first] != 0) continue;
    const auto number = std::uint32_t(report.one_sided.size());
    piece.assign(1, first);
    side[first] = 1;
    bool two_sided = true;
    double area[2] = {0, 0};  // as loaded, turned
    for (std::size_t next = 0; next < piece.size(); ++next) {
      const std::uint32_t i = piece[next];
      const auto& t = mesh.triangles[i];
      const Eigen::Vector3d& a = mesh.vertices[t[0]];
      report.body[i] = number;
      area[side[i] < 0] += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm() / 2;
      for (int k = 0; k < count[i]; ++k) {
        const link& l = links[i][k];
        const std::int8_t wanted = l.agree ? side[i] : std::int8_t(-side[i]);
        if (side[l.to] == 0) {
          side[l.to] = wanted;
          piece.push_back(l.to);
        }
        two_sided = two_sided && side[l.to] == wanted;
      }
    }
    report.one_sided.push_back(!two_sided);
    if (!two_sided) report.one_sided_area += area[0] + area[1];
    if (!two_sided || !orient) continue;
    const std::int8_t turn = area[1] > area[0] ? 1 : -1;
    for (const std::uint32_t i : piece)
      if (side[i] == turn) {
        std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
        ++report.flipped;
      }
  }
  return report;
}

/// Corners may be moved, and a cap may lie off its hole, by this part of a shape's size.
inline constexpr double most_moved = 2e-4;

/// One shape of a part, and how open its bodies are.
struct shape_surface {
  triangle_mesh mesh;
  std::vector<std::int8_t> counts;
  body_report bodies;
  std::vector<body_rim> rims;
  double rim_length = 0;          ///< Metres; an edge where several sides are missing counts that often.
  double moved = 0;               ///< The farthest that a corner was moved, or a cap lies off its hole, metres.
  polygon_triangles strays = {};  ///< Caps that are none: what a flood does not pass, but no surface.
  std::vector<bool> open = {};    ///< By body: some of its caps are astray, so it stays open.
};

/// Finds which triangles count, to which bodies they belong, and where these are open.
inline shape_surface open_surface(triangle_mesh mesh, const close_options& options) {
  shape_surface s{std::move(mesh), {}, {}, {}};
  s.counts = repeats(s.mesh.triangles).counts();
  s.bodies = find_bodies(s.mesh, s.counts, options.orient);
  s.rims = boundaries(edge_uses(s.mesh.triangles, s.counts), s.bodies.body);
  for (const body_rim& rim : s.rims)
    for (const boundary_edge& e : rim.edges)
      s.rim_length += std::abs(e.excess) * (s.mesh.vertices[e.high] - s.mesh.vertices[e.low]).norm();
  return s;
}

/// Faces that should meet often miss one another by rounding, or a little more. Welds open edges while that closes
/// them: first by 1e-9 of the shape's size, then by more, up to 2e-4.
inline shape_surface weld_cracks(shape_surface as_loaded, const close_options& options) {
  Eigen::AlignedBox3d box;
  for (const auto& v : as_loaded.mesh.vertices) box.extend(v);
  shape_surface best = as_loaded;
  for (const double part : {1e-9, 1e-7, 1e-5, most_moved}) {
    if (best.rims.empty()) break;
    std::vector<std::uint32_t> open;
    for (const body_rim& rim : as_loaded.rims)
      for (const boundary_edge& e : rim.edges) {
        open.push_back(e.low);
        open.push_back(e.high);
      }
    std::sort(open.begin(), open.end());
    open.erase(std::unique(open.begin(), open.end()), open.end());
    const double reach = part * box.diagonal().norm();
    triangle_mesh mesh = as_loaded.mesh;
    const std::size_t moved = weld_near(mesh, open, reach);
    if (moved == 0) continue;
    shape_surface welded = open_surface(std::move(mesh), options);
    // If edges merely shrink to nothing, no crack is closed.
    if (welded.rim_length + 4 * reach * double(moved) < best.rim_length) {
      best = std::move(welded);
      best.moved = reach;
    }
  }
  return best;
}

/// The signed volume of each body, cubic metres; meaningless for open bodies.
inline std::vector<double> body_volumes(const shape_surface& s) {
  std::vector<double> volumes(s.bodies.one_sided.size(), 0);
  std::vector<const Eigen::Vector3d*> about(volumes.size(), nullptr);
  for (std::size_t i = 0; i < s.mesh.triangles.size(); ++i) {
    if (!s.counts[i]) continue;
    const auto& t = s.mesh.triangles[i];
    const Eigen::Vector3d*& origin = about[s.bodies.body[i]];
    if (!origin) origin = &s.mesh.vertices[t[0]];
    const Eigen::Vector3d a = s.mesh.vertices[t[0]] - *origin, b = s.mesh.vertices[t[1]] - *origin,
                          c = s.mesh.vertices[t[2]] - *origin;
    volumes[s.bodies.body[i]] += a.dot(b.cross(c)) / 6;
  }
  return volumes;
}

/// Adds caps over all holes, after the triangles; each cap belongs to the body that it closes. A body with a cap that
/// lies astray stays open.
inline std::uint32_t add_caps(shape_surface& s, std::size_t& patience) {
  std::vector<cap> caps;
  for (const body_rim& rim : s.rims)
    caps_over(s.mesh.vertices, rim.body, boundary_loops(s.mesh.vertices, rim.edges), patience, caps);
  const std::size_t loaded = s.mesh.triangles.size();
  const auto add = [&s](const cap& c) {
    s.mesh.triangles.insert(s.mesh.triangles.end(), c.triangles.begin(), c.triangles.end());
    s.bodies.body.resize(s.mesh.triangles.size(), c.body);
    s.counts.resize(s.mesh.triangles.size(), 1);
  };
  for (const cap& c : caps) add(c);
  std::vector<bool> turned;
  for (const double volume : body_volumes(s)) turned.push_back(volume < 0);
  detail::stray_caps(s.mesh.vertices, caps, turned, patience).measure();

  s.mesh.triangles.resize(loaded);
  s.bodies.body.resize(loaded);
  s.counts.resize(loaded);
  s.open.assign(turned.size(), false);
  Eigen::AlignedBox3d box;
  for (const auto& v : s.mesh.vertices) box.extend(v);
  std::uint32_t holes = 0;
  for (const cap& c : caps)
    if (c.off > most_moved * box.diagonal().norm()) {
      s.strays.insert(s.strays.end(), c.triangles.begin(), c.triangles.end());
      s.open[c.body] = true;
    } else {
      s.moved = std::max(s.moved, c.off);
      add(c);
      ++holes;
    }
  return holes;
}

}  // namespace clearance

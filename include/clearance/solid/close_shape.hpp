// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/bodies.hpp>
#include <clearance/solid/boundary.hpp>
#include <clearance/solid/cap.hpp>
#include <clearance/solid/closed_mesh.hpp>
#include <clearance/solid/repeats.hpp>
#include <clearance/solid/weld.hpp>

namespace clearance {

/// One shape of a part, and how open its bodies are.
struct shape_surface {
  triangle_mesh mesh;
  std::vector<std::int8_t> counts;
  body_report bodies;
  std::vector<body_rim> rims;
  double rim_length = 0;  ///< Metres; an edge where several sides are missing counts that often.
  double moved = 0;       ///< The farthest that a corner was moved, metres.
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
  for (const double part : {1e-9, 1e-7, 1e-5, 2e-4}) {
    if (best.rims.empty()) break;
    std::vector<std::uint32_t> open;
    for (const body_rim& rim : as_loaded.rims)
      for (const boundary_edge& e : rim.edges) open.push_back(e.low), open.push_back(e.high);
    std::sort(open.begin(), open.end());
    open.erase(std::unique(open.begin(), open.end()), open.end());
    const double reach = part * box.diagonal().norm();
    triangle_mesh mesh = as_loaded.mesh;
    const std::size_t moved = weld_near(mesh, open, reach);
    if (moved == 0) continue;
    shape_surface welded = open_surface(std::move(mesh), options);
    // If edges merely shrink to nothing, no crack is closed.
    if (welded.rim_length + 4 * reach * double(moved) < best.rim_length) best = std::move(welded), best.moved = reach;
  }
  return best;
}

/// Adds caps over all open loops, after the triangles; each cap belongs to the body that it closes.
inline std::uint32_t add_caps(shape_surface& s) {
  std::uint32_t loops = 0;
  for (const body_rim& rim : s.rims)
    for (const auto& loop : boundary_loops(rim.edges)) {
      append_cap(s.mesh, loop);
      s.bodies.body.resize(s.mesh.triangles.size(), rim.body);
      ++loops;
    }
  s.counts.resize(s.mesh.triangles.size(), 1);
  return loops;
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

}  // namespace clearance

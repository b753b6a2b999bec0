// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/boundary.hpp>
#include <clearance/solid/cap.hpp>
#include <clearance/solid/orient.hpp>
#include <clearance/solid/weld.hpp>

#include <set>

namespace clearance {

struct close_options {
  bool orient = true;  ///< Turn triangles that disagree with their neighbours.
  bool cap = true;     ///< Close boundary loops. Without caps an open mesh has no certain inside.
};

struct cap_report {
  std::uint32_t loops = 0;
  double area = 0;  ///< Square metres.
};

/// What a part's surface is: its triangles as loaded, with equal vertices made one, and then its caps.
struct closed_mesh {
  triangle_mesh surface;     ///< Triangle i < loaded is triangle i of the input (perhaps turned); the rest are caps.
  std::uint32_t loaded = 0;
  /// By triangle: does it count to the winding number? All do, except second copies that lie on a surface which is
  /// closed without them (meshes that store each face once for each side).
  std::vector<bool> counts;
  bool closed = false;           ///< Winding numbers are whole everywhere.
  cap_report caps;
  std::uint32_t welded = 0;      ///< Vertices that were made one with an earlier one, or that no triangle used.
  std::uint32_t degenerate = 0;  ///< Triangles without area. Kept.
  std::uint32_t duplicate = 0;   ///< Triangles on the same vertices as an earlier one. Kept.
  std::uint32_t flipped = 0;     ///< Triangles that were turned to agree with their neighbours.
  double one_sided_area = 0;     ///< Area of pieces that have no two sides, such as a Moebius strip.
  double area = 0;               ///< Of all loaded triangles.
};

/// Closes a mesh as robots come with: open, badly oriented, not manifold, of several shells. Nothing is dropped; what was
/// found is counted. Throws std::invalid_argument for what is no mesh at all (see check_mesh).
inline closed_mesh close_mesh(const triangle_mesh& mesh, const close_options& options = {}) {
  check_mesh(mesh);
  closed_mesh out;
  out.surface = weld(mesh);
  auto& [vertices, triangles] = out.surface;
  out.loaded = std::uint32_t(triangles.size());
  out.welded = std::uint32_t(mesh.vertices.size() - vertices.size());

  std::vector<bool> all(triangles.size(), true), once(triangles.size(), true);
  std::set<std::array<std::uint32_t, 3>> known;
  const auto area = [&, &v = vertices](const std::array<std::uint32_t, 3>& t) {
    return (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]).norm() / 2;
  };
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    auto key = triangles[i];
    std::sort(key.begin(), key.end());
    const double a = area(triangles[i]);
    out.area += a;
    out.degenerate += !(a > 0);
    if (key[0] == key[1] || key[1] == key[2]) continue;
    once[i] = known.insert(key).second;
    out.duplicate += !once[i];
  }

  // Copies count only where the surface needs them to be closed. Their orientation is repaired only when they do not.
  triangle_mesh oriented = out.surface;
  orientation_report turned;
  if (options.orient) turned = orient(oriented, once);
  const auto open = [](const triangle_mesh& m, const std::vector<bool>& chosen) {
    return boundary(edge_uses(m.triangles, chosen));
  };
  out.counts = once;
  std::vector<boundary_edge> rim = open(oriented, once);
  if (!rim.empty() && out.duplicate > 0) {
    std::vector<boundary_edge> other = open(out.surface, all);
    if (other.size() < rim.size()) {
      rim = std::move(other);
      out.counts = all;
      oriented = out.surface;
      turned.flipped = 0;
    }
  }
  out.surface = std::move(oriented);
  out.flipped = turned.flipped;
  out.one_sided_area = turned.one_sided_area;

  out.closed = rim.empty();
  if (options.cap && !rim.empty()) {
    for (const auto& loop : boundary_loops(rim)) {
      append_cap(out.surface, loop);
      ++out.caps.loops;
    }
    for (std::size_t i = out.loaded; i < triangles.size(); ++i) out.caps.area += area(triangles[i]);
    out.counts.resize(triangles.size(), true);
    out.closed = true;
  }
  return out;
}

}  // namespace clearance

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/edges.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

namespace clearance {

struct orientation_report {
  std::uint32_t flipped = 0;   ///< Triangles that were turned.
  double one_sided_area = 0;   ///< Area of the pieces that cannot be oriented, such as a Moebius strip; left as they are.
};

/// Turns triangles until neighbours (the two triangles of an edge that has two) agree, piece by piece. Of a piece's two
/// orientations that is kept which most of its area has, so a cavity stays a cavity.
inline orientation_report orient(triangle_mesh& mesh, const std::vector<bool>& chosen) {
  struct link {
    std::uint32_t to;
    bool agree;
  };
  const std::vector<edge_use> uses = edge_uses(mesh.triangles, chosen);
  std::vector<std::array<link, 3>> links(mesh.triangles.size());
  std::vector<std::uint8_t> count(mesh.triangles.size(), 0);
  for_each_edge(uses, [&](std::span<const edge_use> edge) {
    if (edge.size() != 2 || edge[0].triangle == edge[1].triangle) return;
    const bool agree = edge[0].sign != edge[1].sign;
    links[edge[0].triangle][count[edge[0].triangle]++] = {edge[1].triangle, agree};
    links[edge[1].triangle][count[edge[1].triangle]++] = {edge[0].triangle, agree};
  });

  orientation_report report;
  std::vector<std::int8_t> side(mesh.triangles.size(), 0);
  std::vector<std::uint32_t> piece;
  for (std::uint32_t first = 0; first < mesh.triangles.size(); ++first) {
    if (!chosen[first] || side[first] != 0) continue;
    piece.assign(1, first);
    side[first] = 1;
    bool two_sided = true;
    double area[2] = {0, 0};  // as loaded, turned
    for (std::size_t next = 0; next < piece.size(); ++next) {
      const std::uint32_t i = piece[next];
      const auto& t = mesh.triangles[i];
      const Eigen::Vector3d& a = mesh.vertices[t[0]];
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
    if (!two_sided) {
      report.one_sided_area += area[0] + area[1];
      continue;
    }
    const std::int8_t turn = area[1] > area[0] ? 1 : -1;
    for (const std::uint32_t i : piece)
      if (side[i] == turn) std::swap(mesh.triangles[i][1], mesh.triangles[i][2]), ++report.flipped;
  }
  return report;
}

}  // namespace clearance

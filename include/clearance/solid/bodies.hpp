// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/edges.hpp>
#include <clearance/solid/triangle_mesh.hpp>

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
      if (side[i] == turn) std::swap(mesh.triangles[i][1], mesh.triangles[i][2]), ++report.flipped;
  }
  return report;
}

}  // namespace clearance

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Cleans a mesh before it is closed: joins corners, finds repeated triangles, and refuses what is no mesh.

#include <clearance/solid/triangle_mesh.hpp>
#include "solid/edges.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <unordered_set>

namespace clearance {

/// Finds triangles that lie on others: meshes store faces once per side, in any order, and quads along either diagonal.
class repeats {
 public:
  using triangle = std::array<std::uint32_t, 3>;

  explicit repeats(std::span<const triangle> triangles) : triangles_(triangles), counts_(triangles.size(), 1) {
    copies();
    quads();
  }

  /// By triangle: 1, or 0 if it repeats others or has a corner twice.
  const std::vector<std::int8_t>& counts() const { return counts_; }

 private:
  struct hash {
    std::size_t operator()(const triangle& key) const {
      std::uint64_t h = 0;
      for (const std::uint32_t v : key) {
        h = (h ^ v) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
      }
      return h;
    }
  };
  static triangle sorted(triangle key) {
    std::sort(key.begin(), key.end());
    return key;
  }
  static bool corner_twice(const triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

  void copies() {
    std::unordered_set<triangle, hash> known;
    for (std::size_t i = 0; i < triangles_.size(); ++i)
      counts_[i] = !corner_twice(triangles_[i]) && known.insert(sorted(triangles_[i])).second;
  }

  /// Two triangles beside a diagonal cover a quad. Others on three of its corners, along the other diagonal, do not
  /// count. All other sides must belong to further triangles as well, so a tetrahedron, which looks alike, stays.
  void quads() {
    const std::vector<edge_use> uses = edge_uses(triangles_, counts_);
    std::vector<std::uint8_t> free_sides(triangles_.size(), 0);  // with one or two uses
    for_each_edge(uses, [&](std::span<const edge_use> edge) {
      if (edge.size() <= 2)
        for (const edge_use& u : edge) ++free_sides[u.triangle];
    });
    const auto fits = [&](std::uint32_t i) { return free_sides[i] == 1 && !corner_twice(triangles_[i]); };
    const auto opposite = [&](const edge_use& u) {
      const triangle& t = triangles_[u.triangle];
      return t[0] != u.low && t[0] != u.high ? t[0] : t[1] != u.low && t[1] != u.high ? t[1] : t[2];
    };
    std::unordered_map<triangle, std::uint32_t, hash> covered;  // three corners of a quad, and its first triangle
    std::vector<std::uint32_t> own(triangles_.size(), ~0u);
    for_each_edge(uses, [&](std::span<const edge_use> edge) {
      if (edge.size() != 2 || !fits(edge[0].triangle) || !fits(edge[1].triangle)) return;
      const std::uint32_t a = opposite(edge[0]), b = opposite(edge[1]),
                          first = std::min(edge[0].triangle, edge[1].triangle);
      if (a == b) return;
      for (const edge_use& u : edge) own[u.triangle] = first;
      for (const std::uint32_t c : {edge[0].low, edge[0].high}) {
        const auto [at, is_new] = covered.try_emplace(sorted(triangle{a, b, c}), first);
        if (!is_new) at->second = std::min(at->second, first);
      }
    });
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      if (!counts_[i] || !fits(i)) continue;
      const auto at = covered.find(sorted(triangles_[i]));
      if (at != covered.end() && at->second < own[i]) counts_[i] = 0;
    }
  }

  std::span<const triangle> triangles_;
  std::vector<std::int8_t> counts_;
};

/// Throws std::invalid_argument with the number of the vertex, triangle or shape, if this is no mesh: no triangles, an
/// index out of range, a coordinate that is not finite or beyond 1e15, no triangle with an area, or shapes that are not
/// all triangles in their order.
inline void check_mesh(const triangle_mesh& mesh) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("clearance: the mesh " + why); };
  if (mesh.triangles.empty()) refuse("has no triangles");
  check_corners(mesh);
  bool area = false;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    area = area || (b - a).cross(c - a).squaredNorm() > 0;
  }
  for (std::size_t k = 0; k < mesh.shapes.size(); ++k) {
    const std::uint32_t first = mesh.shapes[k];
    if (k == 0 ? first != 0 : first < mesh.shapes[k - 1] || first > mesh.triangles.size())
      refuse("has shapes that are not all its " + std::to_string(mesh.triangles.size()) +
             " triangles in their order: shape " + std::to_string(k) + " begins with triangle " +
             std::to_string(first));
  }
  if (!area) refuse("is degenerate: none of its " + std::to_string(mesh.triangles.size()) + " triangles has an area");
}

/// Merges vertices with equal coordinates into the first of them; 0 and -0 are equal. Keeps their order, and drops
/// vertices that no triangle uses.
inline triangle_mesh weld(const triangle_mesh& mesh) {
  struct hash {
    std::size_t operator()(const Eigen::Vector3d& v) const {
      std::uint64_t h = 0;
      for (int k = 0; k < 3; ++k) {
        h = (h ^ std::bit_cast<std::uint64_t>(v[k] + 0.0)) * 0x9e3779b97f4a7c15u;  // -0.0 + 0.0 is 0.0
        h ^= h >> 29;
      }
      return h;
    }
  };
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  triangle_mesh welded{{}, mesh.triangles};
  std::unordered_map<Eigen::Vector3d, std::uint32_t, hash> known;
  std::vector<std::uint32_t> number(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!used[i]) continue;
    const auto [place, is_new] = known.try_emplace(mesh.vertices[i], std::uint32_t(welded.vertices.size()));
    if (is_new) welded.vertices.push_back(mesh.vertices[i]);
    number[i] = place->second;
  }
  for (auto& t : welded.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return welded;
}

/// Merges those of these vertices that are within `reach` metres of an earlier one; returns how many. Each is compared
/// with the first of its group, so a row of close ones does not shrink to a point.
inline std::size_t weld_near(triangle_mesh& mesh, std::span<const std::uint32_t> vertices, double reach) {
  struct cell_hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& cell) const {
      std::uint64_t h = 0;
      for (const std::int64_t c : cell) {
        h = (h ^ std::uint64_t(c)) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
      }
      return h;
    }
  };
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<std::uint32_t>, cell_hash> kept;
  std::vector<std::uint32_t> number(mesh.vertices.size());
  std::iota(number.begin(), number.end(), 0u);
  std::size_t moved = 0;
  for (const std::uint32_t v : vertices) {
    const Eigen::Vector3d &p = mesh.vertices[v], at = (p - mesh.vertices[vertices[0]]) / reach;
    const std::array<std::int64_t, 3> cell{std::llround(at.x()), std::llround(at.y()), std::llround(at.z())};
    const std::uint32_t* found = nullptr;
    for (int k = 0; k < 27 && !found; ++k)
      if (const auto near = kept.find({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
          near != kept.end())
        for (const std::uint32_t& other : near->second)
          if ((mesh.vertices[other] - p).norm() <= reach && !found) found = &other;
    if (found) {
      number[v] = *found;
      ++moved;
    } else
      kept[cell].push_back(v);
  }
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return moved;
}

}  // namespace clearance

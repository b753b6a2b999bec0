// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/edges.hpp>

#include <algorithm>
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
      for (const std::uint32_t v : key) h = (h ^ v) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
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

}  // namespace clearance

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The edges of a mesh, and the triangles on either side.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace clearance {

/// A triangle's side between vertices low < high; `sign` is +1 if the triangle walks from low to high, else -1.
struct edge_use {
  std::uint32_t low, high, triangle;
  std::int32_t sign;
};

/// All sides of the triangles that count (`counts[i]` is not 0), those of one edge side by side. Leaves out sides from
/// a vertex to itself.
template <class Counts>
std::vector<edge_use> edge_uses(std::span<const std::array<std::uint32_t, 3>> triangles, const Counts& counts) {
  std::vector<edge_use> uses;
  uses.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (!counts[i]) continue;
    const auto& t = triangles[i];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t u = t[k], v = t[(k + 1) % 3];
      if (u < v) uses.push_back({u, v, i, 1});
      if (v < u) uses.push_back({v, u, i, -1});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const edge_use& a, const edge_use& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
  });
  return uses;
}

/// Calls `visit(uses)` once for each edge, with all its uses.
template <class F>
void for_each_edge(std::span<const edge_use> uses, F visit) {
  for (std::size_t i = 0, j; i < uses.size(); i = j) {
    for (j = i; j < uses.size() && uses[j].low == uses[i].low && uses[j].high == uses[i].high;) ++j;
    visit(uses.subspan(i, j - i));
  }
}

}  // namespace clearance

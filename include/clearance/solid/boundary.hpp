// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/edges.hpp>

#include <cstdlib>
#include <utility>

namespace clearance {

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
/// so a patch over each walk closes it. They always exist: as many sides enter a vertex as leave it.
inline std::vector<std::vector<std::uint32_t>> boundary_loops(std::span<const boundary_edge> edges) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;  // from, to
  for (const boundary_edge& e : edges)
    for (std::int32_t k = 0; k < std::abs(e.excess); ++k)
      e.excess > 0 ? out.emplace_back(e.high, e.low) : out.emplace_back(e.low, e.high);
  std::sort(out.begin(), out.end());

  std::vector<std::uint32_t> vertices, begin;
  for (std::uint32_t i = 0; i < out.size(); ++i)
    if (i == 0 || out[i].first != out[i - 1].first) vertices.push_back(out[i].first), begin.push_back(i);
  const auto number = [&](std::uint32_t v) {
    return std::uint32_t(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin());
  };
  std::vector<std::uint32_t> next = begin;  // first unused side out of each vertex
  begin.push_back(std::uint32_t(out.size()));

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
        const std::uint32_t to = number(out[next[here]++].second);
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

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/host.hpp>
#include <clearance/solid/close_mesh.hpp>
#include <clearance/solid/winding_view.hpp>


namespace clearance {

/// Owns what a winding view reads, in the memory of backend B. Immutable once made.
template <class T, backend B = host>
struct basic_winding {
  template <class U>
  using buffer = typename B::template buffer<U>;

  buffer<crossing_triangle<T>> triangles;
  buffer<std::uint32_t> cells;  ///< First of each cell's list, and the end of the last.
  buffer<std::uint32_t> lists;
  basic_winding_view<T> grid = {};  ///< Its pointers are set by `view()`.

  basic_winding_view<T> view() const {
    basic_winding_view<T> v = grid;
    v.triangles = triangles.data(), v.begin = cells.data(), v.lists = lists.data();
    return v;
  }

  /// A copy of a host owner where `other` runs.
  template <backend Other>
  basic_winding<T, Other> on(const Other& other) const {
    return {other.copy_in(std::span<const crossing_triangle<T>>(triangles)),
            other.copy_in(std::span<const std::uint32_t>(cells)), other.copy_in(std::span<const std::uint32_t>(lists)), grid};
  }
};

/// The inside of a part: float coordinates, for queries.
template <backend B = host>
using winding = basic_winding<real, B>;

/// Makes the test for points inside a mesh. Coordinates are rounded to T, which is all that is lost. Throws
/// std::invalid_argument if the mesh is not closed, or if T cannot hold a coordinate.
template <class T = real>
basic_winding<T> make_winding(const closed_mesh& mesh) {
  if (!mesh.closed) throw std::invalid_argument("clearance: an open mesh has no inside; close it with caps");
  basic_winding<T> w;
  basic_winding_view<T>& g = w.grid;
  for (int k = 0; k < 3; ++k) g.low[k] = std::numeric_limits<T>::infinity(), g.high[k] = -std::numeric_limits<T>::infinity();
  for (std::size_t i = 0; i < mesh.surface.triangles.size(); ++i) {
    const auto& corners = mesh.surface.triangles[i];
    if (!mesh.counts[i] || corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    crossing_triangle<T>& t = w.triangles.emplace_back();
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const T x = t.v[j][k] = T(mesh.surface.vertices[corners[j]][k]);
        g.low[k] = std::min(g.low[k], x), g.high[k] = std::max(g.high[k], x);
      }
  }
  if (w.triangles.empty()) throw std::invalid_argument("clearance: no triangle of the mesh has an area");

  // About as many cells as triangles, nearly square ones; flat extents get one row or column. Fewer where large
  // triangles, one over another, would fill the lists.
  const double y = double(g.high[1]) - g.low[1], z = double(g.high[2]) - g.low[2];
  const auto divide_into = [&](double wanted) {
    const auto along = [&](double here, double there) {
      if (!(here > 0)) return 1.0;
      return std::clamp(std::ceil(there > 0 ? std::sqrt(wanted * here / there) : 256.0), 1.0, 1024.0);
    };
    const auto per = [](double count, double extent) {
      const double p = extent > 0 ? count / extent : 0;
      return T(p <= double(std::numeric_limits<T>::max()) ? p : 0);  // an extent near the smallest number: one cell is used
    };
    g.columns = std::uint32_t(along(y, z)), g.rows = std::uint32_t(along(z, y));
    g.per_y = per(g.columns, y), g.per_z = per(g.rows, z);
  };
  struct rectangle {
    std::uint32_t left, right, below, above;
  };
  const auto covered = [&](const crossing_triangle<T>& t) {
    const auto& v = t.v;
    return rectangle{g.column(std::min({v[0][1], v[1][1], v[2][1]})), g.column(std::max({v[0][1], v[1][1], v[2][1]})),
                     g.row(std::min({v[0][2], v[1][2], v[2][2]})), g.row(std::max({v[0][2], v[1][2], v[2][2]}))};
  };
  for (double wanted = std::clamp(double(w.triangles.size()), 1.0, 65536.0); wanted >= 1; wanted /= 4) {
    divide_into(wanted);
    double total = 0;
    for (const auto& t : w.triangles) {
      const rectangle r = covered(t);
      total += double(r.right - r.left + 1) * (r.above - r.below + 1);
    }
    if (total <= 1e6 + 64 * double(w.triangles.size())) break;
  }

  // A cell that lies beyond one side of a triangle is left out; inflated, since a point's cell is computed in T.
  const double cell_y = y / g.columns, cell_z = z / g.rows;
  const double half_y = cell_y / 2 + 8 * double(std::numeric_limits<T>::epsilon()) * y;
  const double half_z = cell_z / 2 + 8 * double(std::numeric_limits<T>::epsilon()) * z;
  const auto misses = [&](const crossing_triangle<T>& t, std::uint32_t column, std::uint32_t row) {
    const double mid_y = (column + 0.5) * cell_y, mid_z = (row + 0.5) * cell_z;
    for (int j = 0; j < 3; ++j) {
      const T(&a)[3] = t.v[j], (&b)[3] = t.v[(j + 1) % 3], (&c)[3] = t.v[(j + 2) % 3];
      const double ny = double(a[2]) - b[2], nz = double(b[1]) - a[1];
      const double reach = (std::abs(ny) * half_y + std::abs(nz) * half_z) * (1 + 1e-9);
      const double cell = ny * (mid_y - (double(a[1]) - g.low[1])) + nz * (mid_z - (double(a[2]) - g.low[2]));
      const double corner = ny * (double(c[1]) - a[1]) + nz * (double(c[2]) - a[2]);
      if (corner >= 0 ? cell < -reach : cell > reach) return true;
    }
    return false;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // cell, triangle
  for (std::uint32_t i = 0; i < w.triangles.size(); ++i) {
    const rectangle r = covered(w.triangles[i]);
    const bool one = r.left == r.right && r.below == r.above;
    for (std::uint32_t row = r.below; row <= r.above; ++row)
      for (std::uint32_t column = r.left; column <= r.right; ++column)
        if (one || !misses(w.triangles[i], column, row)) entries.emplace_back(row * g.columns + column, i);
  }
  const auto reach = [&](std::uint32_t i) {
    return std::max({w.triangles[i].v[0][0], w.triangles[i].v[1][0], w.triangles[i].v[2][0]});
  };
  std::sort(entries.begin(), entries.end(), [&](const auto& a, const auto& b) {
    if (a.first != b.first) return a.first < b.first;
    const T p = reach(a.second), q = reach(b.second);
    return p != q ? p > q : a.second < b.second;
  });
  w.cells.assign(std::size_t(g.columns) * g.rows + 1, 0);
  w.lists.reserve(entries.size());
  for (const auto& [cell, triangle] : entries) ++w.cells[cell + 1], w.lists.push_back(triangle);
  for (std::size_t i = 1; i < w.cells.size(); ++i) w.cells[i] += w.cells[i - 1];
  return w;
}

}  // namespace clearance

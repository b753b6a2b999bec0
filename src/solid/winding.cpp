// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/solid/winding.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace clearance {

namespace detail {

/// The grid over (y, z) of a winding test, with the triangles over each cell.
template <class T>
class winding_grid {
 public:
  explicit winding_grid(basic_winding<T>& w)
      : w_(w), g_(w.grid), y_(double(g_.high[1]) - g_.low[1]), z_(double(g_.high[2]) - g_.low[2]) {
    choose_cells();
    fill_lists();
  }

 private:
  struct rectangle {
    std::uint32_t left, right, below, above;
  };

  /// About as many cells as triangles, nearly square. A flat extent gets one row or column. Fewer cells if large
  /// triangles above one another would fill the lists.
  void choose_cells() {
    for (double wanted = std::clamp(double(w_.triangles.size()), 1.0, 65536.0); wanted >= 1; wanted /= 4) {
      divide_into(wanted);
      double total = 0;
      for (const auto& t : w_.triangles) {
        const rectangle r = covered(t);
        total += double(r.right - r.left + 1) * (r.above - r.below + 1);
      }
      if (total <= 1e6 + 64 * double(w_.triangles.size())) break;
    }
  }
  void divide_into(double wanted) {
    const auto along = [&](double here, double there) {
      if (!(here > 0)) return 1.0;
      return std::clamp(std::ceil(there > 0 ? std::sqrt(wanted * here / there) : 256.0), 1.0, 1024.0);
    };
    const auto per = [](double count, double extent) {
      const double p = extent > 0 ? count / extent : 0;
      return T(p <= double(std::numeric_limits<T>::max()) ? p : 0);  // near the smallest number: one cell
    };
    g_.columns = std::uint32_t(along(y_, z_));
    g_.rows = std::uint32_t(along(z_, y_));
    g_.per_y = per(g_.columns, y_);
    g_.per_z = per(g_.rows, z_);
  }
  rectangle covered(const crossing_triangle<T>& t) const {
    const auto& v = t.v;
    return rectangle{g_.column(std::min({v[0][1], v[1][1], v[2][1]})), g_.column(std::max({v[0][1], v[1][1], v[2][1]})),
                     g_.row(std::min({v[0][2], v[1][2], v[2][2]})), g_.row(std::max({v[0][2], v[1][2], v[2][2]}))};
  }

  /// Is the cell beyond one side of the triangle? It is inflated first, because a point's cell is computed in T.
  bool misses(const crossing_triangle<T>& t, std::uint32_t column, std::uint32_t row) const {
    const double cell_y = y_ / g_.columns, cell_z = z_ / g_.rows;
    const double half_y = cell_y / 2 + 8 * double(std::numeric_limits<T>::epsilon()) * y_;
    const double half_z = cell_z / 2 + 8 * double(std::numeric_limits<T>::epsilon()) * z_;
    const double mid_y = (column + 0.5) * cell_y, mid_z = (row + 0.5) * cell_z;
    for (int j = 0; j < 3; ++j) {
      const T(&a)[3] = t.v[j], (&b)[3] = t.v[(j + 1) % 3], (&c)[3] = t.v[(j + 2) % 3];
      const double ny = double(a[2]) - b[2], nz = double(b[1]) - a[1];
      const double reach = (std::abs(ny) * half_y + std::abs(nz) * half_z) * (1 + 1e-9);
      const double cell = ny * (mid_y - (double(a[1]) - g_.low[1])) + nz * (mid_z - (double(a[2]) - g_.low[2]));
      const double corner = ny * (double(c[1]) - a[1]) + nz * (double(c[2]) - a[2]);
      if (corner >= 0 ? cell < -reach : cell > reach) return true;
    }
    return false;
  }

  void fill_lists() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // cell, triangle
    for (std::uint32_t i = 0; i < w_.triangles.size(); ++i) {
      const rectangle r = covered(w_.triangles[i]);
      const bool one = r.left == r.right && r.below == r.above;
      for (std::uint32_t row = r.below; row <= r.above; ++row)
        for (std::uint32_t column = r.left; column <= r.right; ++column)
          if (one || !misses(w_.triangles[i], column, row)) entries.emplace_back(row * g_.columns + column, i);
    }
    const auto reach = [&](std::uint32_t i) {
      return std::max({w_.triangles[i].v[0][0], w_.triangles[i].v[1][0], w_.triangles[i].v[2][0]});
    };
    std::sort(entries.begin(), entries.end(), [&](const auto& a, const auto& b) {
      if (a.first != b.first) return a.first < b.first;
      const T p = reach(a.second), q = reach(b.second);
      return p != q ? p > q : a.second < b.second;
    });
    w_.cells.assign(std::size_t(g_.columns) * g_.rows + 1, 0);
    w_.lists.reserve(entries.size());
    for (const auto& [cell, triangle] : entries) {
      ++w_.cells[cell + 1];
      w_.lists.push_back(triangle);
    }
    for (std::size_t i = 1; i < w_.cells.size(); ++i) w_.cells[i] += w_.cells[i - 1];
  }

  basic_winding<T>& w_;
  basic_winding_view<T>& g_;
  double y_, z_;
};

}  // namespace detail

template <class T>
basic_winding<T> make_winding(const closed_mesh& mesh, std::vector<std::uint32_t>* bodies) {
  check(mesh);
  if (!mesh.closed) throw std::invalid_argument("clearance: an open mesh has no inside; close it with caps");
  basic_winding<T> w;
  basic_winding_view<T>& g = w.grid;
  for (int k = 0; k < 3; ++k) {
    g.low[k] = std::numeric_limits<T>::infinity();
    g.high[k] = -std::numeric_limits<T>::infinity();
  }
  for (std::size_t i = 0; i < mesh.surface.triangles.size(); ++i) {
    auto corners = mesh.surface.triangles[i];
    if (!mesh.counts[i] || corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    if (mesh.counts[i] < 0) std::swap(corners[1], corners[2]);
    crossing_triangle<T>& t = w.triangles.emplace_back();
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const T x = t.v[j][k] = T(mesh.surface.vertices[corners[j]][k]);
        g.low[k] = std::min(g.low[k], x);
        g.high[k] = std::max(g.high[k], x);
      }
    if (bodies) bodies->push_back(mesh.body[i]);
  }
  if (!w.triangles.empty()) {
    detail::winding_grid<T> made(w);
  } else {
    w.cells = {0, 0};  // never looked at, because no point is between low and high
  }
  w.enclosed = mesh.enclosed.packed<T>();
  return w;
}

template basic_winding<float> make_winding(const closed_mesh&, std::vector<std::uint32_t>*);
template basic_winding<double> make_winding(const closed_mesh&, std::vector<std::uint32_t>*);

}  // namespace clearance

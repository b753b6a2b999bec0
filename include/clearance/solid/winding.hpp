// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is a point inside a closed mesh, and how much does the mesh enclose? Rays count how often the surface winds round.

#include <clearance/backends/host.hpp>
#include <clearance/ground/config.hpp>
#include <clearance/ground/math.hpp>
#include <clearance/solid/closed_mesh.hpp>
#include <clearance/solid/enclosure.hpp>

#include <cmath>
#include <stdexcept>

namespace clearance {

/// A triangle of a closed surface, as the crossing rule reads it.
template <class T>
struct crossing_triangle {
  T v[3][3];
};

namespace crossing {

/// A fused product and sum: rounded once, on host and device alike.
CLEARANCE_HD inline double fused(double a, double b, double c) {
#if defined(__CUDA_ARCH__)
  return __fma_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

/// a * b - c * d to 1.5 units of rounding, so its sign is right (Kahan; Jeannerod, Louvet & Muller 2013).
CLEARANCE_HD inline double difference_of_products(double a, double b, double c, double d) {
  const double w = c * d;
  return fused(a, b, -w) + fused(-c, d, w);
}

/// +1 if the point (y, z) lies left of the line from u to v in the (y, z) plane, -1 if right. On the line, the point
/// counts as (y + e, z + e * e) for a tiny e. So the answer is 0 only if u and v coincide, and swapping u and v always
/// swaps the sign. Where the ray meets an edge or a vertex, exactly those triangles count that a nearby ray would meet.
template <class T>
CLEARANCE_HD inline int side(const T (&u)[3], const T (&v)[3], double y, double z) {
  const double uy = u[1], uz = u[2], vy = v[1], vz = v[2];
  const double first = (vy - uy) * (z - uz), second = (vz - uz) * (y - uy);
  const double quick = first - second, size = (first < 0 ? -first : first) + (second < 0 ? -second : second);
  // Larger than the rounding of four differences, two products and one more difference: no closer look is needed.
  if (quick > 0x1p-49 * size && size > 0x1p-900) return 1;
  if (-quick > 0x1p-49 * size && size > 0x1p-900) return -1;
  const bool swapped = vy < uy || (vy == uy && vz < uz);  // both triangles of an edge use the same numbers
  const double ay = swapped ? vy : uy, az = swapped ? vz : uz, by = swapped ? uy : vy, bz = swapped ? uz : vz;
  const double d = difference_of_products(by - ay, z - az, bz - az, y - ay);
  const int tie = az != bz ? (az > bz ? 1 : -1) : by != ay ? (by > ay ? 1 : -1) : 0;
  const int s = d > 0 ? 1 : d < 0 ? -1 : tie;
  return swapped ? -s : s;
}

/// The triangle's contribution to the winding number at (x, y, z): +1 where the ray towards +x leaves through it, -1
/// where it enters, 0 where it misses.
template <class T>
CLEARANCE_HD inline int sign(const crossing_triangle<T>& t, double x, double y, double z) {
  const T &ay = t.v[0][1], &by = t.v[1][1], &cy = t.v[2][1], &az = t.v[0][2], &bz = t.v[1][2], &cz = t.v[2][2];
  if ((ay < y && by < y && cy < y) || (ay > y && by > y && cy > y)) return 0;
  if ((az < z && bz < z && cz < z) || (az > z && bz > z && cz > z)) return 0;
  const double ax = t.v[0][0], bx = t.v[1][0], cx = t.v[2][0];
  if (ax < x && bx < x && cx < x) return 0;
  const int s = side(t.v[0], t.v[1], y, z);
  if (s == 0 || side(t.v[1], t.v[2], y, z) != s || side(t.v[2], t.v[0], y, z) != s) return 0;
  if (ax > x && bx > x && cx > x) return s;
  // s also has the sign of the normal's x, so the plane is ahead where normal * (p - a) has the other sign.
  const double uy = by - double(ay), uz = bz - double(az), ux = bx - ax, vy = cy - double(ay), vz = cz - double(az),
               vx = cx - ax;
  const double nx = difference_of_products(uy, vz, uz, vy), ny = difference_of_products(uz, vx, ux, vz),
               nz = difference_of_products(ux, vy, uy, vx);
  const double above = fused(nx, x - ax, fused(ny, y - ay, nz * (z - az)));
  return (s > 0 ? above < 0 : above > 0) ? s : 0;
}

}  // namespace crossing

/// Winding numbers of a closed surface, the same on host and device: the signed crossings of a ray towards +x, found by
/// a grid over (y, z). A point closer to the surface than rounding may count to either side.
template <class T>
struct basic_winding_view {
  const crossing_triangle<T>* triangles;
  const std::uint32_t* begin;         ///< rows * columns + 1 positions in `lists`.
  const std::uint32_t* lists;         ///< Triangles over each cell, the farthest-reaching along +x first.
  T low[3], high[3];                  ///< Bounds of the surface.
  T per_y, per_z;                     ///< Cells per metre.
  std::uint32_t columns, rows;        ///< Along y and z.
  const enclosure_head<T>* enclosed;  ///< What is inside by a flood, although not by winding number; or null.

  /// 0 outside and for points that are not finite.
  CLEARANCE_HD int winding(T x, T y, T z) const {
    if (!(x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1] && z >= low[2] && z <= high[2])) return 0;
    const std::uint32_t cell = row(z) * columns + column(y);
    int sum = 0;
    for (std::uint32_t i = begin[cell]; i < begin[cell + 1]; ++i) {
      const crossing_triangle<T>& t = triangles[lists[i]];
      if (t.v[0][0] < x && t.v[1][0] < x && t.v[2][0] < x) break;
      sum += crossing::sign(t, x, y, z);
    }
    return sum;
  }
  CLEARANCE_HD int winding(vec3 p) const { return winding(T(p.x), T(p.y), T(p.z)); }

  /// Is the winding number not 0, or the point out of reach of a flood from outside?
  CLEARANCE_HD bool inside(T x, T y, T z) const {
    return winding(x, y, z) != 0 || (enclosed != nullptr && enclosed->contains(x, y, z));
  }
  CLEARANCE_HD bool inside(vec3 p) const { return inside(T(p.x), T(p.y), T(p.z)); }

  /// They never decrease as their argument grows, even when rounded. So a triangle lies over all cells from that of its
  /// lowest corner to that of its highest.
  CLEARANCE_HD std::uint32_t column(T y) const { return cell(y - low[1], per_y, columns); }
  CLEARANCE_HD std::uint32_t row(T z) const { return cell(z - low[2], per_z, rows); }

 private:
  CLEARANCE_HD static std::uint32_t cell(T offset, T per_metre, std::uint32_t count) {
    const T c = offset * per_metre;
    return c >= T(count - 1) ? count - 1 : std::uint32_t(c);
  }
};

using winding_view = basic_winding_view<real>;

/// Owns what a winding view reads, in the memory of backend B. Never changes once made.
template <class T, backend B = host>
struct basic_winding {
  template <class U>
  using buffer = typename B::template buffer<U>;

  buffer<crossing_triangle<T>> triangles;
  buffer<std::uint32_t> cells;  ///< Start of each cell's list, and the end of the last.
  buffer<std::uint32_t> lists;
  buffer<std::uint32_t> enclosed;   ///< The cubes that a flood did not reach; empty if there was none.
  basic_winding_view<T> grid = {};  ///< Its pointers are set by `view()`.

  basic_winding_view<T> view() const {
    basic_winding_view<T> v = grid;
    v.triangles = triangles.data(), v.begin = cells.data(), v.lists = lists.data();
    if (enclosed.size() != 0) v.enclosed = reinterpret_cast<const enclosure_head<T>*>(enclosed.data());
    return v;
  }

  /// A copy of a host owner, where `other` runs.
  template <backend Other>
  basic_winding<T, Other> on(const Other& other) const {
    return {other.copy_in(std::span<const crossing_triangle<T>>(triangles)),
            other.copy_in(std::span<const std::uint32_t>(cells)), other.copy_in(std::span<const std::uint32_t>(lists)),
            other.copy_in(std::span<const std::uint32_t>(enclosed)), grid};
  }
};

/// The inside of a part: float coordinates, for queries.
template <backend B = host>
using winding = basic_winding<real, B>;

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
    g_.columns = std::uint32_t(along(y_, z_)), g_.rows = std::uint32_t(along(z_, y_));
    g_.per_y = per(g_.columns, y_), g_.per_z = per(g_.rows, z_);
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
    for (const auto& [cell, triangle] : entries) ++w_.cells[cell + 1], w_.lists.push_back(triangle);
    for (std::size_t i = 1; i < w_.cells.size(); ++i) w_.cells[i] += w_.cells[i - 1];
  }

  basic_winding<T>& w_;
  basic_winding_view<T>& g_;
  double y_, z_;
};

}  // namespace detail

/// Makes the test for points inside a mesh. The only loss is that coordinates are rounded to T. `bodies`, if given,
/// receives the body of each of its triangles. Throws std::invalid_argument if the mesh is not closed, or as `check`.
template <class T = real>
basic_winding<T> make_winding(const closed_mesh& mesh, std::vector<std::uint32_t>* bodies = nullptr) {
  check(mesh);
  if (!mesh.closed) throw std::invalid_argument("clearance: an open mesh has no inside; close it with caps");
  basic_winding<T> w;
  basic_winding_view<T>& g = w.grid;
  for (int k = 0; k < 3; ++k)
    g.low[k] = std::numeric_limits<T>::infinity(), g.high[k] = -std::numeric_limits<T>::infinity();
  for (std::size_t i = 0; i < mesh.surface.triangles.size(); ++i) {
    auto corners = mesh.surface.triangles[i];
    if (!mesh.counts[i] || corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    if (mesh.counts[i] < 0) std::swap(corners[1], corners[2]);
    crossing_triangle<T>& t = w.triangles.emplace_back();
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const T x = t.v[j][k] = T(mesh.surface.vertices[corners[j]][k]);
        g.low[k] = std::min(g.low[k], x), g.high[k] = std::max(g.high[k], x);
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

/// A triangle that a ray along +x meets.
struct ray_hit {
  double x;
  std::int32_t sign;       ///< +1 where the ray leaves through it, -1 where it enters.
  std::uint32_t triangle;  ///< Its number in the winding.
};

/// As many rays along each side as `wanted`, or fewer where triangles lie so many deep that they would take minutes.
inline int affordable_rays(const basic_winding<double>& w, int wanted) {
  const double deep = double(w.lists.size()) / double(w.cells.size());
  return std::clamp(int(std::sqrt(3e7 / std::max(deep, 1.0))), 16, wanted);
}

/// Calls `visit(hits)` for rays along +x through the cell middles of a grid of `rays` by `rays` over (y, z), with the
/// hits from low to high x. Returns the (y, z) area that each ray stands for, square metres.
template <class F>
double for_each_ray(const basic_winding<double>& w, int rays, F visit) {
  const basic_winding_view<double> g = w.view();
  const double y = g.high[1] - g.low[1], z = g.high[2] - g.low[2];
  std::vector<ray_hit> hits;
  for (int i = 0; i < rays; ++i)
    for (int j = 0; j < rays; ++j) {
      // Slightly off the middle, so that rays do not run in the seams of symmetric meshes.
      const double py = g.low[1] + y * ((i + 0.4987) / rays), pz = g.low[2] + z * ((j + 0.5021) / rays);
      const std::uint32_t cell = g.row(pz) * g.columns + g.column(py);
      hits.clear();
      for (std::uint32_t k = g.begin[cell]; k < g.begin[cell + 1]; ++k) {
        const auto& v = g.triangles[g.lists[k]].v;
        const int s = crossing::side(v[0], v[1], py, pz);
        if (s == 0 || crossing::side(v[1], v[2], py, pz) != s || crossing::side(v[2], v[0], py, pz) != s) continue;
        const double uy = v[1][1] - v[0][1], uz = v[1][2] - v[0][2], vy = v[2][1] - v[0][1], vz = v[2][2] - v[0][2];
        const double det = uy * vz - uz * vy, a = ((py - v[0][1]) * vz - (pz - v[0][2]) * vy) / det,
                     b = (uy * (pz - v[0][2]) - uz * (py - v[0][1])) / det;
        const double x = v[0][0] + a * (v[1][0] - v[0][0]) + b * (v[2][0] - v[0][0]);
        if (std::isfinite(x)) hits.push_back({x, s, g.lists[k]});
      }
      std::sort(hits.begin(), hits.end(),
                [](const auto& p, const auto& q) { return p.x != q.x ? p.x < q.x : p.triangle < q.triangle; });
      visit(std::span<const ray_hit>(hits));
    }
  return (y / rays) * (z / rays);
}

/// Rounding can swap two touching surfaces along a ray. That is no overlap, so shorter pieces are ignored. Metres.
inline double least_piece(const basic_winding<double>& w) { return 1e-9 * (w.grid.high[0] - w.grid.low[0]); }

/// What a closed surface encloses.
struct enclosed {
  double volume = 0;      ///< Cubic metres where the winding number is not 0.
  bool exact = true;      ///< From the divergence theorem; otherwise from rays, to about 0.1 %.
  bool overlaps = false;  ///< Some winding numbers are other than 0 and 1, or 0 and -1.
};

/// Rays find the winding numbers that occur. If these are only 0 and 1, or 0 and -1, the signed volume is the answer;
/// otherwise the lengths of rays inside are summed.
inline enclosed enclosed_volume(const basic_winding<double>& w) {
  if (w.triangles.empty()) return {};
  int lowest = 0, highest = 0;
  const auto sum_of_rays = [&](int rays) {
    double length = 0;
    const double each = for_each_ray(w, rays, [&](std::span<const ray_hit> hits) {
      int number = 0;
      for (std::size_t k = 0; k + 1 < hits.size(); ++k) {
        number -= hits[k].sign;  // +1: the ray leaves
        const double span = hits[k + 1].x - hits[k].x;
        if (number != 0) length += span;
        if (span > least_piece(w)) lowest = std::min(lowest, number), highest = std::max(highest, number);
      }
    });
    return length * each;
  };
  double signed_volume = 0;
  for (const auto& t : w.triangles) {
    double v[3][3];
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) v[j][k] = t.v[j][k] - w.grid.low[k];
    signed_volume +=
        (v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) - v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
         v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0])) /
        6;
  }
  sum_of_rays(affordable_rays(w, 128));
  enclosed e;
  e.overlaps = highest - lowest > 1;
  e.exact = !e.overlaps;
  e.volume = e.overlaps ? sum_of_rays(affordable_rays(w, 512)) : std::abs(signed_volume);
  return e;
}

}  // namespace clearance

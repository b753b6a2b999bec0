// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is a point inside a closed mesh? Rays count how often the surface winds round.

#include <clearance/backends/host.hpp>
#include <clearance/ground/config.hpp>
#include <clearance/ground/math.hpp>
#include <clearance/solid/close_mesh.hpp>
#include <clearance/solid/enclosure.hpp>

#include <cmath>

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
    v.triangles = triangles.data();
    v.begin = cells.data();
    v.lists = lists.data();
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

/// Makes the test for points inside a mesh. The only loss is that coordinates are rounded to T. `bodies`, if given,
/// receives the body of each of its triangles. Throws std::invalid_argument if the mesh is not closed, or as `check`.
/// Compiled: link clearance::solid.
template <class T = real>
basic_winding<T> make_winding(const closed_mesh& mesh, std::vector<std::uint32_t>* bodies = nullptr);
extern template basic_winding<float> make_winding(const closed_mesh&, std::vector<std::uint32_t>*);
extern template basic_winding<double> make_winding(const closed_mesh&, std::vector<std::uint32_t>*);

}  // namespace clearance

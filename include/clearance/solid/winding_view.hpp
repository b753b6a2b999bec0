// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>
#include <clearance/solid/crossing.hpp>
#include <clearance/solid/enclosure_view.hpp>

namespace clearance {

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

}  // namespace clearance

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What one cube of a field says, and why it is right.
//
// The distance to a convex primitive is convex. So over a cube it is at least its tangent in the cube's middle, and at
// most what it is at a corner, both compared with any plane. A part's distance is the least of its primitives'.

#include <clearance/minimum/witness.hpp>
#include <clearance/robot/field.hpp>
#include <clearance/traversal/any_depth.hpp>

namespace clearance::minimum {

/// The visitor of the primitive whose tangent falls lowest below a plane of gradient `way`, over a cube.
struct lowest_tangent {
  using result_type = real;

  vec3 middle, way;
  real half;  ///< Of the cube's side.
  real lowest = infinity;

  CLEARANCE_HD real reach() const { return lowest; }
  CLEARANCE_HD real result() const { return lowest; }
  CLEARANCE_HD real over_cube(const tangent& t) const {
    const vec3 d = t.direction - way;
    const real turn = half * (absolute(d.x) + absolute(d.y) + absolute(d.z));
    return t.distance - turn - slack * (absolute(t.distance) + 4 * half);
  }
  template <class V>
  CLEARANCE_HD real bound(const V& volume, vec3 q) const {
    if constexpr (tangent_volume<V>)
      return over_cube(bounding_volume_traits<V>::tangent_at(volume, q));
    else
      return bounding_volume_traits<V>::lower_bound(volume, q) - 4 * half;
  }
  CLEARANCE_HD void offer(std::uint32_t, real) const {}
  /// Very near to the middle a tangent's direction may be wrong. But no distance changes faster than its place.
  template <tangent_primitive P>
  CLEARANCE_HD void offer(std::uint32_t, real distance, const P& p) {
    const real turn = half * (absolute(way.x) + absolute(way.y) + absolute(way.z));
    const real slow = distance - 1.7321f * half - turn - slack * (absolute(distance) + 4 * half);
    lowest = min(lowest, max(over_cube(p.tangent_at(middle)), slow));
  }
};

/// Fills cube i of one of a part's grids.
template <class PartView>
struct field_sample {
  const PartView* part;
  field_view::grid grid;
  any_depth walk;
  field_cell* cells;    ///< The grid's own.
  std::uint32_t* lost;  ///< Becomes 1 if a cube cannot be told in a cell's numbers, as of a part without a distance.

  CLEARANCE_CALLS_ANYTHING
  CLEARANCE_HD void operator()(std::size_t i) const {
    using primitive = typename PartView::hierarchy_type::primitive_type;
    const auto x = std::uint32_t(i % grid.size[0]), y = std::uint32_t(i / grid.size[0] % grid.size[1]),
               z = std::uint32_t(i / grid.size[0] / grid.size[1]);
    const vec3 q = grid.middle(x, y, z);
    nearest_primitive<primitive> near{infinity};
    walk(part->tree, q, near);
    if (near.id == none) return give_up();
    const vec3 direction = near.primitive.tangent_at(q).direction;
    field_cell c;
    const real steps = (near.within - grid.least) * rough_inverse(grid.unit);
    if (!(steps >= 0 && steps < 65535)) return give_up();
    c.value = std::uint16_t(steps);
    const auto whole = [](real u) { return std::int8_t(rough_max(rough_min(u * 127, 127), -127)); };
    c.way[0] = whole(direction.x), c.way[1] = whole(direction.y), c.way[2] = whole(direction.z);
    const vec3 way = scaled(1.0f / 127, {real(c.way[0]), real(c.way[1]), real(c.way[2])});
    const real plane = fma(grid.unit, real(c.value), grid.least), half = grid.step / 2;
    real above = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const vec3 e{corner & 1 ? half : -half, corner & 2 ? half : -half, corner & 4 ? half : -half};
      const real d = near.primitive.distance(q + e);
      above = max(above, d - plane - dot(way, e) + 4 * slack * (absolute(d) + 4 * half));
    }
    lowest_tangent lowest{q, way, half};
    lowest.offer(near.id, near.within, near.primitive);
    walk(part->tree, q, lowest);
    const real most = units(above), least = units(plane - lowest.lowest);
    if (!(most < 255 && least < 255)) return give_up();
    c.above = std::uint8_t(most), c.below = std::uint8_t(least);
    const real turn = half * (absolute(way.x) + absolute(way.y) + absolute(way.z));
    c.side = side(q, plane - turn - real(c.below) * grid.step / 127 - grid.error);
    cells[i] = c;
  }

 private:
  CLEARANCE_HD void give_up() const { *static_cast<volatile std::uint32_t*>(lost) = 1; }
  /// What a cell's numbers make of a difference: one more than it, at least.
  CLEARANCE_HD real units(real most) const {
    return max(most, 0) * rough_inverse(grid.step) * (127 * (1 + 4 * slack)) + 1;
  }
  /// All of a cube is on one side if no primitive comes nearer to it than the solid's tolerance.
  CLEARANCE_HD field_side side(vec3 q, real nearest) const {
    if constexpr (scan::has_interior<PartView>)
      if (nearest > part->facts.tolerance) return part->interior.inside(q) ? field_side::inside : field_side::outside;
    return field_side::unknown;
  }
};

}  // namespace clearance::minimum

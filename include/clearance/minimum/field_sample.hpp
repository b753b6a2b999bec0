// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Samples the field of a part: what is known of the distance to it, from one look into a table.

#include <clearance/backends/host.hpp>
#include <clearance/minimum/resolve.hpp>
#include <clearance/robot/field.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/traversal/any_depth.hpp>

#include <optional>

namespace clearance::minimum {

// What one cube of a field says, and why it is right.
//
// The distance to a convex primitive is convex. So over a cube it is at least its tangent in the cube's middle, and at
// most what it is at a corner, both compared with any plane. A part's distance is the least of its primitives'.

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
    c.way[0] = whole(direction.x);
    c.way[1] = whole(direction.y);
    c.way[2] = whole(direction.z);
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
    c.above = std::uint8_t(most);
    c.below = std::uint8_t(least);
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

/// The grids of a field with about `cubes` cubes each; none if the part has no finite size.
inline field_view field_around(const extent& box, const ball& around, std::size_t cubes) {
  field_view v;
  v.around = around;
  v.center = {(box.lower.x + box.upper.x) / 2, (box.lower.y + box.upper.y) / 2, (box.lower.z + box.upper.z) / 2};
  const vec3 to = box.upper - v.center, from = v.center - box.lower;
  v.half = {max(to.x, from.x), max(to.y, from.y), max(to.z, from.z)};
  v.thickness = around.radius / 4;
  std::uint32_t first = 0;
  for (std::uint32_t l = 0; l < field_view::levels; ++l) {
    auto& g = v.grids[l];
    const double more = (double(v.thickness) * double((2u << l) - 1)) * (1 + 0x1p-16);
    const double side[3] = {2 * (v.half.x + more), 2 * (v.half.y + more), 2 * (v.half.z + more)};
    double step = std::cbrt(side[0] * side[1] * side[2] / double(cubes));
    g.step = real(step);
    step = double(g.step);
    g.inverse = {real(1 / step), real(1 / step), real(1 / step)};
    for (int k = 0; k < 3; ++k) g.size[k] = std::uint32_t(std::ceil(side[k] / step)) + 1;
    const auto corner = [&](real center, std::uint32_t size) { return real(double(center) - step * size / 2); };
    g.low = {corner(v.center.x, g.size[0]), corner(v.center.y, g.size[1]), corner(v.center.z, g.size[2])};
    const double across = step * (double(g.size[0]) + g.size[1] + g.size[2]) + 4 * double(around.radius);
    g.least = -2 * around.radius;
    g.unit = real((across + 2 * double(around.radius)) / 65000);
    g.error =
        rounded_up(8 * double(slack) * (across + std::abs(v.center.x) + std::abs(v.center.y) + std::abs(v.center.z)) +
                   double(g.unit) * 0x1p-10);
    g.first = first;
    first += g.cubes();
  }
  return v;
}

/// A box around a part: of its primitives if they are listed, else of its ball.
template <class Part>
extent box_around(const Part& part) {
  extent box;
  const auto add = [&box](const ball& b) {
    box.add(b.center - vec3{b.radius, b.radius, b.radius});
    box.add(b.center + vec3{b.radius, b.radius, b.radius});
  };
  if constexpr (requires { part.tree.primitives; }) {
    for (const auto& p : part.tree.primitives)
      for (const ball& b : p.balls()) add(b);
  } else {
    add({part.facts.center, part.facts.radius});
  }
  return box;
}

/// A part's field without its cells; it says why not otherwise.
template <class Part>
std::optional<field<host>> field_of(const Part& part, const field_options& options, std::string& why_not) {
  const part_facts& facts = part.facts;
  constexpr std::size_t fewest = 512, each = field_view::levels * sizeof(field_cell);
  constexpr std::uint64_t most = std::uint64_t(1) << 34;  // cells are numbered in 32 bits
  const std::size_t cubes = options.bytes / each;
  if (cubes < fewest) {
    why_not =
        std::to_string(options.bytes) + " bytes are too few for a field; it needs " + std::to_string(fewest * each);
    return std::nullopt;
  }
  if (options.bytes > most) {
    why_not =
        std::to_string(options.bytes) + " bytes are too many for a field; it takes at most " + std::to_string(most);
    return std::nullopt;
  }
  if (!(facts.radius > 0 && facts.radius < 1e6f && length(facts.center) < 1e6f)) {
    why_not = "a part without a finite size has no field";
    return std::nullopt;
  }
  return field<host>{{}, field_around(box_around(part), {facts.center, facts.radius}, cubes), options.bytes};
}

/// Samples what is in the boxes of a field.
template <backend B, class Part>
std::vector<field_cell> sampled_cells(const B& on, const Part& part, const field_view& shape, std::string& why_not) {
  const auto there = part.on(on);
  const auto view = there.view();
  const std::uint64_t need = stack_need(view.tree.depth(), view.tree.width());
  if constexpr (requires { typename B::own_scan; })
    if (need > near_first::capacity) {
      why_not = "its tree needs a stack of " + std::to_string(need) +
                " entries, too many for a device; sample its field on a host";
      return std::vector<field_cell>{};
    }
  using part_view = std::remove_const_t<decltype(view)>;
  const std::size_t all = shape.all_cubes();
  const auto views = on.copy_in(std::span<const part_view>(&view, 1));
  auto cells = on.template make_scratch<field_cell>(all);
  auto lost = on.template make_scratch<std::uint32_t>(1);
  const std::uint32_t nothing = 0;
  on.stage(std::span<const std::uint32_t>(&nothing, 1), lost.data());
  const any_depth walk{need};
  for (const auto& g : shape.grids)
    on.for_each(g.cubes(), field_sample<part_view>{views.data(), g, walk, cells.data() + g.first, lost.data()});
  if (on.copy_out(lost.data(), 1)[0] != 0) {
    why_not = "its distances are not finite, so it has no field";
    return std::vector<field_cell>{};
  }
  return on.copy_out(cells.data(), all);
}

/// Makes the field of one part; it says why not otherwise.
template <backend B, class Part>
field<host> sampled_field(const B& on, const Part& part, const field_options& options, std::string& why_not) {
  auto made = field_of(part, options, why_not);
  if (!made) return {};
  try {
    made->cells = sampled_cells(on, part, made->shape, why_not);
  } catch (const std::exception& error) {
    if (!detail::out_of_memory(on, error)) throw;
    why_not = "there is not enough memory to sample its field";
  }
  return std::move(*made);
}

}  // namespace clearance::minimum

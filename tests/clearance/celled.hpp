// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Cells of parts list whatever can be nearest, and change no answer.
#include "minimum/edge_scenes.hpp"
#include "solid/shapes.hpp"
#include "support/brute_distances.hpp"
#include "support/closed.hpp"
#include "support/same_answer.hpp"

#include <clearance/make_model.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>

namespace testing {

/// A little beside a float, or at it.
inline real beside(real x, dice& d) {
  const unsigned side = d.below(3);
  return side == 0 ? x : std::nextafter(x, side == 1 ? infinity : -infinity);
}

/// The cells of a part; empty ones if it has none.
template <class Model>
clearance::cells<> cells_of(const Model& model, std::size_t k) {
  return model.cells().empty() ? clearance::cells<>() : model.cells()[k];
}

/// Robots with cells, and their laws.
template <class On>
struct cells_law {
  On on;
  verdict v = {};
  std::size_t leaves[4] = {};  ///< How many of each cell_kind have been met,
  std::size_t outside = 0, beyond = 0, ties = 0, listed = 0, long_lists = 0, with = 0, without = 0;

  /// The robot with cells; `needed`: all its parts must have them.
  template <class Model>
  auto equip(const Model& model, const std::string& what, const clearance::cell_options& options, bool needed = true) {
    auto made = clearance::with_cells(on, model, options);
    for (std::size_t k = 0; k < model.size(); ++k) {
      const std::string& why_not = made.without[k];
      v.require(why_not.empty() || !needed, what, ": ", why_not);
      v.require(cells_of(made.model, k).empty() == !why_not.empty(), what, ": cells, and a sentence why not");
      ++(why_not.empty() ? with : without);
    }
    return std::move(made.model);
  }

  template <class Model>
  void check(const Model& model, dice& d, const std::string& what, int looks = 1500) {
    for (std::size_t k = 0; k < model.size(); ++k) {
      const auto part = model.parts()[k].view();
      const auto its = cells_of(model, k);
      const auto cells = its.view();
      if (its.empty()) continue;
      const std::span primitives(model.parts()[k].tree.primitives.data(), model.parts()[k].tree.primitives.size());
      const std::string which = what + ", part " + std::to_string(k);
      for (int i = 0; i < looks; ++i) look(part, cells, primitives, probe(part.facts, cells, primitives, d, i), which);
      v.require(cells({clearance::not_a_number, 0, 0}).node.kind == clearance::cell_kind::unlisted, which,
                ": NaN is in a cell");
    }
  }

 private:
  /// A position in the cube, on its faces, beyond it, on corners and sides of cells, on primitives, and where two of
  /// them are about equally near; or a little beside it.
  template <class P>
  static vec3 probe(const clearance::part_facts& facts, const clearance::cells_view& cells,
                    std::span<const P> primitives, dice& d, int sort) {
    const real side = cells.step * real(1u << clearance::cells_view::deepest);
    const vec3 middle = cells.low + vec3{side / 2, side / 2, side / 2};
    vec3 q = d.point(side / 2, middle);
    real* const of_q[] = {&q.x, &q.y, &q.z};
    const real low[] = {cells.low.x, cells.low.y, cells.low.z};
    switch (sort % 8) {
      case 1: {  // on a corner, an edge or a face of a cell
        const unsigned up = d.below(7);
        const vec3 about = sort % 16 == 1 ? q : d.point(1.2 * double(facts.radius), facts.center);
        const real at[] = {about.x, about.y, about.z};
        for (int axis = 0; axis < 3; ++axis) {
          const auto cell = unsigned(std::clamp((at[axis] - low[axis]) / cells.step, real(0), real(1023)));
          *of_q[axis] = at[axis];
          if (d.below(4) != 0) *of_q[axis] = beside(clearance::fma(cells.step, real(cell >> up << up), low[axis]), d);
        }
        return q;
      }
      case 2:
        return primitives[d.below(unsigned(primitives.size()))].nearest(q);
      case 3:
        return primitives[d.below(unsigned(primitives.size()))].nearest(q) + d.point(3 * double(cells.step));
      case 4: {
        const int axis = int(d.below(3));
        *of_q[axis] = beside(d.below(2) == 0 ? low[axis] : low[axis] + side, d);
        return q;
      }
      case 5:
        return d.point(double(side) * std::pow(2.0, d.uniform(-1, 12)), middle);
      case 6: {
        vec3 to = sort % 16 == 6 ? d.point(side / 2, middle) : d.point(1.2 * double(facts.radius), facts.center);
        const std::size_t its = nearest(primitives, q);
        for (int half = 0; half < 20; ++half) {
          const vec3 between = clearance::scaled(0.5f, q + to);
          (nearest(primitives, between) == its ? q : to) = between;
        }
        return q;
      }
      case 7:
        return d.point(1.2 * double(facts.radius), facts.center);
      default:
        return q;
    }
  }
  template <class P>
  static std::size_t nearest(std::span<const P> primitives, vec3 q) {
    std::size_t best = 0;
    real least = infinity;
    for (std::size_t n = 0; n < primitives.size(); ++n)
      if (const real d = primitives[n].distance(q); d < least) least = d, best = n;
    return best;
  }

  template <class PartView, class P>
  void look(const PartView& part, const clearance::cells_view& cells, std::span<const P> primitives, vec3 q,
            const std::string& what) {
    using clearance::cell_kind;
    const auto leaf = cells(q);
    const std::uint32_t count = leaf.node.count;
    v.require(leaf.node.kind != cell_kind::inner, what, ": no leaf at ", q);
    v.require((leaf.node.kind == cell_kind::unlisted) == (count == 0), what, ": a list of", count, " at ", q);
    const real side = cells.step * real(1u << clearance::cells_view::deepest);
    const vec3 from_low = q - cells.low;
    if (std::min({from_low.x, from_low.y, from_low.z}) < 0 || std::max({from_low.x, from_low.y, from_low.z}) > side)
      v.require(count == 0, what, ": a list beyond the cells, at ", q), ++beyond;
    else if (std::max({from_low.x, from_low.y, from_low.z}) < side * 0.999f)
      ++leaves[int(leaf.node.kind)];
    sides(part, leaf, q, what);
    if (count == 0) return;
    const real least = primitives[nearest(primitives, q)].distance(q);
    std::vector<bool> in_list(primitives.size());
    for (std::uint32_t j = 0; j < count; ++j) {
      const clearance::cell_candidate c = cells.candidate(leaf, j);
      v.require(c.place < primitives.size() && !in_list[c.place], what, ": a list names", c.place, " wrongly");
      if (c.place >= primitives.size()) return;
      in_list[c.place] = true;
      const real distance = primitives[c.place].distance(q);
      for (std::uint32_t l = j; j % 8 == 0 && l < count; ++l)
        v.require(c.rest <= primitives[cells.candidate(leaf, l).place].distance(q), what, ": rest at ", q, ",", c.rest);
      v.require(c.low <= distance, what, ": primitive", c.place, " is", distance, " away at ", q, ", not", c.low);
    }
    std::size_t equal = 0;
    for (std::size_t n = 0; n < primitives.size(); ++n)
      if (primitives[n].distance(q) == least) {
        ++equal;
        v.require(in_list[n], what, ": primitive", n, " is nearest at ", q, ",", least, " away, and not listed");
      }
    ties += equal > 1, listed += count, long_lists += count > 32;
    // The first is the nearest to the middle, but for what rounding does to bounds.
    const vec3 middle = q - leaf.from_middle;
    const real first = primitives[cells.candidate(leaf, 0).place].distance(middle),
               its = primitives[nearest(primitives, middle)].distance(middle);
    const real rounding =
        clearance::length(middle - part.facts.center) + clearance::length(middle) + 4 * part.facts.radius;
    v.require(first <= its + 64 * clearance::slack * rounding, what, ": the first of a list is", first,
              " away, and not", its, ", at the leaf's middle ", middle);
  }

  template <class PartView>
  void sides(const PartView& part, const clearance::cell_leaf& leaf, vec3 q, const std::string& what) {
    const bool in = leaf.node.kind == clearance::cell_kind::inside, out = leaf.node.outside;
    outside += out;
    v.require(!(in && out), what, ": inside and outside at ", q);
    if constexpr (clearance::scan::has_interior<PartView>)
      v.require(!(in || out) || part.interior.inside(q) == in, what, ": another side at ", q);
    else
      v.require(!in, what, ": inside of no solid at ", q);
  }
};

/// Distances to a robot with cells are those to the robot without, in every bit: asked once, and by a prepared
/// question.
template <class On, class Bare, class Celled, class Clouds>
void require_same_distances(const On& on, const Bare& bare, const Celled& celled,
                            const std::vector<Eigen::Isometry3d>& poses, const Clouds& clouds, double size, verdict& v,
                            const std::string& what) {
  using clearance::distances, clearance::host, clearance::signed_distances;
  const auto same = [&](const clearance::point_distances& found, const clearance::point_distances& expected,
                        const std::string& asked) {
    require_same(found, expected, v, asked);
    v.require(same_answer(found, expected), asked, ": other bits");
  };
  const auto compare = [&](auto& query, const auto& q, const std::string& asked) {
    const auto expected = ask(host{1}, bare, poses, clouds, q);
    same(ask(on, celled, poses, clouds, q), expected, asked + ", once");
    same(query(poses, clouds, q), expected, asked + ", prepared");
    same(query(poses, clouds, q), expected, asked + ", warm");
  };
  clearance::query query(on, celled, distances{});
  for (const double d_max : {-0.05, 0.0, 0.03, 0.2, double(infinity)}) {
    const std::string asked = what + ", d_max " + std::to_string(d_max * size);
    compare(query, distances{d_max * size, true}, asked);
    if constexpr (clearance::scan::has_interior<typename decltype(view_of(bare))::part_type>)
      if (d_max >= 0) {
        clearance::query depths(on, celled, signed_distances{});
        compare(depths, signed_distances{d_max * size, true}, asked + ", signed");
      }
  }
  compare(query, distances{0.2 * size}, what + ", distances alone");
}

/// Points in a robot, around and far beyond its cells, and none; in random order.
inline std::vector<vec3> scattered(dice& d, std::size_t n, double size) {
  std::vector<vec3> points;
  while (points.size() < n) {
    const std::size_t k = points.size();
    points.push_back(d.point(size * (k % 7 == 0 ? 500 : k % 3 == 0 ? 5 : 1)));
    if (k % 19 == 0) points.back().y = clearance::not_a_number;
  }
  return points;
}

/// A robot's primitives that are hard to tell apart, and what cells they are to have.
template <class P>
struct odd_part {
  std::string name;
  std::vector<P> primitives;
  clearance::cell_options options;
};

inline inner_sphere moved(const inner_sphere& s, vec3 by) { return {s.center + by, s.radius}; }
inline triangle moved(const triangle& t, vec3 by) { return triangle::from(t.a + by, t.b + by, t.c + by); }

inline void add_odd(std::vector<odd_part<inner_sphere>>& all, dice& d) {
  const auto sized = [&](double smallest, double largest, std::size_t n) {
    std::vector<inner_sphere> spheres;
    while (spheres.size() < n) spheres.push_back(d.sphere(1, smallest, largest));
    return spheres;
  };
  auto some = sized(0.001, 1, 60);
  for (std::size_t k = 0; k < 10; ++k) some.push_back({some[k].center, some[k].radius / 3});  // nested
  all.push_back({"spheres of very different radii", some, {1 << 23, 3}});
  some = sized(0.1, 0.2, 60);
  for (auto& s : some) s.radius = 0;
  all.push_back({"points", some, {1 << 23, 2}});
  some = sized(0.01, 0.02, 40);
  some.push_back({{0, 0, 0}, 20});
  all.push_back({"all in one", some, {1 << 23, 10}});
  for (int k = 0; k < 40; ++k) some.push_back({{0.1f * real(k), 0, 0}, 20 - 0.1f * real(k)});  // they touch in a point
  all.push_back({"nested ones that touch", some, {1 << 23, 10}});
  some = {{{3, 4, 5}, 0}, {{3, 4, 5}, 1e-30f}, {{3, 4, 5 + 1e-3f}, 0}};
  all.push_back({"almost one point", some, {1 << 23, 0.1}});
}
inline void add_odd(std::vector<odd_part<triangle>>& all, dice& d) {
  std::vector<triangle> some;
  for (int k = 0; k < 12; ++k) {
    const vec3 a = d.point(1), b = d.point(1), c = d.point(1);
    some.push_back(triangle::from(a, b, clearance::fma(1e-6f, c, a)));
    some.push_back(triangle::from(a, b, clearance::scaled(0.5f, a + b)));
    some.push_back(triangle::from(c, c, c));
    some.push_back(triangle::from(a, b, b));
  }
  all.push_back({"needles and less", some, {1 << 23, 1}});
  some = random_triangles(d, 20, 1, 0.3);
  for (int k = 0; k < 20; ++k) some.push_back(some[k]);
  for (int k = 0; k < 10; ++k) some.push_back(triangle::from(some[k].b, some[k].c, some[k].a));
  all.push_back({"doubled", some, {1 << 23, 1}});
  const auto globe = [&](double radius, Eigen::Vector3d center, int rings, int sectors) {
    std::vector<triangle> faces;
    const auto mesh = shapes::globe(center, radius, rings, sectors);
    const auto corner = [&](std::uint32_t k) {
      const Eigen::Vector3f c = mesh.vertices[k].cast<float>();
      return vec3{c.x(), c.y(), c.z()};
    };
    for (const auto& t : mesh.triangles) faces.push_back(triangle::from(corner(t[0]), corner(t[1]), corner(t[2])));
    return faces;
  };
  all.push_back({"a globe", globe(1, {0, 0, 0}, 4, 6), {1 << 23, 1}});
  all.push_back({"a small globe far off", globe(0.01, {300, -400, 500}, 2, 6), {1 << 24, 1}});
}

/// Parts of all sizes, near their frame's origin and far from it, of few primitives and of one.
template <class P>
std::vector<odd_part<P>> odd_parts() {
  dice d(433);
  std::vector<odd_part<P>> all;
  for (const double size : {1e-3, 1.0, 1e3})
    for (const double away : {0.0, 100.0}) {
      auto some = random_primitives<P>(d, 25, size, 0.2 * size);
      for (P& p : some) p = moved(p, {real(0.6 * away * size), real(-0.7 * away * size), real(0.4 * away * size)});
      all.push_back({"size " + std::to_string(size) + ", " + std::to_string(away) + " sizes off",
                     some,
                     {1 << 23, (away == 0 ? 3 : 0.5) * size}});
    }
  auto some = random_primitives<P>(d, 15, 1, 0.3);  // few, because cells are widened by half of what they are
  for (P& p : some) p = moved(p, {50000, -40000, 30000});
  all.push_back({"where numbers are millimetres apart", some, {1 << 23, 0.2}});
  all.push_back(
      {"a speck, of which rounding hides which is nearest", random_primitives<P>(d, 15, 1e-6, 3e-7), {1 << 23, 2}});
  all.push_back({"one alone", random_primitives<P>(d, 1, 1, 0.3), {1 << 23, 1}});
  all.push_back({"reach 0", random_primitives<P>(d, 20, 1, 0.3), {1 << 23, 0}});
  add_odd(all, d);
  return all;
}

/// So many equal primitives in the middle of a box of larger ones: of positions near them all can be the nearest. No
/// list holds more than 256.
template <class P>
odd_part<P> equal_in_a_box(int count) {
  odd_part<P> all{std::to_string(count) + " equal ones", {}, {1 << 23, 0}};
  const auto put = [&](vec3 at, real size) {
    if constexpr (std::is_same_v<P, inner_sphere>)
      all.primitives.push_back({at, size});
    else
      all.primitives.push_back(
          triangle::from(at + vec3{size, 0, 0}, at + vec3{0, size, 0}, at + vec3{-size, -size, size}));
  };
  for (const real side : {-1.0f, 1.0f})
    for (int axis = 0; axis < 3; ++axis) {
      put({axis == 0 ? side * 0.02f : 0, axis == 1 ? side * 0.02f : 0, axis == 2 ? side * 0.02f : 0}, 0.002f);
      put({axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0}, 0.1f);
    }
  for (int k = 0; k < count; ++k) put({0, 0, 0}, 1e-4f);
  return all;
}

template <class V, class P>
auto odd_model(const odd_part<P>& part) {
  return clearance::model(std::vector{clearance::make_part(clearance::build<V>(part.primitives))});
}

/// A primitive of one's own: what is within a radius of a segment.
struct rod {
  vec3 a, b;
  real radius;

  CLEARANCE_HD vec3 on_axis(vec3 q) const {
    const vec3 edge = b - a;
    const real squared = clearance::dot(edge, edge);
    if (!(squared > 0)) return a;
    return clearance::fma(clearance::clamp01(clearance::divide(clearance::dot(q - a, edge), squared)), edge, a);
  }
  CLEARANCE_HD real distance(vec3 q) const { return clearance::length(q - on_axis(q)) - radius; }
  CLEARANCE_HD vec3 normal(vec3 q) const {
    const vec3 d = q - on_axis(q);
    const real l = clearance::length(d);
    return l > 0 ? clearance::scaled(clearance::divide(1, l), d) : vec3{0, 0, 0};
  }
  CLEARANCE_HD vec3 nearest(vec3 q) const { return clearance::fma(radius, normal(q), on_axis(q)); }
  CLEARANCE_HD clearance::core_place core_at(vec3 q) const { return {on_axis(q), radius}; }
  /// Both ends lie behind the half-space.
  CLEARANCE_HD clearance::primitive_tangent tangent_at(vec3 q) const {
    const clearance::unit_way way(q - on_axis(q));
    const real off = 4 * clearance::slack * (way.length + radius + clearance::length(b - a)) + 0x1p-60f,
               behind =
                   clearance::rough_min(clearance::dot(way.direction, q - a), clearance::dot(way.direction, q - b));
    return {{behind - radius - off, way.direction}, way.length - radius + off, way.length};
  }
  std::array<ball, 2> balls() const { return {{{a, radius}, {b, radius}}}; }
};
static_assert(clearance::cored_primitive<rod>);

/// Rods of all thicknesses, some of them twice, and joined ones.
inline std::vector<rod> rods(dice& d) {
  std::vector<rod> all;
  for (int k = 0; k < 30; ++k) {
    const vec3 a = d.point(1), b = d.point(1);
    all.push_back({a, b, real(std::pow(10, d.uniform(-4, -0.5)))});
    if (k % 3 == 0) all.push_back(all.back());
    if (k % 3 == 1) all.push_back({b, d.point(1), all.back().radius});
    if (k % 9 == 2) all.push_back({a, a, 0});
  }
  return all;
}

/// Equal solids whose inside is known but for a tolerance.
inline auto solid_robot(std::size_t parts, double tolerance) {
  return clearance::make_model<clearance::aabb>(std::vector(parts, clearance::close_mesh(shapes::cube(1))),
                                                clearance::part_options{.tolerance = tolerance});
}

}  // namespace testing

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is known beforehand of the distance to a part: bounds from one look into a table. They are never an answer.

#include <clearance/ground/ordered.hpp>
#include <clearance/ground/read_only.hpp>
#include <clearance/robot/part.hpp>

namespace clearance {

/// On which side of a part's solid a position lies.
enum class field_side : std::uint8_t { outside, inside, unknown };

/// Bounds on the distance from a position to a part's primitives, in metres: signed if that of a primitive is.
struct field_range {
  real low, high;
  field_side side = field_side::unknown;
};

/// One cube of a field: the distance in it is a plane's, less or plus what is known of the difference.
struct alignas(8) field_cell {
  std::uint16_t value = 0;            ///< The plane at the cube's middle, in units of its grid.
  std::int8_t way[3] = {};            ///< Its gradient, in units of 1/127.
  std::uint8_t below = 0, above = 0;  ///< In units of 1/127 of the cube's side.
  field_side side = field_side::unknown;
};

/// Cubes around a part, in nested boxes. Each box is about twice as far from the part as the one in it, with the same
/// number of cubes. Beyond the last one the part's ball is what is known.
///
/// Law: the computed distance from q is at least `low` and at most `high`, for every finite q.
/// Law: where a side is known, the solid's `inside(q)` says the same.
struct field_view {
  static constexpr std::uint32_t levels = 5;
  /// One box.
  struct alignas(16) grid {
    vec3 low;      ///< Its lowest corner,
    real step;     ///< the side of a cube,
    vec3 inverse;  ///< and one over it, three times.
    real least;    ///< The value 0,
    real unit;     ///< and one unit of it.
    real error;    ///< What rounding adds to either bound.
    std::uint32_t size[3], first;

    CLEARANCE_HD vec3 middle(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
      return {fma(step, real(x) + 0.5f, low.x), fma(step, real(y) + 0.5f, low.y), fma(step, real(z) + 0.5f, low.z)};
    }
    CLEARANCE_HD std::uint32_t cubes() const { return size[0] * size[1] * size[2]; }
  };

  const field_cell* cells = nullptr;
  ball around = {};             ///< The part's ball,
  vec3 center = {}, half = {};  ///< and a box around it.
  real thickness = 0;           ///< How far the first grid reaches beyond that box, at least.
  grid grids[levels] = {};

  /// In all boxes together.
  std::size_t all_cubes() const { return std::size_t(grids[levels - 1].first) + grids[levels - 1].cubes(); }
  CLEARANCE_HD field_range operator()(vec3 q) const {
    const vec3 d = q - center;
    const real beyond =
        rough_max(rough_max(absolute(d.x) - half.x, absolute(d.y) - half.y), absolute(d.z) - half.z) + thickness;
    if (!(beyond < real(1u << levels) * thickness)) return from_afar(q);
    // Grid l reaches 2^(l+1) - 1 thicknesses beyond the box.
    const std::uint32_t l = beyond < 2 * thickness ? 0 : (to_bits(beyond * rough_inverse(thickness)) >> 23) - 127;
    const grid& g = grids[l < levels ? l : levels - 1];
    const auto along = [](real at, std::uint32_t size) {
      const std::uint32_t i = at > 0 ? std::uint32_t(at) : 0;
      return i < size ? i : size - 1;
    };
    const vec3 at{(q.x - g.low.x) * g.inverse.x, (q.y - g.low.y) * g.inverse.y, (q.z - g.low.z) * g.inverse.z};
    const std::uint32_t x = along(at.x, g.size[0]), y = along(at.y, g.size[1]), z = along(at.z, g.size[2]);
    const field_cell c = read_only(cells + g.first + (z * g.size[1] + y) * g.size[0] + x);
    const vec3 e = q - g.middle(x, y, z);
    const real plane =
        fma(1.0f / 127, dot({real(c.way[0]), real(c.way[1]), real(c.way[2])}, e), fma(g.unit, real(c.value), g.least));
    const real part = g.step * (1.0f / 127);
    return {fma(-part, real(c.below), plane) - g.error, fma(part, real(c.above), plane) + g.error, c.side};
  }

 private:
  CLEARANCE_HD field_range from_afar(vec3 q) const {
    const real away = rough_length(q - around.center), off = 2 * slack * (away + around.radius);
    return {away - around.radius - off, away + around.radius + off, field_side::outside};
  }
};

struct field_options {
  std::size_t bytes = std::size_t(1) << 20;  ///< Memory for each part, about.
};

/// Owns what a field_view reads, in the memory of one backend.
template <class B = host>
struct field {
  static_assert(backend<B>);

  typename B::template buffer<field_cell> cells;
  field_view shape;       ///< Its pointer is set by `view()`.
  std::size_t bytes = 0;  ///< Of the field_options that it was made by.

  bool empty() const { return cells.size() == 0; }
  field_view view() const {
    field_view v = shape;
    v.cells = cells.data();
    return v;
  }
  template <backend Other>
  field<Other> on(const Other& other) const {
    return {other.copy_in(std::span<const field_cell>(cells)), shape, bytes};
  }
};

}  // namespace clearance

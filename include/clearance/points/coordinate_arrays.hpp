// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in three arrays: all x, all y and all z, as many simulations keep points.

#include <clearance/ground/read_only.hpp>
#include <clearance/points/point_filter.hpp>

namespace clearance {

/// `count` points whose x, y and z lie in arrays of their own, anywhere. Metres.
struct coordinate_arrays {
  using can = clearance::can<sources::fetched, sources::unfiltered, sources::filtered, sources::slicing,
                             sources::copied_in_pieces, sources::checked>;

  const real* x = nullptr;
  const real* y = nullptr;
  const real* z = nullptr;
  std::size_t count = 0;
  point_filter filter = {};

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD sample operator[](std::size_t i) const { return filter({x[i], y[i], z[i]}); }

  /// Four points, coordinate by coordinate; see `fetched_source`.
  struct alignas(16) row {
    real f[4];
  };
  struct four {
    row x, y, z;
  };
  CLEARANCE_HD bool fetches() const {
    const auto odd =
        reinterpret_cast<std::uintptr_t>(x) | reinterpret_cast<std::uintptr_t>(y) | reinterpret_cast<std::uintptr_t>(z);
    return odd % alignof(row) == 0;
  }
  using cursor = std::size_t;
  CLEARANCE_HD cursor seek(std::size_t i) const { return i / 4; }
  CLEARANCE_HD cursor skip(cursor c, std::size_t n) const { return c + n / 4; }
  CLEARANCE_HD four fetch(cursor c) const { return {load(x, c), load(y, c), load(z, c)}; }
  CLEARANCE_HD unsigned look(const four& r, std::size_t, vec3 (&out)[4]) const {
    real f[12];
    CLEARANCE_UNROLL
    for (int j = 0; j < 4; ++j) {
      f[3 * j] = r.x.f[j];
      f[3 * j + 1] = r.y.f[j];
      f[3 * j + 2] = r.z.f[j];
    }
    return filter.look(f, out);
  }

  CLEARANCE_HD bool unfiltered() const { return filter.plain(); }
  CLEARANCE_HD coordinate_arrays slice(std::size_t begin, std::size_t end) const {
    coordinate_arrays some = *this;
    some.x += begin;
    some.y += begin;
    some.z += begin;
    some.count = end - begin;
    return some;
  }

  /// One of the arrays, which a backend copies if it cannot read it; see `source_in_pieces`.
  struct column {
    const real* values;
    std::size_t count;

    std::size_t size() const { return count; }
    std::span<const std::byte> bytes() const { return std::as_bytes(std::span(values, count)); }
    column at(const std::byte* copy) const { return {reinterpret_cast<const real*>(copy), count}; }
  };
  template <class F>
  coordinate_arrays with_pieces(const F& f) const {
    coordinate_arrays same = *this;
    for (const real** array : {&same.x, &same.y, &same.z}) *array = f(column{*array, count}).values;
    return same;
  }
  /// See `rounding_of`.
  void check() const {
    filter.check();
    if (count != 0 && (x == nullptr || y == nullptr || z == nullptr))
      detail::refuse_source("a cloud of " + std::to_string(count) + " points has no " +
                            (x == nullptr   ? "x"
                             : y == nullptr ? "y"
                                            : "z") +
                            ": it is null");
  }

 private:
  CLEARANCE_HD static row load(const real* array, cursor c) {
    return read_only(reinterpret_cast<const row*>(array) + c);
  }
};

static_assert(fetched_source<coordinate_arrays> && unfiltered_source<coordinate_arrays> &&
              copied_memory<coordinate_arrays::column>);

}  // namespace clearance

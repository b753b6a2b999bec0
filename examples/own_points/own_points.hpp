// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points from memory of one's own layout: three arrays, as many simulations keep them. They are read in place.

#include <clearance/bvh/build.hpp>
#include <clearance/ground/read_only.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

// [source]
/// x, y and z in arrays of their own; a negative weight says that the entry is stale.
struct three_arrays {
  const float *x, *y, *z, *weight;
  std::size_t count;

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD clearance::sample operator[](std::size_t i) const {
    const clearance::vec3 p{x[i], y[i], z[i]};
    return {p, why(p, weight[i])};
  }

  // Enough so far. With these a device has four entries on their way while it looks at others, as of the library's
  // sources. In this list a misspelt one would be missed.
  using can = clearance::can<clearance::sources::fetched>;
  struct alignas(16) row {
    float of[4];
  };
  struct four {
    row x, y, z, weight;
  };
  using cursor = std::size_t;
  CLEARANCE_HD bool fetches() const {
    const auto aligned = [](const float* p) { return reinterpret_cast<std::uintptr_t>(p) % alignof(row) == 0; };
    return aligned(x) && aligned(y) && aligned(z) && aligned(weight);
  }
  CLEARANCE_HD cursor seek(std::size_t i) const { return i / 4; }
  CLEARANCE_HD cursor skip(cursor c, std::size_t n) const { return c + n / 4; }
  CLEARANCE_HD four fetch(cursor c) const { return {load(x, c), load(y, c), load(z, c), load(weight, c)}; }
  CLEARANCE_HD unsigned look(const four& f, std::size_t, clearance::vec3 (&at)[4]) const {
    unsigned reasons = 0;
    for (int j = 0; j < 4; ++j) {
      at[j] = {f.x.of[j], f.y.of[j], f.z.of[j]};
      reasons |= unsigned(why(at[j], f.weight.of[j])) << 8 * j;
    }
    return reasons;
  }

 private:
  CLEARANCE_HD static row load(const float* array, cursor c) {
    return clearance::read_only(reinterpret_cast<const row*>(array) + c);
  }
  CLEARANCE_HD static clearance::drop_reason why(clearance::vec3 p, float weight) {
    if (!clearance::is_finite(p)) return clearance::drop_reason::not_finite;
    return weight < 0 ? clearance::drop_reason::missing : clearance::drop_reason::none;
  }
};

static_assert(clearance::explain_point_source<three_arrays>() && clearance::fetched_source<three_arrays>);
// [source]

template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<float> x, y, z, weight;
  for (int k = 0; k < 100; ++k) x.push_back(2 - 0.01f * k), y.push_back(0), z.push_back(0), weight.push_back(1);
  weight[99] = -1;                  // the nearest is stale,
  x[98] = clearance::not_a_number;  // and the next is no number
  const std::vector<clearance::inner_sphere> spheres = {{{0, 0, 0}, 0.5f}};
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(spheres)).on(on);

  // [use]
  // The view must be readable where the query runs: here the arrays are copied there by hand.
  const auto in = [&](const std::vector<float>& array) { return on.copy_in(std::span<const float>(array)); };
  const auto xs = in(x), ys = in(y), zs = in(z), weights = in(weight);
  const three_arrays points{xs.data(), ys.data(), zs.data(), weights.data(), x.size()};
  const auto r = clearance::ask(on, part, Eigen::Isometry3d::Identity(), points, clearance::min_distance{});
  // [use]

  std::printf("%.6f m to point %u; %u of %u points count\n", r.distance, r.point, unsigned(r.valid), unsigned(r.seen));
  return r.point == 97 && r.distance == x[97] - 0.5f && r.valid == 98 && r.seen == 100 &&
                 r.dropped[int(clearance::drop_reason::missing)] == 1
             ? 0
             : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
#include "solid/shapes.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"

#include <clearance/packing/gap.hpp>
#include <clearance/packing/grid.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <algorithm>

namespace eight_test {

using namespace clearance;
using testing::dice;

namespace {

vec3d somewhere(dice& d, double half) {
  const double x = d.uniform(-half, half), y = d.uniform(-half, half), z = d.uniform(-half, half);
  return {x, y, z};
}

eighths cube_at(const vec3d& middle, double half) {
  return eighths([&](std::uint32_t k) { return eighth_middle(middle, half, k); });
}

/// Everywhere the same, or from 0 to twice that.
eight bounds(dice& d, double most) {
  eight made = eight::of(most);
  if (d.below(2) == 0)
    for (double& each : made.v) each = d.uniform(0, 2 * most);
  return made;
}

int differ(const eight& a, const eight& b) {
  int count = 0;
  for (int k = 0; k < 8; ++k) count += !(a.v[k] == b.v[k]);
  return count;
}

}  // namespace

TEST_CASE("a triangle is as far from eight places side by side as from each alone, to the bit") {
  dice d(1);
  int wrong = 0, lowered = 0;
  for (int i = 0; i < 20000; ++i) {
    const vec3d a = somewhere(d, 1);
    vec3d b = somewhere(d, 1), c = somewhere(d, 1);
    if (i % 4 == 1) c = a + 0.5 * (b - a) + 1e-9 * c;  // a needle
    if (i % 4 == 2) c = b;                             // a segment
    if (i % 64 == 3) b = c = a;                        // a point
    const exact_triangle t(a, b, c);
    const eighths at = cube_at(somewhere(d, 1.5), d.uniform(1e-3, 1));
    const eight before = bounds(d, i % 3 == 0 ? double(infinity) : d.uniform(0, 1.5));
    eight together = before, alone = before;
    t.nearer(at, together);
    for (int k = 0; k < 8; ++k) alone.v[k] = t.nearer(at[k], alone.v[k]);
    wrong += differ(together, alone), lowered += differ(together, before);
  }
  CHECK(wrong == 0);
  CHECK(lowered > 20000);
}

TEST_CASE("a sphere is as far from eight places side by side as from each alone, to the bit") {
  dice d(2);
  int wrong = 0, lowered = 0;
  for (int i = 0; i < 20000; ++i) {
    const solid_sphere s{somewhere(d, 1), d.uniform(0, 1)};
    const eighths at = cube_at(somewhere(d, 1.5), d.uniform(1e-3, 1));
    eight before = bounds(d, d.uniform(-1, 1));
    if (i % 5 == 0) before = eight::of(i % 2 ? double(infinity) : -double(infinity));
    eight together = before, alone = before;
    s.nearer(at, together);
    for (int k = 0; k < 8; ++k) alone.v[k] = s.nearer(at[k], alone.v[k]);
    wrong += differ(together, alone), lowered += differ(together, before);
  }
  CHECK(wrong == 0);
  CHECK(lowered > 20000);
}

TEST_CASE("a cube's eighths have the depths and gaps that each has alone") {
  const mesh_solid solid(
      shapes::merged(shapes::box({-1, -0.7, -0.9}, {1, 0.7, 0.9}), shapes::globe({0.5, 0.7, 0.5}, 0.6)));
  dice d(3);
  const host on;
  spheres_there<host> spheres(on);
  for (int i = 0; i < 300; ++i) {
    const solid_sphere one{somewhere(d, 1), d.uniform(0.001, 0.1)};
    spheres.insert(std::span(&one, 1));
    if (i == 200) spheres.plant(0);  // the last 99 stay in the list
  }
  const auto room = spheres.room_in(solid.view());
  int wrong = 0, inside = 0, unasked = 0;
  for (int i = 0; i < 2000; ++i) {
    const vec3d middle = somewhere(d, 1.2);
    const double half = d.uniform(1e-3, 0.2), reach = corner_reach(half / 2);
    const eighths at = cube_at(middle, half);
    const double known = i % 3 == 0 ? 0 : signed_depth(solid.view(), middle, 0, 0);
    eight depth = eight::of(1);
    for (double& each : depth.v) each = d.below(4) == 0 ? 0 : 1;
    const eight asked = depth;
    signed_depths(solid.view(), at, known, reach, depth);
    eight gap = bounds(d, i % 2 ? double(infinity) : 0.2);
    const eight within = gap;
    const double enough = d.uniform(-0.1, 0.05);
    room.gaps(at, gap, enough);
    for (int k = 0; k < 8; ++k) {
      const double alone = room.gap(at[k], within.v[k]);
      wrong += gap.v[k] <= enough ? !(alone <= enough) : gap.v[k] != alone;
      if (asked.v[k] == 0)
        unasked += depth.v[k] == 0;
      else
        wrong += depth.v[k] != signed_depth(solid.view(), at[k], known, reach);
      inside += depth.v[k] > 0;
    }
  }
  CHECK(wrong == 0);
  CHECK(inside > 1000);
  CHECK(unasked > 1000);
}

TEST_CASE("cells come by their keys, the earlier of equal ones first, however many wait") {
  dice d(4);
  host_steps steps{host{}};
  std::vector<double> keys(3000);
  for (double& key : keys) key = d.below(20) == 0 ? -1 : std::floor(d.uniform(1, 40)) / 8;
  std::vector<std::uint32_t> some(8000);
  std::vector<std::uint32_t> turn(keys.size(), 0);  // by cell, when it was added
  std::uint32_t turns = 0;
  for (std::uint32_t i = 0; i < keys.size(); ++i)
    if (keys[i] > 0) turn[i] = turns++;
  std::size_t calls = 0;
  for (; calls < 5000; ++calls) {
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t i = 0; i < keys.size(); ++i)
      if (keys[i] > 0) waiting.push_back(i);
    std::ranges::sort(waiting,
                      [&](auto a, auto b) { return keys[a] != keys[b] ? keys[a] > keys[b] : turn[a] < turn[b]; });
    double least = 0;
    const std::size_t count = steps.next(keys.data(), keys.size(), 100, some.data(), least);
    if (waiting.empty()) {
      CHECK(count == 0);
      break;
    }
    const double top = keys[waiting[0]];
    std::size_t wanted = 0;
    while (wanted < std::min<std::size_t>(100, waiting.size()) && keys[waiting[wanted]] >= 0.98 * top) ++wanted;
    REQUIRE(count == wanted);
    REQUIRE(std::equal(some.begin(), some.begin() + std::ptrdiff_t(count), waiting.begin()));
    CHECK(least == 0.93 * top);
    for (std::size_t k = 0; k < count; ++k) {  // a cell comes again with a lower key, or leaves; children come
      const std::uint32_t i = some[k];
      keys[i] = d.below(2) || keys[i] < 0.1 ? -1 : keys[i] * d.uniform(0.5, 1);
      if (keys[i] > 0) turn[i] = turns++;
    }
    if (keys.size() < 6000)
      for (int k = 0; k < 8; ++k) keys.push_back(top * d.uniform(0.3, 1)), turn.push_back(turns++);
  }
  CHECK(calls > 100);
}

}  // namespace eight_test

// SPDX-License-Identifier: BSD-3-Clause
// A device's tree over points has each valid point once, and encloses it.
#include "support/catch.hpp"
#include "support/laws.hpp"
#include "support/random.hpp"

#include <clearance/cloud_tree/device_sums.cuh>
#include <clearance/points/point_span.hpp>

#include <algorithm>

namespace device_tree_test {

using namespace testing;
using clearance::device, clearance::point_span;

/// Checks the tree of `points`, built by `built`, which is kept for the next.
void check(clearance::cloud_tree::device_tree& built, const std::vector<vec3>& points, verdict& v,
           const std::string& what) {
  const device gpu;
  const auto there = gpu.copy_in(std::span<const vec3>(points));
  const clearance::scan::drop_counts none_yet;
  const auto counts = gpu.copy_in(std::span(&none_yet, 1));
  built.build(point_span(there.data(), there.size()), counts.data());
  const auto tree = built.view();
  const auto found = gpu.copy_out(tree.points, tree.count);
  const auto balls = gpu.copy_out(tree.balls, tree.nodes());
  const auto boxes = gpu.copy_out(tree.boxes, tree.nodes());
  const auto least = gpu.copy_out(tree.least, tree.nodes());
  std::vector<int> times(points.size());
  std::size_t valid = 0, off = 0;
  for (const auto& p : found)
    if (p.number != clearance::none) ++times[p.number], off += !(p.at == points[p.number]);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool counts_it = point_span(points)[i].valid();
    valid += counts_it;
    v.require(times[i] == int(counts_it), what, ": point", i, "is there", times[i], "times");
  }
  v.require(off == 0, what, ": points elsewhere");
  std::uint64_t dropped = 0;
  const auto told = gpu.copy_out(counts);
  for (const auto n : told[0].dropped) dropped += n;
  v.require(dropped + valid == points.size(), what, ": ", dropped, "dropped");
  for (std::uint32_t level = 0; level < tree.levels; ++level)
    for (std::uint32_t n = 0; n < tree.size(level); ++n) {
      const std::uint32_t me = tree.begin[level] + n;
      std::uint32_t lowest = clearance::none;
      const auto in_box = [&](vec3 low, vec3 high) {
        const auto& box = boxes[me];
        return box.lower.x <= low.x && box.lower.y <= low.y && box.lower.z <= low.z && high.x <= box.upper.x &&
               high.y <= box.upper.y && high.z <= box.upper.z;
      };
      bool inside = true;
      for (std::uint32_t j = tree.first_below(level, n); j < tree.end_below(level, n); ++j) {
        if (level == 0) {
          const auto& p = found[j];
          if (p.number == clearance::none) continue;
          lowest = std::min(lowest, p.number);
          inside &= in_box(p.at, p.at) && length(p.at - balls[me].center) <= balls[me].radius;
        } else {
          const std::uint32_t its = tree.begin[level - 1] + j;
          if (!(balls[its].radius >= 0)) continue;
          lowest = std::min(lowest, least[its]);
          inside &= in_box(boxes[its].lower, boxes[its].upper);
        }
      }
      v.require(inside && lowest == least[me] && (balls[me].radius >= 0) == (lowest != clearance::none), what,
                ": level", level, ", node", n);
    }
  if (points.size() < 100000) return;
  std::size_t large = 0;  // neighbours in space are neighbours in memory, but for what is far
  for (std::uint32_t n = 0; n < tree.size(0); ++n) large += balls[n].radius > 0.1f;
  v.require(large < tree.size(0) / 4, what, ": ", large, "tiles of", tree.size(0), "are large");
}

TEST_CASE("A device's tree has each valid point once, inside of its nodes, with the lowest number") {
  verdict v;
  dice d(541);
  clearance::cloud_tree::device_tree tree{device{}};
  for (const std::size_t n : {1u, 7u, 8u, 9u, 511u, 512u, 513u, 4097u, 300000u, 20000u}) {
    auto points = d.points(n, 1);
    check(tree, points, v, std::to_string(n) + " points");
    for (std::size_t i = 0; i < n; i += 5) points[i].y = clearance::not_a_number;
    points[n / 2] = {1e9f, -1e9f, 3e8f};
    check(tree, points, v, std::to_string(n) + " points, some invalid, one far");
    for (vec3& p : points) p = points[0];
    check(tree, points, v, std::to_string(n) + " equal points");
    points.assign(n, {1, 2, 3});
    check(tree, points, v, std::to_string(n) + " equal valid points");
  }
}

TEST_CASE("So has one of so many points that many blocks make its upper levels") {
  verdict v;
  dice d(542);
  clearance::cloud_tree::device_tree tree{device{}};
  check(tree, d.points(9000001, 1), v, "9 million points");
}

}  // namespace device_tree_test

// SPDX-License-Identifier: BSD-3-Clause
// The least that a point source, an answer and a part must offer to the operations; and a foreign backend.
#include <clearance/backend/host.hpp>
#include <clearance/bvh/build.hpp>
#include <clearance/questions/collect.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/volume/sphere.hpp>

namespace {

struct least_source {
  CLEARANCE_HD std::size_t size() const { return 3; }
  CLEARANCE_HD clearance::sample operator[](std::size_t i) const { return {{float(i) + 2, 0, 0}}; }
};

static_assert(clearance::explain_point_source<least_source>());

struct least_answer {
  int* pairs;
  CLEARANCE_HD clearance::real reach(std::uint32_t) const { return 2; }
  CLEARANCE_HD void take(const clearance::pair_distance&) const { ++*pairs; }
};

static_assert(clearance::explain_answer<least_answer>());

}  // namespace

/// One thread, and memory that remembers nothing: it takes the plain loop.
struct in_line : clearance::host {
  template <class F>
  void for_ranges(std::size_t n, F body) const {
    body(clearance::indices{0, n, 1});
  }
  template <class F>
  void for_each(std::size_t n, F body) const {
    for (std::size_t i = 0; i < n; ++i) body(i);
  }
};
static_assert(clearance::backend<in_line>);

int main() {
  const std::vector<clearance::inner_sphere> ball = {{{0, 0, 0}, 1}};
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(ball));
  const auto r = clearance::ask(clearance::host{}, part, Eigen::Isometry3d::Identity(), least_source{}, clearance::min_distance{});
  const auto same = clearance::ask(in_line{}, part, Eigen::Isometry3d::Identity(), least_source{}, clearance::min_distance{});
  const clearance::model robot{std::vector{part}};
  const std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d::Identity()};
  int pairs = 0, in_line_pairs = 0;
  const auto seen = clearance::ask(clearance::host{1}, robot, poses, least_source{}, clearance::collect{least_answer{&pairs}});
  clearance::ask(in_line{}, robot, poses, least_source{}, clearance::collect{least_answer{&in_line_pairs}});
  const auto each = clearance::ask(in_line{}, robot, poses, least_source{}, clearance::distances{.d_max = 2});
  if (each.distance != std::vector<float>{1, 2, clearance::infinity} || each.counts.valid != 3) return 2;
  const auto rest = clearance::min_distance_filtered(in_line{}, robot, poses, least_source{}, {.padding = {1.5}});
  if (rest.rest.distance != 2 || rest.filter.counts.own != 1 || rest.filter.rest.size() != 2) return 3;
  const auto nearest = clearance::ask(in_line{}, robot, poses, least_source{}, clearance::nearest_k{2});
  if (nearest.of(0)[1].distance != 2) return 4;
  if (clearance::ask(in_line{}, robot, poses, least_source{}, clearance::min_distance_supported{.min_points = 3, .radius = 1})
          .distance != 2)
    return 5;
  return r.distance == 1 && same.distance == 1 && pairs == 2 && in_line_pairs == 2 && seen.valid == 3 ? 0 : 1;
}

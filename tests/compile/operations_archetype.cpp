// SPDX-License-Identifier: BSD-3-Clause
// The least that a point source, an answer, a tally, a question and a part must offer; and a foreign backend.
#include <clearance/backends/host.hpp>
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/collect.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/min_distance_filtered.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/nearest_k.hpp>
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

/// What the loop over points keeps, at the least.
struct least_tally {
  int* walks;
  CLEARANCE_HD clearance::real reach(std::uint32_t) const { return 2; }
  CLEARANCE_HD clearance::real reach_of_pair(std::uint32_t, std::uint32_t) const { return 2; }
  CLEARANCE_HD bool settled(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool touched(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD bool ended(std::uint32_t) const { return false; }
  CLEARANCE_HD bool foresees(std::uint32_t, std::uint32_t, clearance::vec3, bool, const clearance::nearest&) const {
    return false;
  }
  CLEARANCE_HD bool take_inside(std::uint32_t, std::uint32_t) const { return false; }
  CLEARANCE_HD void take_certain() const {}
  CLEARANCE_HD clearance::nearest visitor(std::uint32_t, std::uint32_t) const { return {2}; }
  CLEARANCE_HD void take(std::uint32_t, std::uint32_t, const clearance::nearest& its) const {
    *walks += its.best != clearance::nearest::none;
  }
};
static_assert(clearance::explain_tally<least_tally>());

/// How many pairs are near, at the least: no pieces and no deadline.
struct least_question {
  using result = int;
  struct out {
    int* pairs;
    clearance::point_counts* counts;
  };
  template <class Asked>
  out space(const Asked& a) const {
    return {a.template space<int>(1), a.template space<clearance::point_counts>(1)};
  }
  template <class Asked>
  least_answer prepare(const Asked&, const out& to) const {
    *to.pairs = 0;
    return {to.pairs};
  }
  template <class Asked>
  int read(const Asked& a, const out& from) const {
    return a.copy_out(from.pairs, 1)[0];
  }
};
static_assert(clearance::explain_question<least_question>() && !clearance::merging_question<least_question>);

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
  const auto r =
      clearance::ask(clearance::host{}, part, Eigen::Isometry3d::Identity(), least_source{}, clearance::min_distance{});
  const auto same =
      clearance::ask(in_line{}, part, Eigen::Isometry3d::Identity(), least_source{}, clearance::min_distance{});
  const clearance::model robot{std::vector{part}};
  const std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d::Identity()};
  int pairs = 0, in_line_pairs = 0;
  const auto seen =
      clearance::ask(clearance::host{1}, robot, poses, least_source{}, clearance::collect{least_answer{&pairs}});
  clearance::ask(in_line{}, robot, poses, least_source{}, clearance::collect{least_answer{&in_line_pairs}});
  const auto each = clearance::ask(in_line{}, robot, poses, least_source{}, clearance::distances{.d_max = 2});
  if (each.distance != std::vector<float>{1, 2, clearance::infinity} || each.counts.valid != 3) return 2;
  const auto rest = clearance::min_distance_filtered(in_line{}, robot, poses, least_source{}, {.padding = {1.5}});
  if (rest.rest.distance != 2 || rest.filter.counts.own != 1 || rest.filter.rest.size() != 2) return 3;
  const auto nearest = clearance::ask(in_line{}, robot, poses, least_source{}, clearance::nearest_k{2});
  if (nearest.of(0)[1].distance != 2) return 4;
  if (clearance::ask(in_line{}, robot, poses, least_source{},
                     clearance::min_distance_supported{.min_points = 3, .radius = 1})
          .distance != 2)
    return 5;
  if (clearance::ask(clearance::host{1}, robot, poses, least_source{}, least_question{}) != 2) return 6;
  int walks = 0;
  clearance::point_counts counts;
  clearance::scan::plain_pass(
      in_line{}, robot.view(), poses, least_source{}, [&](const auto&, const auto&) { return least_tally{&walks}; },
      &counts, clearance::frames::as_it_is{});
  if (walks != 2 || counts.valid != 3) return 7;
  return r.distance == 1 && same.distance == 1 && pairs == 2 && in_line_pairs == 2 && seen.valid == 3 ? 0 : 1;
}

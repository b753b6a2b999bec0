// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a question needs, or an engine: template <class Asked> result read(const Asked&, const out&) const
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/query/query.hpp>
#include <clearance/volume/sphere.hpp>

struct farthest {
  CLEARANCE_HD clearance::real reach(std::uint32_t) const { return 1; }
  CLEARANCE_HD void take(const clearance::pair_distance&) const {}
};

struct other_result {
  using result = int;
  struct out {
    clearance::point_counts* counts;
  };
  template <class Asked>
  out space(const Asked& a) const {
    return {a.template space<clearance::point_counts>(1)};
  }
  template <class Asked>
  farthest prepare(const Asked&, const out&) const {
    return {};
  }
  template <class Asked>
  double read(const Asked&, const out&) const {
    return 0;
  }
};

int near(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  return clearance::ask(clearance::host{}, robot, std::vector{Eigen::Isometry3d::Identity()}, points, other_result{});
}

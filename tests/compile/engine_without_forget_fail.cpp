// SPDX-License-Identifier: BSD-3-Clause
// expected-error: an engine needs: void forget(), which may do nothing
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/query/query.hpp>
#include <clearance/volume/sphere.hpp>

struct remembering {
  using result = int;
  template <class On, class PartView>
  struct engine {
    engine(const On&, const clearance::model_view<PartView>&) {}
    template <class Clouds>
    void begin(std::span<const Eigen::Isometry3d>, const Clouds&, const remembering&) {}
    int finish() { return 0; }
  };
};

int asked(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  return clearance::ask(clearance::host{}, robot, std::vector{Eigen::Isometry3d::Identity()}, points, remembering{});
}

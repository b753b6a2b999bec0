// SPDX-License-Identifier: BSD-3-Clause
// expected-error: an engine needs: result finish(), or const result& finish(), for the frame that began
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/query/query.hpp>
#include <clearance/volume/sphere.hpp>

struct unfinished {
  using result = int;
  template <class On, class PartView>
  struct engine {
    engine(const On&, const clearance::model_view<PartView>&) {}
    template <class Clouds>
    void begin(std::span<const Eigen::Isometry3d>, const Clouds&, const unfinished&) {}
    void forget() {}
  };
};

int asked(const std::vector<std::vector<clearance::inner_sphere>>& links, clearance::point_span points) {
  const auto robot = clearance::make_model<clearance::sphere>(links);
  return clearance::ask(clearance::host{}, robot, std::vector{Eigen::Isometry3d::Identity()}, points, unfinished{});
}

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "robot_on.hpp"

#include <clearance/questions/min_distances.hpp>

#include <algorithm>

/// For a model that is kept elsewhere. Poses go to the backend only if they are new.
template <class Backend, class Model>
class plan_of final : public prepared_plan {
 public:
  plan_of(const Backend& on, const Model& model) : query_(on, model, {}) {}

  const clearance::min_distances_result& ask(poses_of poses, const std::vector<placed_points>& clouds,
                                             double d_max) override {
    const clearance::min_distances options{.d_max = clearance::real(d_max)};
    if constexpr (requires { query_.place(poses); }) {
      if (!std::ranges::equal(poses, placed_, [](const auto& a, const auto& b) { return a.matrix() == b.matrix(); })) {
        query_.place(poses);
        placed_.assign(poses.begin(), poses.end());
      }
      return query_(clouds, options);
    } else {
      return query_(poses, clouds, options);
    }
  }

 private:
  prepared_for<clearance::min_distances, Backend, Model> query_;
  std::vector<Eigen::Isometry3d> placed_;
};

template <class Backend>
clearance::min_distances_result robot_on_backend<Backend>::plan(poses_of poses, double d_max) {
  if (!planned_)
    planned_ = with_usual_trees([&]<class Model>(const Model& model) -> std::unique_ptr<prepared_plan> {
      return std::make_unique<plan_of<Backend, Model>>(on_, model);
    });
  stopwatch clock;
  const clearance::min_distances_result& found = planned_->ask(poses, clouds_, d_max);
  query = clock.lap();
  return found;
}

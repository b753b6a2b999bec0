// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "robot_on.hpp"

#include <clearance/questions/min_distances_per_part.hpp>

#include <algorithm>
#include <optional>

/// One question about many configurations, prepared. Poses go to the backend only if they are new.
template <class Q, class Backend, class Model>
class placed_question {
 public:
  placed_question(const Backend& on, const Model& model) : query_(on, model, {}) {}

  template <class Clouds>
  const typename Q::result& operator()(poses_of poses, const Clouds& clouds, const Q& options) {
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
  prepared_for<Q, Backend, Model> query_;
  std::vector<Eigen::Isometry3d> placed_;
};

/// For a model that is kept elsewhere.
template <class Backend, class Model>
class plan_of final : public prepared_plan<Backend> {
 public:
  plan_of(const Backend& on, const Model& model) : on_(on), model_(model), least_(on, model) {}

  const clearance::min_distances_result& ask(poses_of poses, const placed_points<Backend>& clouds,
                                             double d_max) override {
    return least_(poses, clouds, {.d_max = clearance::real(d_max)});
  }
  const clearance::min_distances_per_part_result& certain(poses_of poses, const uncertain_points<Backend>& clouds,
                                                          const clearance::min_distances_per_part& options) override {
    if (!certain_) certain_.emplace(on_, model_);
    return (*certain_)(poses, clouds, options);
  }

 private:
  Backend on_;
  const Model& model_;
  placed_question<clearance::min_distances, Backend, Model> least_;
  std::optional<placed_question<clearance::min_distances_per_part, Backend, Model>> certain_;
};

template <class Backend>
prepared_plan<Backend>& robot_on_backend<Backend>::planned() {
  if (!planned_)
    planned_ = with_usual_trees([&]<class Model>(const Model& model) -> std::unique_ptr<prepared_plan<Backend>> {
      return std::make_unique<plan_of<Backend, Model>>(on_, model);
    });
  return *planned_;
}

template <class Backend>
clearance::min_distances_result robot_on_backend<Backend>::plan(poses_of poses, double d_max) {
  prepared_plan<Backend>& asked = planned();
  stopwatch clock;
  const clearance::min_distances_result& found = asked.ask(poses, clouds_, d_max);
  query = clock.lap();
  return found;
}

template <class Backend>
clearance::min_distances_per_part_result robot_on_backend<Backend>::certain_plan(poses_of poses, double d_max,
                                                                                 const std::vector<double>& radii) {
  prepared_plan<Backend>& asked = planned();
  stopwatch clock;
  const clearance::min_distances_per_part_result& found = asked.certain(poses, until_end_, {d_max, radii});
  query = clock.lap();
  return found;
}

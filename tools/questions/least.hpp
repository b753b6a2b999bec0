// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance, with trees of every volume, because there their cost is the question; and with a deadline.

#include "trees.hpp"

#include <clearance/deadline.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>

#include <algorithm>

/// For a model that is kept elsewhere, or in `keeps`.
template <class Backend, class Model>
class query_of final : public prepared_query<Backend> {
 public:
  query_of(const Backend& on, const Model& model, std::shared_ptr<const Model> keeps = {})
      : keeps_(std::move(keeps)), least_(on, model, {}), each_(on, model, {}) {}

  clearance::min_distance_result least(poses_of poses, const placed_points<Backend>& clouds) override {
    return least_(poses, clouds);
  }
  reply least_per_part(poses_of poses, const placed_points<Backend>& clouds) override {
    const auto& [all, parts] = each_(poses, clouds);
    return {all, parts};
  }
  void forget() override { each_.forget(); }

 private:
  std::shared_ptr<const Model> keeps_;
  prepared_for<clearance::min_distance, Backend, Model> least_;
  prepared_for<clearance::min_distance_per_part, Backend, Model> each_;
};

template <class Backend>
prepared_query<Backend>& robot_on_backend<Backend>::prepared() {
  if (prepared_) return *prepared_;
  const auto own = [&]<class Model>(Model model) {
    const auto kept = std::make_shared<const Model>(std::move(model));
    prepared_ = std::make_unique<query_of<Backend, Model>>(on_, *kept, kept);
  };
  if (asked_.model == model_kind::spheres) {
    if (asked_.volume == volume_kind::aabb) own(moved(trees_of_spheres<clearance::aabb>));
    if (asked_.volume == volume_kind::obb) own(moved(trees_of_spheres<clearance::obb>));
  } else {
    if (asked_.volume == volume_kind::sphere) own(moved(trees_of_triangles<clearance::sphere>));
    if (asked_.volume == volume_kind::aabb) own(moved(trees_of_triangles<clearance::aabb>));
  }
  if (!prepared_)
    prepared_ = with_usual_trees([&]<class Model>(const Model& model) -> std::unique_ptr<prepared_query<Backend>> {
      return std::make_unique<query_of<Backend, Model>>(on_, model);
    });
  return *prepared_;
}

template <class Backend>
reply robot_on_backend<Backend>::least(poses_of poses) {
  prepared_query<Backend>& asked = prepared();
  stopwatch clock;
  reply out{asked.least(poses, clouds_), {}};
  query = clock.lap();
  return out;
}

template <class Backend>
reply robot_on_backend<Backend>::least_per_part(poses_of poses, int repeat) {
  prepared_query<Backend>& asked = prepared();
  reply out;
  double spent = 0;
  stopwatch clock;
  for (int round = 0; round < repeat && spent < 0.3; ++round) {
    asked.forget();
    clock.lap();
    out = asked.least_per_part(poses, clouds_);
    const double seconds = clock.lap();
    spent += seconds;
    query = round == 0 ? seconds : std::min(query, seconds);
  }
  return out;
}

template <class Backend>
reply robot_on_backend<Backend>::least_by(poses_of poses, double deadline) {
  double seconds = 0;
  reply out = with_usual_trees([&](const auto& trees) {
    // With every part's, as in `least_per_part`: a complete answer then has the same lower end.
    const clearance::min_distance_per_part each;
    clearance::query asked(on_, trees, each);  // prepared before the clock starts
    stopwatch clock;
    const auto known = clearance::ask_by(asked, poses, clouds_, std::chrono::duration<double>(deadline), each);
    seconds = clock.lap();
    return reply{known.result.all, {}, known.unseen};
  });
  out.parts.resize(asked_.bodies->size());
  query = seconds;
  return out;
}

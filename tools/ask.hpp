// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a question to the library's templates, for whichever backend includes this.

#include "backends.hpp"
#include "stopwatch.hpp"

#include <clearance/make_model.hpp>
#include <clearance/min_distance_query.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

/// A cloud as the library takes it.
using placed_points = std::variant<clearance::placed<clearance::point_span>, clearance::placed<clearance::depth_image<std::uint16_t>>>;

/// They where `on` can read them; `copies` keeps what had to be copied.
template <class Backend>
std::vector<placed_points> here(const Backend& on, const std::vector<seen_points>& clouds, clearance::minimum::cloud_copies<Backend>& copies) {
  const clearance::minimum::readable_on<Backend> readable{on, copies};
  std::vector<placed_points> there;
  for (const seen_points& cloud : clouds)
    there.push_back(std::visit([&](const auto& source) { return placed_points(clearance::placed{readable(source, std::uint32_t(there.size())), cloud.pose}); },
                               cloud.points));
  return there;
}

template <class Backend, class Part>
reply ask_model(const Backend& on, const question& asked, const clearance::model<Part>& built) {
  reply out;
  stopwatch clock;
  const auto model = built.on(on);
  clearance::minimum::cloud_copies<Backend> copies;
  const std::vector<placed_points> clouds = here(on, asked.clouds, copies);
  clearance::min_distance_query query(on, model);
  on.wait();
  out.upload = clock.lap();
  out.parts.resize(model.size());
  double spent = 0;
  for (int round = 0; round < asked.repeat && spent < 0.3; ++round) {
    query.forget();
    clock.lap();
    out.result = query.per_part(asked.poses, clouds, out.parts);
    const double seconds = clock.lap();
    spent += seconds;
    out.query = round == 0 ? seconds : std::min(out.query, seconds);
  }
  return out;
}

/// The library's prepared query over a model of its own.
template <class Backend, class Model>
class prepared final : public prepared_question {
 public:
  prepared(const Backend& on, Model model) : on_(on), model_(std::move(model)), query_(on_, model_) {}

  double see(const seen_points& cloud) override {
    stopwatch clock;
    copies_.clear();
    cloud_ = here(on_, std::vector{cloud}, copies_)[0];
    on_.wait();
    return clock.lap();
  }

  reply ask(const std::vector<Eigen::Isometry3d>& poses) override {
    reply out;
    stopwatch clock;
    out.result = query_(poses, cloud_);
    out.query = clock.lap();
    return out;
  }

 private:
  Backend on_;
  Model model_;
  decltype(clearance::min_distance_query(std::declval<const Backend&>(), std::declval<const Model&>())) query_;
  placed_points cloud_;
  clearance::minimum::cloud_copies<Backend> copies_;
};

/// Calls `use` with the model that is asked for, in host memory.
template <class V, class Use>
auto with_volume(const question& asked, Use use) {
  const auto& bodies = *asked.bodies;
  const auto tolerance = [&](std::size_t k) { return clearance::part_options{.tolerance = bodies[k].tolerance}; };
  if (asked.model == model_kind::spheres)
    return use(clearance::make_model<V>(bodies | std::views::transform(&body::packed), tolerance));
  return use(clearance::make_model<V>(bodies | std::views::transform(&body::closed), tolerance));
}

template <class Use>
auto with_model(const question& asked, Use use) {
  switch (asked.volume) {
    case volume_kind::sphere: return with_volume<clearance::sphere>(asked, use);
    case volume_kind::aabb: return with_volume<clearance::aabb>(asked, use);
    default: return with_volume<clearance::obb>(asked, use);
  }
}

template <class Backend>
reply ask(const Backend& on, const question& asked) {
  stopwatch clock;
  return with_model(asked, [&](const auto& built) {
    const double seconds = clock.lap();
    reply out = ask_model(on, asked, built);
    out.build = seconds;
    return out;
  });
}

template <class Backend>
std::unique_ptr<prepared_question> prepare(const Backend& on, const question& asked) {
  return with_model(asked, [&](const auto& built) -> std::unique_ptr<prepared_question> {
    auto model = built.on(on);
    return std::make_unique<prepared<Backend, decltype(model)>>(on, std::move(model));
  });
}

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a question to the library's templates, for whichever backend includes this.

#include "backends.hpp"
#include "stopwatch.hpp"

#include <clearance/make_part.hpp>
#include <clearance/min_distance_query.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

template <class Backend, class Part>
answer ask_model(const Backend& on, const question& asked, const clearance::model<Part>& built) {
  answer out;
  stopwatch clock;
  const auto model = built.on(on);
  std::vector<typename Backend::template buffer<std::byte>> copies;
  std::vector<seen_points> clouds = asked.clouds;
  for (auto& cloud : clouds)
    std::visit(
        [&](auto& source) {
          if (source.size() == 0 || on.reads(source.bytes().data())) return;
          copies.push_back(on.copy_in(source.bytes()));
          source = source.at(copies.back().data());
        },
        cloud.points);
  auto result = on.template make_scratch<clearance::min_distance_result>(1);
  auto minima = on.template make_scratch<clearance::part_minimum>(model.size());
  on.wait();
  out.upload = clock.lap();
  double spent = 0;
  for (int round = 0; round < asked.repeat && spent < 0.3; ++round) {
    clock.lap();
    clearance::minimum_search search(on, model.view(), asked.poses, clearance::near_first{}, result.data(), minima.data());
    for (const auto& cloud : clouds) std::visit([&](const auto& source) { search.add(source, cloud.pose); }, cloud.points);
    search.conclude();
    out.result = on.copy_out(result.data(), 1)[0];
    out.parts = on.copy_out(minima.data(), minima.size());
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
    cloud_ = cloud;
    std::visit(
        [&](auto& source) {
          if (source.size() == 0 || on_.reads(source.bytes().data())) return;
          copy_ = on_.copy_in(source.bytes());
          source = source.at(copy_.data());
        },
        cloud_.points);
    on_.wait();
    return clock.lap();
  }

  answer ask(const std::vector<Eigen::Isometry3d>& poses) override {
    answer out;
    stopwatch clock;
    out.result = std::visit([&](const auto& source) { return query_(poses, source, cloud_.pose); }, cloud_.points);
    out.query = clock.lap();
    return out;
  }

 private:
  Backend on_;
  Model model_;
  decltype(clearance::min_distance_query(std::declval<const Backend&>(), std::declval<const Model&>())) query_;
  seen_points cloud_;
  typename Backend::template buffer<std::byte> copy_;
};

/// Calls `use` with the model that is asked for, in host memory.
template <class V, class Use>
auto with_volume(const question& asked, Use use) {
  const auto with = [&](auto make) {
    std::vector<decltype(make((*asked.bodies)[0]))> parts;
    for (const body& b : *asked.bodies) parts.push_back(make(b));
    return use(clearance::model(std::move(parts)));
  };
  if (asked.model == model_kind::spheres)
    return with([](const body& b) { return clearance::make_part<V>(b.packed, {.tolerance = b.tolerance}); });
  return with([](const body& b) { return clearance::make_part<V>(b.closed, {.tolerance = b.tolerance}); });
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
answer ask(const Backend& on, const question& asked) {
  stopwatch clock;
  return with_model(asked, [&](const auto& built) {
    const double seconds = clock.lap();
    answer out = ask_model(on, asked, built);
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

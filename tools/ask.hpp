// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From a question to the library's templates, for whichever backend includes this.

#include "backends.hpp"
#include "stopwatch.hpp"

#include <clearance/make_part.hpp>
#include <clearance/min_distance.hpp>
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

template <class V, class Backend>
answer ask_volume(const Backend& on, const question& asked) {
  stopwatch clock;
  const auto with = [&](auto make) {
    std::vector<decltype(make((*asked.bodies)[0]))> parts;
    for (const body& b : *asked.bodies) parts.push_back(make(b));
    const clearance::model built(std::move(parts));
    const double seconds = clock.lap();
    answer out = ask_model(on, asked, built);
    out.build = seconds;
    return out;
  };
  if (asked.model == model_kind::spheres)
    return with([](const body& b) { return clearance::make_part<V>(b.packed, {.tolerance = b.tolerance}); });
  return with([](const body& b) { return clearance::make_part<V>(b.closed, {.tolerance = b.tolerance}); });
}

template <class Backend>
answer ask(const Backend& on, const question& asked) {
  switch (asked.volume) {
    case volume_kind::sphere: return ask_volume<clearance::sphere>(on, asked);
    case volume_kind::aabb: return ask_volume<clearance::aabb>(on, asked);
    default: return ask_volume<clearance::obb>(on, asked);
  }
}

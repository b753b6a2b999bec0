// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Trees of bodies, and clouds, where one backend reads them.

#include "../stopwatch.hpp"
#include "asked.hpp"

#include <clearance/frames/readable.hpp>
#include <clearance/io/field_cache.hpp>
#include <clearance/io/robot_bodies.hpp>
#include <clearance/make_model.hpp>
#include <clearance/near_maps.hpp>

#include <ranges>

/// The trees of all bodies, in host memory.
template <class V>
auto trees_of_spheres(const std::vector<body>& bodies) {
  return clearance::make_model<V>(bodies | std::views::transform(&body::packed), [&](std::size_t k) {
    return clearance::part_options{.tolerance = bodies[k].tolerance};
  });
}
template <class V>
auto trees_of_triangles(const std::vector<body>& bodies) {
  return clearance::make_model<V>(bodies | std::views::transform(&body::closed), [&](std::size_t k) {
    return clearance::part_options{.tolerance = bodies[k].tolerance};
  });
}

template <class Backend>
class memory_on final : public backend_memory {
 public:
  memory_on(const Backend& on, const asked_model& asked) : on_(on), asked_(asked) {}

  std::vector<cloud> put(const std::vector<cloud>& clouds) override {
    copies_.clear();
    const clearance::frames::readable_on<Backend> readable{on_, copies_};
    std::vector<cloud> readable_clouds;
    clearance::for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d& pose) {
      readable_clouds.push_back(clearance::placed{readable(source, std::uint32_t(readable_clouds.size())), pose});
    });
    on_.wait();
    return readable_clouds;
  }

  std::shared_ptr<const void> usual() override {
    if (usual_) return usual_;
    if (asked_.model == model_kind::spheres)
      usual_ = std::make_shared<const trees>(
          moved([&](const auto& b) { return mapped(trees_of_spheres<clearance::sphere>(b)); }));
    else
      usual_ = std::make_shared<const trees>(
          moved([&](const auto& b) { return mapped(trees_of_triangles<clearance::obb>(b)); }));
    return usual_;
  }
  std::shared_ptr<const void> other() override {
    if (other_) return other_;
    const auto keep = [&](auto make) { other_ = std::make_shared<const other_trees<Backend>>(moved(make)); };
    if (asked_.model == model_kind::spheres)
      asked_.volume == volume_kind::aabb ? keep(trees_of_spheres<clearance::aabb>)
                                         : keep(trees_of_spheres<clearance::obb>);
    else
      asked_.volume == volume_kind::aabb ? keep(trees_of_triangles<clearance::aabb>)
                                         : keep(trees_of_triangles<clearance::sphere>);
    return other_;
  }
  std::span<const clearance::part_facts> facts() override {
    usual();
    return std::visit([](const auto& robot) { return robot.view().facts; }, *usual_);
  }

 private:
  using trees = clearance::any::model<Backend>;

  /// Makes a model by `make(bodies)`, where the backend reads it.
  template <class Make>
  auto moved(Make make) {
    stopwatch clock;
    const auto made = make(*asked_.bodies);
    build += clock.lap();
    auto moved_model = made.on(on_);
    on_.wait();
    upload += clock.lap();
    return moved_model;
  }
  /// The robot with the near maps that are asked for.
  template <class Robot>
  Robot mapped(Robot robot) {
    if (asked_.fields != field_use::none) {
      const clearance::io::field_cache cache(asked_.cache);
      auto made = asked_.fields == field_use::always
                      ? clearance::io::with_fields_cached(on_, std::move(robot), {}, cache)
                      : clearance::io::with_kept_fields(std::move(robot), {}, cache);
      without_field = std::move(made.without);
      fields = made.model.fields().size();
      fields_cached = fields == 0 ? 0 : made.found;
      robot = std::move(made.model);
    }
    if (asked_.cells) {
      auto made = clearance::with_cells(on_, std::move(robot));
      without_cells = std::move(made.without);
      robot = std::move(made.model);
      for (const auto& of_part : robot.cells()) {
        cells += !of_part.empty();
        cells_bytes += of_part.bytes();
      }
    }
    return robot;
  }

  Backend on_;
  asked_model asked_;
  std::shared_ptr<const trees> usual_;
  std::shared_ptr<const other_trees<Backend>> other_;
  clearance::frames::cloud_copies<Backend> copies_;
};

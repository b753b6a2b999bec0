// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From plain data to the library's templates, for the backend that includes this: what all questions share.

#include "../backends.hpp"
#include "../stopwatch.hpp"

#include <clearance/frames/readable.hpp>
#include <clearance/query/query.hpp>
#include <clearance/usual_models.hpp>

#include <variant>

namespace clearance {
struct min_distances_per_part;
}

/// A cloud in the library's terms.
using placed_points =
    std::variant<clearance::placed<clearance::point_span>, clearance::placed<clearance::depth_image<std::uint16_t>>>;

/// The same with what is uncertain about it.
template <class S>
using placed_uncertain = clearance::placed<clearance::uncertain<S, clearance::any_noise>>;
using uncertain_points =
    std::variant<placed_uncertain<clearance::point_span>, placed_uncertain<clearance::depth_image<std::uint16_t>>>;

/// The library's prepared question.
template <class Q, class Backend, class Model>
using prepared_for =
    decltype(clearance::query(std::declval<const Backend&>(), std::declval<const Model&>(), std::declval<const Q&>()));

/// The prepared query of a model, whatever its trees.
struct prepared_query {
  virtual ~prepared_query() = default;
  virtual clearance::min_distance_result least(poses_of poses, const std::vector<placed_points>& clouds) = 0;
  virtual reply least_per_part(poses_of poses, const std::vector<placed_points>& clouds) = 0;
  virtual void forget() = 0;  // the last frame, for `least_per_part`
};

/// The prepared query for many configurations.
struct prepared_plan {
  virtual ~prepared_plan() = default;
  virtual const clearance::min_distances_result& ask(poses_of poses, const std::vector<placed_points>& clouds,
                                                     double d_max) = 0;
  virtual const clearance::min_distances_per_part_result& certain(poses_of poses,
                                                                  const std::vector<uncertain_points>& clouds,
                                                                  const clearance::min_distances_per_part& options) = 0;
};

template <class Backend>
class robot_on_backend final : public backend_robot {
 public:
  robot_on_backend(const Backend& on, const asked_model& asked) : on_(on), asked_(asked) {}

  double see(const std::vector<seen_points>& clouds) override {
    stopwatch clock;
    copies_.clear();
    clouds_.clear();
    uncertain_.clear();
    until_end_.clear();
    any_uncertain_ = false;
    const clearance::frames::readable_on<Backend> readable{on_, copies_};
    for (const seen_points& cloud : clouds)
      std::visit(
          [&](const auto& source) {
            const auto here = readable(source, std::uint32_t(clouds_.size()));
            clouds_.push_back(clearance::placed{here, cloud.pose});
            clearance::cloud_uncertainty off = cloud.off;
            uncertain_.push_back(clearance::placed{clearance::uncertain(here, cloud.sensor, off), cloud.pose});
            any_uncertain_ = any_uncertain_ || cloud.sensor.kind != clearance::noise_kind::none || off.shift > 0 ||
                             off.turn > 0 || off.max_speed * off.age > 0;
            off.age += cloud.later;
            until_end_.push_back(clearance::placed{clearance::uncertain(here, cloud.sensor, off), cloud.pose});
          },
          cloud.points);
    on_.wait();
    return clock.lap();
  }

  reply least(poses_of poses) override;
  reply least_per_part(poses_of poses, int repeat) override;
  reply least_by(poses_of poses, double deadline) override;
  clearance::zones_result zones(poses_of poses, const clearance::zones& options) override;
  clearance::self_filter_result own_points(poses_of poses, double padding) override;
  clearance::supported_distance supported(poses_of poses, const clearance::min_distance_supported& options) override;
  clearance::point_distances distances(poses_of poses, double d_max, bool is_signed) override;
  clearance::nearest_k_result nearest(poses_of poses, std::size_t k, double d_max) override;
  clearance::certain_distance_result certain(poses_of poses, std::span<const clearance::part_radius> parts) override;
  clearance::unseen_result unseen(poses_of poses, const clearance::unseen& options, bool until_end) override;
  std::vector<clearance::part_witness> witnesses(poses_of poses,
                                                 std::span<const clearance::part_minimum> minima) override;
  clearance::min_distances_result plan(poses_of poses, double d_max) override;
  clearance::min_distances_per_part_result certain_plan(poses_of poses, double d_max,
                                                        const std::vector<double>& radii) override;
  std::vector<clearance::motion_clearance_result> ways(std::span<const clearance::io::joint_motion> ways,
                                                       const clearance::motion_clearance_options& options) override;
  std::vector<clearance::motion_clearance_result> hidden_ways(std::span<const clearance::io::joint_motion> ways,
                                                              const clearance::motion_clearance_options& options,
                                                              const clearance::unseen& room) override;
  std::span<const clearance::part_facts> facts() override {
    return with_usual_trees([](const auto& trees) { return trees.view().facts; });
  }

 private:
  using sphere_trees = clearance::sphere_model<Backend>;
  using triangle_trees = clearance::triangle_model<Backend>;
  using trees = std::variant<std::monostate, sphere_trees, triangle_trees>;

  /// The fastest trees for the chosen model; built once, in trees.hpp.
  const trees& usual_trees();

  template <class Use>
  auto with_usual_trees(Use use) {
    const trees& made = usual_trees();
    stopwatch clock;
    auto answer =
        asked_.model == model_kind::spheres ? use(std::get<sphere_trees>(made)) : use(std::get<triangle_trees>(made));
    query = clock.lap();
    return answer;
  }

  /// Makes a model by `make(bodies)`, where the backend reads it.
  template <class Make>
  auto moved(Make make) {
    stopwatch clock;
    const auto made = make(*asked_.bodies);
    build += clock.lap();
    auto model = made.on(on_);
    on_.wait();
    upload += clock.lap();
    return model;
  }

  /// What clouds are for a question that takes certain ones, too.
  template <class Ask>
  auto with_clouds(Ask ask) {
    return any_uncertain_ ? ask(uncertain_) : ask(clouds_);
  }

  /// Of clouds that are all images. `until_end`: as they may be when a plan ends.
  template <class Use>
  auto with_images(bool until_end, Use use);

  prepared_query& prepared();
  prepared_plan& planned();

  Backend on_;
  asked_model asked_;
  trees trees_;
  std::unique_ptr<prepared_query> prepared_;
  std::unique_ptr<prepared_plan> planned_;
  std::vector<placed_points> clouds_;
  std::vector<uncertain_points> uncertain_;  // the same clouds
  std::vector<uncertain_points> until_end_;  // and as they may be when a plan ends
  bool any_uncertain_ = false;
  clearance::frames::cloud_copies<Backend> copies_;
};

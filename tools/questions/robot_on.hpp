// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From plain data to the library's templates, for the backend that includes this: what all questions share.

#include "../backends.hpp"
#include "../stopwatch.hpp"

#include <clearance/frames/readable.hpp>
#include <clearance/points/any_points.hpp>
#include <clearance/query/query.hpp>
#include <clearance/usual_models.hpp>

#include <variant>

namespace clearance {
struct min_distances_per_part;
}

/// Clouds in the library's terms, and with what is uncertain about them. A host reads all kinds as one.
template <class S>
using placed_uncertain = clearance::placed<clearance::uncertain<S, clearance::any_noise>>;
template <class Backend>
struct clouds_on {
  using one =
      std::variant<clearance::placed<clearance::point_span>, clearance::placed<clearance::depth_image<std::uint16_t>>>;
  using uncertain =
      std::variant<placed_uncertain<clearance::point_span>, placed_uncertain<clearance::depth_image<std::uint16_t>>>;
};
template <>
struct clouds_on<clearance::host> {
  using one = clearance::placed<clearance::any_points>;
  using uncertain = placed_uncertain<clearance::any_points>;
};
template <class Backend>
using placed_points = std::vector<typename clouds_on<Backend>::one>;
template <class Backend>
using uncertain_points = std::vector<typename clouds_on<Backend>::uncertain>;

/// The library's prepared question.
template <class Q, class Backend, class Model>
using prepared_for =
    decltype(clearance::query(std::declval<const Backend&>(), std::declval<const Model&>(), std::declval<const Q&>()));

/// The prepared query of a model, whatever its trees.
template <class Backend>
struct prepared_query {
  virtual ~prepared_query() = default;
  virtual clearance::min_distance_result least(poses_of poses, const placed_points<Backend>& clouds) = 0;
  virtual reply least_per_part(poses_of poses, const placed_points<Backend>& clouds) = 0;
  virtual void forget() = 0;  // the last frame, for `least_per_part`
};

/// The prepared query for many configurations.
template <class Backend>
struct prepared_plan {
  virtual ~prepared_plan() = default;
  virtual const clearance::min_distances_result& ask(poses_of poses, const placed_points<Backend>& clouds,
                                                     double d_max) = 0;
  virtual const clearance::min_distances_per_part_result& certain(poses_of poses,
                                                                  const uncertain_points<Backend>& clouds,
                                                                  const clearance::min_distances_per_part& options) = 0;
};

template <class Backend>
class robot_on_backend final : public backend_robot {
 public:
  robot_on_backend(const Backend& on, const asked_model& asked) : on_(on), asked_(asked) {}

  double see(const std::vector<seen_points>& clouds) override {
    stopwatch clock;
    copies_.clear();
    clouds_.clear(), uncertain_.clear(), until_end_.clear();
    images_.clear(), uncertain_images_.clear(), images_until_end_.clear();
    any_uncertain_ = false;
    const clearance::frames::readable_on<Backend> readable{on_, copies_};
    for (const seen_points& cloud : clouds) {
      clearance::cloud_uncertainty later = cloud.off;
      later.age += cloud.later;
      any_uncertain_ = any_uncertain_ || cloud.sensor.kind != clearance::noise_kind::none || cloud.off.shift > 0 ||
                       cloud.off.turn > 0 || cloud.off.max_speed * cloud.off.age > 0;
      const auto add = [&](const auto& source, auto& sure, auto& unsure, auto& at_end) {
        sure.push_back(clearance::placed{source, cloud.pose});
        unsure.push_back(clearance::placed{clearance::uncertain(source, cloud.sensor, cloud.off), cloud.pose});
        at_end.push_back(clearance::placed{clearance::uncertain(source, cloud.sensor, later), cloud.pose});
      };
      std::visit(
          [&]<class S>(const S& source) {
            const S here = readable(source, std::uint32_t(clouds_.size()));
            if constexpr (std::is_same_v<Backend, clearance::host>)
              add(clearance::any_points(here), clouds_, uncertain_, until_end_);
            else
              add(here, clouds_, uncertain_, until_end_);
            if constexpr (std::is_same_v<S, image>) add(here, images_, uncertain_images_, images_until_end_);
          },
          cloud.points);
    }
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
  using image = clearance::depth_image<std::uint16_t>;
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

  prepared_query<Backend>& prepared();
  prepared_plan<Backend>& planned();

  Backend on_;
  asked_model asked_;
  trees trees_;
  std::unique_ptr<prepared_query<Backend>> prepared_;
  std::unique_ptr<prepared_plan<Backend>> planned_;
  placed_points<Backend> clouds_;
  uncertain_points<Backend> uncertain_;           // the same clouds
  uncertain_points<Backend> until_end_;           // and as they may be when a plan ends
  std::vector<clearance::placed<image>> images_;  // those that are images, and both again
  std::vector<placed_uncertain<image>> uncertain_images_, images_until_end_;
  bool any_uncertain_ = false;
  clearance::frames::cloud_copies<Backend> copies_;
};

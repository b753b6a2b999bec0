// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the modules hand to one another: a question prepared for one robot on one backend, whatever its trees.

#include <clearance/any/query.hpp>
#include <clearance/frames/bracket.hpp>
#include <clearance/points/cropped.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/strided_points.hpp>

#include <memory>
#include <optional>

/// Everything that Python may pass as a cloud.
using whole_cloud =
    clearance::any::cloud<clearance::point_span, clearance::strided_points<float>, clearance::strided_points<double>,
                          clearance::depth_image<std::uint16_t>, clearance::depth_image<float>,
                          clearance::ray_image<std::uint16_t>, clearance::ray_image<float>>;

template <class Cloud>
struct cropped_kinds;
template <class... S>
struct cropped_kinds<std::variant<clearance::placed<S>...>> {
  using type = clearance::any::cloud<clearance::cropped<S>...>;
};
/// What is asked about: a cloud that is not cropped has no boxes. On a device the questions are compiled for each kind.
using any_cloud = cropped_kinds<whole_cloud>::type;

namespace clearance {
struct certain_distance;
struct in_collision;
struct in_collisions;
struct min_distances;
struct min_distances_per_part;
struct unseen;
struct zones;
}  // namespace clearance

template <class Q, class... About>
inline constexpr bool one_of = (std::same_as<Q, About> || ...);

/// What a question's clouds may be: uncertain, too, if the question is about that.
template <class Q>
struct cloud_about {
  using type = any_cloud;
};
template <class Q>
  requires one_of<Q, clearance::certain_distance, clearance::in_collision, clearance::in_collisions,
                  clearance::min_distances, clearance::min_distances_per_part, clearance::unseen, clearance::zones>
struct cloud_about<Q> {
  using type = clearance::any::uncertain_too<any_cloud>;
};
template <class Q>
using clouds_about = std::vector<typename cloud_about<Q>::type>;

// Compiled once for all questions, in read_clouds.cpp: how a host reads each kind of cloud.
template <class Cloud>
using read_clouds = clearance::any::detail::clouds_as_one<Cloud>;
using uncertain_cloud_too = clearance::any::uncertain_too<any_cloud>;
extern template read_clouds<any_cloud> clearance::any::detail::read_as_one(const std::vector<any_cloud>&);
extern template read_clouds<uncertain_cloud_too> clearance::any::detail::read_as_one(
    const std::vector<uncertain_cloud_too>&);
/// The same behind masks: the labels of each cloud, or null.
template <class Cloud>
read_clouds<Cloud> read_behind(std::span<const clearance::point_label* const> labels, const std::vector<Cloud>& clouds);

/// A robot's trees, in memory of the backend `B`.
template <class B = clearance::host>
using robot_trees = clearance::any::model<B>;

/// Where a device writes the answer to a question that can be enqueued: the question's own `out`, or, about many
/// configurations, one result of each, or of each part of each.
struct no_out {};
template <class Q>
struct out_of {
  using type = no_out;
};
template <class Q>
  requires requires { typename Q::out; }
struct out_of<Q> {
  using type = typename Q::out;
};
template <class Q>
  requires requires { typename Q::searched; }
struct out_of<Q> {
  using type = typename Q::searched::result_type*;
};
template <class Q>
inline constexpr bool can_be_enqueued = !std::is_same_v<typename out_of<Q>::type, no_out>;

/// How many results a question about many configurations writes.
template <class Q>
std::size_t results_of(std::size_t configurations, std::size_t parts) {
  return Q::each_part ? configurations * parts : configurations;
}

/// A prepared question. One thread at a time asks it.
template <class Q>
struct asker : clearance::any::query<Q, typename cloud_about<Q>::type> {
  /// On a host: the same about clouds behind masks: the labels of each, or null. Throws std::invalid_argument
  /// elsewhere, and of questions about images.
  virtual typename Q::result masked(std::span<const Eigen::Isometry3d>, const clouds_about<Q>&,
                                    std::span<const clearance::point_label* const>, const Q&) {
    throw std::invalid_argument(
        clearance::lists<Q, clearance::of_images>
            ? "clearance: a cloud is masked, and this question is about images: its labels say which pixels are the "
              "robot's own"
            : "clearance: a cloud is masked, which a query on the cpu takes; on a device give the points that are "
              "left");
  }
  /// On a device: what follows waits for the work in this stream.
  virtual void after(void*) {}
  /// On a device: enqueues a frame between what is in the caller's stream now and what comes there later. Clouds and
  /// `to` are in its memory. How certain distances are, where the question says it.
  virtual std::optional<clearance::distance_certainty> enqueue(std::span<const Eigen::Isometry3d>,
                                                               const clouds_about<Q>&, const Q&,
                                                               const typename out_of<Q>::type&, void* /*caller*/) {
    throw std::logic_error("clearance: only a device has a stream to enqueue in");
  }
  /// On a device: the stream in which all of that runs.
  virtual void* stream() const { return nullptr; }
};

/// Each question's is instantiated in a file of its own, which CMake writes. `threads`: how many work; 0: all.
template <class Q>
std::unique_ptr<asker<Q>> ask_on_host(std::shared_ptr<const robot_trees<>> trees, const Q& question, unsigned threads);

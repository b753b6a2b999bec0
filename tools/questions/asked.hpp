// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How the command's questions are prepared: each registers itself, from a translation unit of its own that CMake
// writes.

#include "../backends.hpp"

#include <clearance/any/query.hpp>
#include <clearance/volume/aabb.hpp>

namespace clearance {
struct certain_distance;
struct min_distance;
struct min_distance_per_part;
struct min_distances_per_part;
}  // namespace clearance

// The command's clouds: as they are in files; less what is no obstacle, as they were measured; with what is uncertain
// about them; and both kinds.
using whole_cloud = clearance::any::cloud<clearance::point_span, clearance::depth_image<std::uint16_t>>;
using cloud = clearance::any::cloud<clearance::cropped<clearance::point_span>,
                                    clearance::cropped<clearance::depth_image<std::uint16_t>>>;
using uncertain_cloud = clearance::any::uncertain_alone<cloud>;
using either_cloud = clearance::any::uncertain_too<cloud>;

/// The trees that are not the fastest, and are only asked for the least distance, where their cost is the question.
template <class V, class P, class B, class Interior>
using trees_in = clearance::model<clearance::part<clearance::bvh<V, P, B>, Interior>, B>;
template <class B>
using other_trees = std::variant<trees_in<clearance::aabb, clearance::inner_sphere, B, clearance::no_interior>,
                                 trees_in<clearance::obb, clearance::inner_sphere, B, clearance::no_interior>,
                                 trees_in<clearance::sphere, clearance::triangle, B, clearance::winding<B>>,
                                 trees_in<clearance::aabb, clearance::triangle, B, clearance::winding<B>>>;

/// Trees of one robot, and clouds, in memory of a backend. Trees are a clearance::any::model or `other_trees`.
struct backend_memory {
  virtual ~backend_memory() = default;
  /// The clouds in memory that the backend reads; copies stay until the next call.
  virtual std::vector<cloud> put(const std::vector<cloud>& clouds) = 0;
  /// The fastest trees of the chosen model, and those of the chosen volume, if it is another; each is built once.
  virtual std::shared_ptr<const void> usual() = 0;
  virtual std::shared_ptr<const void> other() = 0;
  virtual std::span<const clearance::part_facts> facts() = 0;

  // See backend_robot.
  std::vector<std::string> without_field, without_cells;
  std::size_t fields = 0, fields_cached = 0, cells = 0, cells_bytes = 0;
  double build = 0, upload = 0;
};
std::unique_ptr<backend_memory> memory_on_host(const asked_model& asked);
/// Throws std::runtime_error if no device is compiled in.
std::unique_ptr<backend_memory> memory_on_device(const asked_model& asked);

/// Prepares a question by its interface, on the host and on a device. `other`: the trees are `other_trees`.
template <class Interface>
struct maker {
  using type = std::unique_ptr<Interface> (*)(const std::shared_ptr<const void>& trees, bool other,
                                              const typename Interface::question_type& q);
  static inline type on[2] = {};
};

template <class Q>
struct asked_about {
  using type = cloud;
};
template <class Q>
  requires std::same_as<Q, clearance::certain_distance> || std::same_as<Q, clearance::min_distances_per_part>
struct asked_about<Q> {
  using type = uncertain_cloud;
};
template <class Q>
  requires std::same_as<Q, clearance::zones> || std::same_as<Q, clearance::unseen>
struct asked_about<Q> {
  using type = either_cloud;
};

/// Registers how a question is prepared on a backend.
template <class Backend, class Interface, template <class, class, class> class Prepared, bool OtherTrees = false>
void register_on() {
  constexpr bool device = !std::same_as<Backend, clearance::host>;
  using question_type = typename Interface::question_type;
  maker<Interface>::on[device] = [](const std::shared_ptr<const void>& trees, bool other, const question_type& q) {
    if constexpr (OtherTrees)
      if (other)
        return clearance::any::prepare<Interface, Prepared>(
            Backend{}, std::static_pointer_cast<const other_trees<Backend>>(trees), q);
    return clearance::any::prepare<Interface, Prepared>(
        Backend{}, std::static_pointer_cast<const clearance::any::model<Backend>>(trees), q);
  };
}

template <class Backend, class Q>
struct asked_on {
  asked_on() {
    using namespace clearance;
    constexpr bool least = std::same_as<Q, min_distance> || std::same_as<Q, min_distance_per_part>;
    register_on<Backend, any::query<Q, typename asked_about<Q>::type>, any::prepared, least>();
    if constexpr (std::same_as<Q, min_distance_per_part>)
      register_on<Backend, any::timed_query<Q, cloud>, any::timed>();
  }
};
/// min_distance_per_part, as the ways of a plan ask it.
template <class Backend, class Q>
struct asked_on_ways {
  asked_on_ways() { register_on<Backend, clearance::any::query<Q, either_cloud>, clearance::any::prepared>(); }
};

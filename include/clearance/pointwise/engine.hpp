// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks for every point's distance on one backend, frame after frame.

#include <clearance/backends/kept_memory.hpp>
#include <clearance/backends/readback.hpp>
#include <clearance/frames/readable.hpp>
#include <clearance/pointwise/host_points.hpp>
#include <clearance/scan/scan_body.hpp>

namespace clearance::pointwise {

template <class On>
struct points_on;

/// The prepared question of a backend that has nothing to prepare.
template <class On, class PartView>
struct unprepared {
  template <class... Memory>
  unprepared(const On& on, const model_view<PartView>& model, Memory...) : on(on), model(model) {}

  On on;
  model_view<PartView> model;

  template <class Clouds, class Here>
  distance_certainty enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const distances_out& out,
                             real d_max, point_counts* counts, const Here& here) const {
    return points_on<On>::once(on, model, poses, clouds, out, d_max, counts, here);
  }
  void forget() const {}
};

/// For a backend without a scan of its own: a loop over points.
template <class On>
struct points_on {
  template <class PartView, class Clouds, class Here>
  static distance_certainty once(const On& on, const model_view<PartView>& model,
                                 std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                 const distances_out& out, real d_max, point_counts* counts, const Here& here) {
    const auto of_cloud = [&]<point_source S>(const S& source, const frames::turn& now) {
      on.for_each(source.size(), clear_body<S>{source, out, now.first});
      return each_point{out, d_max};
    };
    return certainty_of(scan::plain_pass(on, model, poses, clouds, of_cloud, counts, here));
  }

  template <class PartView>
  using kept = unprepared<On, PartView>;
};

template <>
struct points_on<host> {
  template <class PartView, class Clouds, class Here>
  static distance_certainty once(const host& on, const model_view<PartView>& model,
                                 std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                 const distances_out& out, real d_max, point_counts* counts, const Here&) {
    return on_host(on, model, poses, clouds, out, d_max, counts);
  }

  template <class PartView>
  using kept = unprepared<host, PartView>;
};

/// `Q` has `which`, and `limit()`, the farthest computed distance that counts; `Q::out` is where a backend writes.
/// `Q::check_robot(on, model)` refuses a robot, and `Q::after(...)` enqueues what comes after the scan.
template <class On, class PartView, class Q>
class engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : on_(on),
        model_(model),
        memory_(on, from...),
        back_(on, from...),
        readable_(on, from...),
        points_{on, model, from...},
        result_{.distance = arriving<real>(back_.memory()),
                .part = arriving<std::uint32_t>(back_.memory()),
                .primitive = arriving<std::uint32_t>(back_.memory()),
                .counts = {},
                .certain = {}} {
    Q::check_robot(on, model);
  }

  /// Enqueues a frame whose result `finish` waits for.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    size_ = count_points(clouds);
    memory_.begin();
    to_ = {{memory_.template space<real>(size_).data()}, memory_.template space<point_counts>(1).data()};
    if (q.which) {
      to_.distances.part = memory_.template space<std::uint32_t>(2 * size_).data();
      to_.distances.primitive = to_.distances.part + size_;
    }
    result_.certain = start(poses, readable_(clouds), q, to_);
  }
  /// The result stays valid until the next call.
  typename Q::result& finish() {
    using backends::read_array, backends::read_value;
    const std::size_t named = to_.distances.part == nullptr ? 0 : size_;
    back_(read_value{result_.counts, to_.counts}, read_array{result_.distance, to_.distances.distance, size_},
          read_array{result_.part, to_.distances.part, named},
          read_array{result_.primitive, to_.distances.primitive, named});
    return result_;
  }

  /// Enqueues a frame. On a device it waits for nothing, and allocates only for a frame of more points than any before.
  template <class Clouds>
  distance_certainty start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q,
                           const typename Q::out& to) {
    const real d_max = q.limit();
    const distance_certainty certain =
        points_.enqueue(poses, clouds, to.distances, d_max, to.counts, frames::as_it_is{});
    Q::after(on_, model_, poses, clouds, to.distances);
    return certain;
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { points_.forget(); }

 private:
  On on_;
  model_view<PartView> model_;
  backends::kept_memory<On> memory_;
  backends::readback<On> back_;
  frames::readable_clouds<On> readable_;
  typename points_on<On>::template kept<PartView> points_;
  typename Q::out to_{};
  std::size_t size_ = 0;
  typename Q::result result_;
};

}  // namespace clearance::pointwise

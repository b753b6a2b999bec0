// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// An upper bound on the distances of each part's k nearest points, from points that are likely to be near. It is found
// before all points are asked.

#include <clearance/backend/host.hpp>
#include <clearance/frame/clouds.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/pairwise/nearest_bins.hpp>
#include <clearance/pairwise/pairs_on.hpp>
#include <clearance/points/thinned.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/tile_scan.hpp>
#include <clearance/traversal/any_depth.hpp>
#include <clearance/visitor/nearest.hpp>

#include <algorithm>
#include <cmath>

namespace clearance::pairwise {

/// Keeps the k least distances.
class least_distances {
 public:
  least_distances(std::size_t k, real bound) : k_(k), bound_(bound) {}

  /// A farther distance is not one of them.
  real bound() const { return heap_.size() < k_ ? bound_ : heap_.front(); }
  void add(real distance) {
    if (!(distance <= bound())) return;
    heap_.push_back(distance), std::push_heap(heap_.begin(), heap_.end());
    if (heap_.size() > k_) std::pop_heap(heap_.begin(), heap_.end()), heap_.pop_back();
  }

 private:
  std::size_t k_;
  real bound_;
  std::vector<real> heap_;
};

/// Takes every `stride`-th point of a source.
struct every_nth {
  std::uint32_t stride;
  template <point_source S>
  thinned<S> operator()(const S& source, std::uint32_t) const {
    return {source, stride};
  }
};

/// Opens the windows of a frame, and lowers their bounds by a pass over some of the points. A device has all points in
/// flight at once, so that a bound found on the way comes too late; a loop over points has the bound of those before.
/// Enqueued. `to` may be written.
template <class Passes, class Clouds>
void sample_bounds(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::size_t points,
                   const nearest_bins& to, std::uint32_t* bounds, std::uint32_t k, real d_max, point_counts* counts) {
  const auto& on = passes.on;
  const std::size_t parts = passes.model.size();
  on.for_each(parts, open_windows{to.windows, bounds, k, ordered(d_max)});
  if constexpr (pairs_on<std::remove_cvref_t<decltype(on)>>::meets_points) {
    // With n / s points first, and some k s then, the root of n / k is best. Odd, so that it meets all columns.
    const auto stride = std::uint32_t(std::sqrt(double(points) / double(k))) | 1;
    if (stride < 5) return;
    on.for_each(parts * nearest_bins::bins, zero_words{to.counts});
    passes.enqueue(poses, clouds, to, counts, every_nth{stride});
    on.for_each(parts, keep_bound{to.counts, to.windows, bounds, k});
  }
}

/// Where a bound is worth a look before all points are asked.
template <class On>
struct nearest_sample {
  /// Lowers `bounds`, one per part and all alike, to a distance within which k points certainly are, if k are found.
  template <class Passes, class Clouds>
  static void lower(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::size_t k,
                    std::vector<real>& bounds) {
    if (!pairs_on<On>::meets_points || bounds.empty()) return;
    const auto a = passes.look(poses, clouds);
    auto* const words = a.template room<std::uint32_t>(bounds.size());
    const nearest_bins to{a.template room<std::uint32_t>(bounds.size() * nearest_bins::bins),
                          a.template room<nearest_window>(bounds.size()), nearest_bins::first_shift};
    sample_bounds(passes, poses, clouds, a.points, to, words, std::uint32_t(k), bounds[0],
                  a.template room<point_counts>(1));
    const std::vector<std::uint32_t> found = a.copy_out(words, bounds.size());
    for (std::size_t part = 0; part < bounds.size(); ++part) bounds[part] = from_ordered(found[part]);
  }
};

/// On a host walks are what takes time, and nearly all of them end at a root once there is a bound.
template <>
struct nearest_sample<host> {
  template <class Passes, class Clouds>
  static void lower(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, std::size_t k,
                    std::vector<real>& bounds) {
    const auto& model = passes.model;
    host_workers workers(passes.on);
    std::vector<least_distances> found;
    for (const real bound : bounds) found.emplace_back(k, bound);
    frames::cloud_frame frame;
    std::vector<extent> boxes;
    frames::for_each_turn(frame, model.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn&) {
      static_assert(points_alone<S>());
      boxes.assign((source.size() + scan::tile_points - 1) / scan::tile_points, {});
      workers.for_pieces(boxes.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) boxes[n] = box_of_tile(source, frame.origin, n);
      });
      workers.for_pieces(model.size(), 1, [&](std::size_t part, std::size_t) {
        with_vectors([&] { ask(source, frame, boxes, model, std::uint32_t(part), 4 * k + 4096, found[part]); });
      });
    });
    for (std::size_t part = 0; part < bounds.size(); ++part) bounds[part] = found[part].bound();
  }

 private:
  template <point_source S>
  static extent box_of_tile(const S& source, vec3 origin, std::size_t n) {
    const std::size_t begin = n * scan::tile_points;
    extent box;
    scan::drop_tally uncounted;
    if (begin + scan::tile_points <= source.size() && scan::survey(source, begin, box, uncounted))
      return {box.lower - origin, box.upper - origin};
    scan::tile t;
    t.load(source, begin, std::min(scan::tile_points, source.size() - begin), 1, uncounted);
    t.subtract(origin);
    return scan::box_of(t);
  }

  /// Asks tiles, the nearest to the part's ball first, until none can be nearer or enough points were asked.
  template <point_source S, class PartView>
  static void ask(const S& source, const frames::cloud_frame& frame, const std::vector<extent>& boxes,
                  const model_view<PartView>& model, std::uint32_t part, std::size_t most, least_distances& found) {
    const frames::placement& place = frame.places[part];
    const PartView& its = model.parts[part];
    const any_depth walk{stack_need(model.depth, model.width)};
    std::vector<std::pair<real, std::uint32_t>> order;
    for (std::uint32_t n = 0; n < boxes.size(); ++n)
      if (const real away = length_to(boxes[n], place.around.center) - place.around.radius; away <= found.bound())
        order.emplace_back(away, n);
    const auto later = [](const auto& a, const auto& b) { return a > b; };
    std::make_heap(order.begin(), order.end(), later);
    for (std::size_t asked = 0; !order.empty() && asked < most;) {
      std::pop_heap(order.begin(), order.end(), later);
      const auto [away, n] = order.back();
      order.pop_back();
      if (!(away <= found.bound())) return;
      for (std::size_t i = std::size_t(n) * scan::tile_points, end = std::min(source.size(), i + scan::tile_points);
           i < end; ++i) {
        const sample s = source[i];
        if (!s.valid() || !frames::may_reach(place.around, found.bound(), s.position - frame.origin)) continue;
        ++asked;
        const vec3 q = place.part_from_cloud(s.position - frame.origin);
        if constexpr (scan::has_interior<PartView>)
          if (its.interior.inside(q)) {
            found.add(0);
            continue;
          }
        nearest near{found.bound()};
        walk(its.tree, q, near);
        if (near.best != nearest::none) found.add(near.within);
      }
    }
  }
  /// Infinite if the box is empty.
  static real length_to(const extent& box, vec3 p) {
    const auto beyond = [](real low, real high, real x) { return max(max(low - x, x - high), 0); };
    if (!(box.lower.x <= box.upper.x)) return infinity;
    return length({beyond(box.lower.x, box.upper.x, p.x), beyond(box.lower.y, box.upper.y, p.y),
                   beyond(box.lower.z, box.upper.z, p.z)});
  }
};

}  // namespace clearance::pairwise

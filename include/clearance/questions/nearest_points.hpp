// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The k nearest points of each part, by counting distances in bins.

#include <clearance/backends/host.hpp>
#include <clearance/concepts.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/ground/numbered.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/pairwise/nearest_bins.hpp>
#include <clearance/pairwise/pairs_on.hpp>
#include <clearance/points/passes_on.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/tile_scan.hpp>
#include <clearance/traversal/any_depth.hpp>
#include <clearance/visitor/nearest.hpp>

#include <algorithm>
#include <cmath>

namespace clearance {

// A sample of a cloud, as a cloud.

/// Every `stride`-th point of any source, from its first one on. The others are there, but do not count: so a device
/// spreads the sample over as many blocks as it does the whole.
template <point_source S>
struct thinned : passes_on<thinned<S>, S, sources::capsules> {
  static constexpr bool vague = vague_source<S>, balls = ball_source<S>;
  using can = typename thinned::passed;

  S whole;
  std::uint32_t stride;
  static constexpr auto viewed = &thinned::whole;

  CLEARANCE_HD thinned(const S& whole, std::uint32_t stride) : whole(whole), stride(stride) {}

  CLEARANCE_HD sample operator[](std::size_t i) const {
    return std::uint32_t(i) % stride == 0 ? whole[i] : sample{{0, 0, 0}, drop_reason::masked};
  }
};

}  // namespace clearance

namespace clearance::pairwise {

// An upper bound on the distances of each part's k nearest points, from points that are likely to be near. It is found
// before all points are asked.

/// Keeps the k least distances.
class least_distances {
 public:
  least_distances(std::size_t k, real bound) : k_(k), bound_(bound) {}

  /// A farther distance is not one of them.
  real bound() const { return heap_.size() < k_ ? bound_ : heap_.front(); }
  void add(real distance) {
    if (!(distance <= bound())) return;
    heap_.push_back(distance);
    std::push_heap(heap_.begin(), heap_.end());
    if (heap_.size() > k_) {
      std::pop_heap(heap_.begin(), heap_.end());
      heap_.pop_back();
    }
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
    const auto a = passes.prepare(poses, clouds);
    auto* const words = a.template space<std::uint32_t>(bounds.size());
    const nearest_bins to{a.template space<std::uint32_t>(bounds.size() * nearest_bins::bins),
                          a.template space<nearest_window>(bounds.size()), nearest_bins::first_shift};
    sample_bounds(passes, poses, clouds, a.points, to, words, std::uint32_t(k), bounds[0],
                  a.template space<point_counts>(1));
    const std::vector<std::uint32_t> found = a.copy_out(words, bounds.size());
    for (std::size_t part = 0; part < bounds.size(); ++part) bounds[part] = from_ordered(found[part]);
  }
};

/// On a host walks are what takes time, and nearly all of them end at a root once there is a bound. Whatever a point
/// stands for is no farther than the point.
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
    const PartView& searched = model.parts[part];
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
          if (searched.interior.inside(q)) {
            found.add(0);
            continue;
          }
        nearest near{found.bound()};
        walk(searched.tree, q, near);
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

namespace clearance {

/// The pairs of part k begin at k * per_part, the nearest first, then by cloud and point. If there are fewer, the rest
/// is at no point, and infinitely far.
struct nearest_k_result {
  std::size_t per_part = 0;  ///< The number of pairs in each part's list.
  std::vector<pair_distance> pairs;
  point_counts counts;
  distance_certainty certain;  ///< What is certain of each pair's distance, by its part.

  /// The pairs of a part. Throws std::out_of_range if there is no such part.
  std::span<const pair_distance> of(std::size_t part) const& {
    check_number("part", part, per_part == 0 ? 0 : pairs.size() / per_part);
    return std::span(pairs).subspan(part * per_part, per_part);
  }
  /// A copy: a temporary result is gone before a view of it is read.
  std::vector<pair_distance> of(std::size_t part) const&& {
    const auto view = of(part);
    return {view.begin(), view.end()};
  }
};

namespace pairwise {

inline constexpr std::size_t most_listed = std::size_t(1) << 20;  ///< The most pairs of one part.

/// Keeps the first `per_part` pairs of each part of `near`.
inline void take_nearest(nearest_k_result& kept, const within_result& near) {
  kept.pairs.clear();
  for (std::uint32_t p = 0; p + 1 < near.offsets.size(); ++p) {
    const auto begin = near.pairs.begin() + std::ptrdiff_t(near.offsets[p]);
    kept.pairs.insert(kept.pairs.end(), begin,
                      begin + std::ptrdiff_t(std::min(kept.per_part, near.offsets[p + 1] - near.offsets[p])));
    kept.pairs.resize((p + 1) * kept.per_part, {none, none, p, none, infinity});
  }
}

/// All pairs within `radii`, one per part, in order. Clouds must be readable where the question runs.
template <class Passes, class Clouds>
within_result list_within(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                          const std::vector<real>& radii) {
  const within question{{radii.begin(), radii.end()}};
  for (std::size_t least = 0;;) {
    const auto a = passes.prepare(poses, clouds);
    const within::out to = question.space(a, least);
    passes.enqueue(poses, clouds, question.prepare(a, to), to.counts);
    within_result found;
    least = question.more(a, to, found);
    if (least == 0) return found;
  }
}

/// The same, unless there are more than `most`: then nothing is listed, and it returns false.
template <class Passes, class Clouds>
bool list_few_within(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                     const std::vector<real>& radii, std::size_t most, within_result& near) {
  const within question{{radii.begin(), radii.end()}};
  const auto a = passes.prepare(poses, clouds);
  within::out to = question.space(a);
  to.capacity = std::min(to.capacity, most);
  passes.enqueue(poses, clouds, question.prepare(a, to), to.counts);
  return question.more(a, to, near) == 0;
}

/// What the last frame says about the next: how near the k nearest may still be. It is only a first bound; if fewer
/// points are so near, everything is asked again.
struct known_nearest {
  std::size_t k = 0;
  bool crowded = false;           ///< So many points were as near that they were counted before some were listed.
  std::vector<real> last, radii;  ///< One per part: how near the last of k was, and a bound for the next frame.

  /// Bounds for at most k points.
  std::vector<real> first_bounds(real d_max) const {
    std::vector<real> first = radii;
    for (real& bound : first) bound = std::min(d_max, bound);
    return first;
  }
  /// In the next frame they may be farther by twice as much as they have moved, and 5 mm; at first by a tenth
  /// and 2 cm.
  void learn(const nearest_k_result& found) {
    std::vector<real> now, next;
    for (std::size_t p = 0; p * found.per_part < found.pairs.size(); ++p) {
      now.push_back(found.of(p).back().distance);
      const bool moved = k == found.per_part && now[p] < infinity && last[p] < infinity;
      next.push_back(now[p] + (moved ? 2 * std::abs(now[p] - last[p]) + 0.005f : std::abs(now[p]) / 10 + 0.02f));
    }
    crowded = crowded && k == found.per_part;
    last = std::move(now);
    radii = std::move(next);
    k = found.per_part;
  }
};

/// So many pairs are listed without being counted first. A device passes over all points while a host copies and sorts
/// some thousand pairs.
template <class On>
std::size_t few_pairs(std::size_t k, std::size_t parts) {
  return 4 * k * parts + (pairs_on<On>::meets_points ? 1 << 11 : 1 << 16);
}

/// First bounds, if no frame before is known.
template <class Passes, class Clouds>
std::vector<real> bounds_of_nearest(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                    std::size_t k, real d_max) {
  std::vector<real> bounds(passes.model.size(), d_max);
  nearest_sample<std::remove_cvref_t<decltype(passes.on)>>::lower(passes, poses, clouds, k, bounds);
  return bounds;
}

/// How near the k nearest points of each part are: k points have at most that computed distance, or there are fewer
/// within d_max. Except for equal distances, not many more points do. `first` are the first bounds; if they are too low
/// and `again` allows it, everything is asked once more.
template <class Passes, class Clouds>
std::vector<real> radii_of_nearest(Passes& passes, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                                   std::uint32_t k, real d_max, const std::vector<real>& first, bool again) {
  const auto& on = passes.on;
  const std::size_t parts = passes.model.size(), enough = few_pairs<std::remove_cvref_t<decltype(on)>>(k, parts);
  std::vector<nearest_window> windows;
  std::vector<std::uint32_t> bounds, before(parts);
  for (const real bound : first) {
    bounds.push_back(ordered(bound));
    windows.push_back({.wanted = k, .bound = bounds.back()});
  }
  for (int pass = 0; pass < nearest_bins::passes; ++pass) {
    const int shift = nearest_bins::shift_of(pass);
    passes.memory.begin();
    std::uint32_t* const counts = passes.memory.template space<std::uint32_t>(parts * nearest_bins::bins).data();
    on.for_each(parts * nearest_bins::bins, zero_words{counts});
    const auto [window_memory] = passes.memory.put(windows);
    passes.enqueue(poses, clouds, nearest_bins{counts, window_memory, shift},
                   passes.memory.template space<point_counts>(1).data());
    std::vector<std::uint32_t> counted;
    passes.back(backends::read_array{counted, counts, parts * nearest_bins::bins});
    std::size_t listed = 0;
    for (std::size_t p = 0; p < parts; ++p) {
      if (windows[p].wanted == 0) {
        listed += before[p];
        continue;
      }
      const wanted_bin found = next_window{counted.data(), windows.data(), bounds.data(), shift}(p);
      if (found.bin == nearest_bins::bins && again && first[p] < d_max)
        return radii_of_nearest(passes, poses, clouds, k, d_max, bounds_of_nearest(passes, poses, clouds, k, d_max),
                                false);
      before[p] += found.before;
      listed += before[p] + found.count;
    }
    if (listed <= enough) break;
  }
  std::vector<real> radii;
  for (const std::uint32_t bound : bounds) radii.push_back(from_ordered(bound));
  return radii;
}

/// Clouds must be readable where the question runs.
template <class Passes, class Clouds>
nearest_k_result list_nearest(Passes& passes, known_nearest& known, std::span<const Eigen::Isometry3d> poses,
                              const Clouds& clouds, std::size_t k, real d_max) {
  using on = std::remove_cvref_t<decltype(passes.on)>;
  const std::size_t parts = passes.model.size();
  const bool cold = k > known.k;
  const std::vector<real> first = cold ? bounds_of_nearest(passes, poses, clouds, k, d_max) : known.first_bounds(d_max);
  const auto tell = [&](const within_result& near) {
    nearest_k_result found;
    found.per_part = k;
    found.counts = near.counts;
    found.certain = near.certain;
    take_nearest(found, near);
    return found;
  };
  // If all that are as near as the last frame's are few, and enough, one pass is all.
  if (!cold && !known.crowded && std::ranges::find(first, infinity) == first.end()) {
    within_result near;
    known.crowded = !list_few_within(passes, poses, clouds, first, few_pairs<on>(k, parts), near);
    bool enough = !known.crowded;
    for (std::size_t p = 0; p < parts && enough; ++p)
      enough = near.offsets[p + 1] - near.offsets[p] >= k || !(first[p] < d_max);
    if (enough) {
      nearest_k_result found = tell(near);
      if (k >= known.k) known.learn(found);
      return found;
    }
  }
  const std::vector<real> radii = radii_of_nearest(passes, poses, clouds, std::uint32_t(k), d_max, first, !cold);
  nearest_k_result found = tell(list_within(passes, poses, clouds, radii));
  const bool lost =
      !std::equal(radii.begin(), radii.end(), first.begin(), [](real now, real before) { return now <= before; });
  if (k >= known.k || lost) known.learn(found);  // what is known of more is a bound for fewer, too
  return found;
}

}  // namespace pairwise

}  // namespace clearance

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from the points that were looked at before a deadline, and how many were they? Runs on the host;
// include min_distance_by.cuh for a device.

#include <clearance/answer/of_pieces.hpp>
#include <clearance/frame/mapped_clouds.hpp>
#include <clearance/min_distance_query.hpp>
#include <clearance/points/slice.hpp>

#include <bit>
#include <chrono>
#include <optional>

namespace clearance {

/// The least distance to the points that there was time for. `lower` and `state` are about all points: while some are
/// unseen, `lower` is 0 and nothing is `free`. `seen` points were looked at, `unseen` were not.
struct min_distance_so_far : min_distance_result {
  std::uint64_t unseen = 0;
};

struct deadline_options {
  std::size_t piece = 0;  ///< Points between two looks at the clock; 0: a number that suits the backend.
  bool per_part =
      false;  ///< Look for every part's minimum, which takes longer; `lower` is then that of min_distance_per_part.
};

namespace minimum {

/// How often a backend looks at the clock, and the prepared question that it uses.
template <class On>
struct timed_on {
  static_assert(
      !requires { typename On::own_scan; },
      "a device has a scan of its own: include <clearance/min_distance_by.cuh>, not the .hpp");
  static_assert(
      requires { typename On::own_scan; },
      "a deadline is for a host or a device, not for several, nor for a backend of one's own");
};
template <>
struct timed_on<host> {
  static constexpr std::size_t piece = 1 << 18;
  template <robot Robot, class Ask>
  static auto with_query(const host& on, const Robot& robot, const Ask& ask) {
    min_distance_query query(on, robot);
    return ask(query);
  }
};

/// Says before each piece whether there is time for one as long as the last; before the first, whether there is any
/// time.
class stopwatch {
 public:
  /// Throws std::invalid_argument if the deadline is negative or NaN.
  explicit stopwatch(std::chrono::duration<double> deadline) : deadline_(deadline.count()) {
    if (!(deadline_ >= 0))
      throw std::invalid_argument("clearance: a deadline of " + std::to_string(deadline_) +
                                  " s; it must not be negative");
  }
  bool operator()() {
    const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(),
                 took = asked_ < 0 ? 0 : now - asked_;
    asked_ = now;
    return now + took < deadline_;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double deadline_, asked_ = -1;
};

/// The i-th piece to ask of n, a power of two: each is as far as possible from all before it.
inline std::size_t spread(std::size_t i, std::size_t n) {
  std::size_t k = 0;
  for (std::size_t bit = 1; bit < n; bit *= 2) k = 2 * k + (i / bit & 1);
  return k;
}

/// Slices `begin` to `end - 1` of `n` of any source.
struct some_slices {
  std::size_t begin, end, n;

  template <point_source S>
  auto operator()(const S& source) const {
    return slice(source, first_of_slice(source.size(), begin, n), first_of_slice(source.size(), end, n));
  }
};

}  // namespace minimum

/// As min_distance_by, as long as `go_on()` is true. It is asked before each piece: a clock of your own, or an order to
/// stop. `query` is a prepared min_distance_query; it forgets the last frame.
template <class On, class PartView, class Clouds, class GoOn>
min_distance_so_far min_distance_while(min_distance_query<On, PartView>& query,
                                       std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, GoOn go_on,
                                       const deadline_options& options = {}) {
  static_assert(explain_clouds<Clouds>());
  std::vector<std::size_t> sizes;
  std::uint64_t total = 0;
  for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d&) {
    sizes.push_back(source.size()), total += source.size();
  });
  if (total >= ~std::uint32_t(0)) throw std::invalid_argument("clearance: more than 2^32 - 2 points in one call");
  const std::size_t piece = options.piece != 0 ? options.piece : minimum::timed_on<On>::piece,
                    n = std::bit_ceil(std::size_t((total + piece - 1) / piece));
  std::optional<minimum::of_pieces> all;
  const auto add = [&](const min_distance_result& r) {
    const minimum::of_pieces its(r);
    all ? all->add(its) : void(all = its);
  };
  std::vector<part_minimum> minima(options.per_part ? poses.size() : 0);
  real nearest = infinity;
  std::size_t i = 0;
  for (; i < n && go_on(); ++i) {
    const std::size_t k = minimum::spread(i, n);
    const auto some =
        mapped_clouds(clouds, minimum::some_slices{k, k + 1, n});  // of every cloud, so that errors are those of all
    if (!options.per_part) query.bound_by(nearest);  // the first by nothing, whatever the query was told before
    const min_distance_result r = options.per_part ? query.per_part(poses, some, minima) : query(poses, some);
    if (r.part != none) nearest = r.distance;
    add(r.cloud == none ? r : renumbered(r, 0, std::uint32_t(first_of_slice(sizes[r.cloud], k, n))));
  }
  if (i == 0)
    add(query(poses,
              mapped_clouds(clouds, minimum::some_slices{
                                        0, 0, n})));  // of no points; what cannot be asked is refused all the same
  query.forget();
  min_distance_so_far so_far{all->answer(scan::has_interior<PartView>)};
  so_far.unseen = total - so_far.seen;
  if (so_far.unseen != 0) {  // a point of them may be anywhere
    so_far.lower = 0;
    if (so_far.state == state::free) so_far.state = state::possible;
  }
  return so_far;
}

/// As the next function, with a prepared min_distance_query, which saves preparation on a device.
template <class On, class PartView, class Clouds>
min_distance_so_far min_distance_by(min_distance_query<On, PartView>& query, std::span<const Eigen::Isometry3d> poses,
                                    const Clouds& clouds, std::chrono::duration<double> deadline,
                                    const deadline_options& options = {}) {
  return min_distance_while(query, poses, clouds, minimum::stopwatch(deadline), options);
}

/// The least distance, or what is known of it when `deadline` has passed since the call. Pieces are asked one after
/// another, spread over the clouds. If there is time for all, the answer is that of min_distance, to the bit
/// (`per_part`: of min_distance_per_part); if for none (0), nothing is known. Arguments as for min_distance. Throws
/// std::invalid_argument as that does, and if the deadline is negative or NaN.
template <class On, robot Robot, class Clouds>
min_distance_so_far min_distance_by(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                    const Clouds& clouds, std::chrono::duration<double> deadline,
                                    const deadline_options& options = {}) {
  static_assert(explain_clouds<Clouds>());
  minimum::stopwatch watch(deadline);
  return minimum::timed_on<On>::with_query(
      on, robot, [&](auto& query) { return min_distance_while(query, poses, clouds, watch, options); });
}

}  // namespace clearance

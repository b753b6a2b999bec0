// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot at least from what its sensors see, if places of points and of parts are uncertain?

#include <clearance/minimum/apart.hpp>
#include <clearance/minimum/merge.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/scan/interior.hpp>

#include <tuple>

namespace clearance {

// What is certain of each part's distance, and how answers about pieces of the clouds become one.

/// What lies between the distance of a pair and what is certain of it, one by one. Metres.
struct uncertainty_shares {
  double noise = 0;        ///< What the sensor's noise adds to the point's radius.
  double calibration = 0;  ///< What an inexact pose of the sensor adds to the point's radius.
  double time = 0;         ///< What an obstacle's motion since the point was seen adds to its radius.
  double joints = 0;       ///< What inexact joints add to the part's radius.
  double delay = 0;        ///< What the part's motion while the answer is made adds to its radius.
  double gap = 0;          ///< The part's gap and tolerance.
  double balls = 0;        ///< The cloud's gap, if its points are balls that fill something.
  double rounding = 0;     ///< What arithmetic may have lost.

  /// All shares together.
  double sum() const { return noise + calibration + time + joints + delay + gap + balls + rounding; }
};

/// The pair of a part that is least far apart for certain. `distance` is what was measured, `lower` what is left of it.
/// The pair need not be the nearest. Without a valid point the distance is infinite.
struct certain_pair : part_witness {
  real lower = 0;             ///< Metres that certainly lie between the point and the part.
  uncertainty_shares shares;  ///< What is taken off the distance, by its cause.
  real to_ball = infinity;    ///< Metres from the part to the ball around the point, the nearest ball.
};

/// `lower <= distance to the solid <= upper` if no radius is too small. `certain` is the pair that decides `lower`.
/// `collision`: a point is inside by more than all radii, which of a part that is a mesh is not known: `possible`.
/// `nominal` is what min_distance says about the same points.
struct certain_distance_result {
  clearance::state state = clearance::state::no_data;
  real lower = 0, upper = infinity;
  min_distance_result nominal;
  certain_pair certain;
  std::vector<certain_pair> parts;
  std::uint64_t anywhere = 0;  ///< The number of points that may be anywhere: if it is not 0, nothing is free.
  bool any_radius = false;     ///< Some cloud was `uncertain`, or parts had radii.
};

namespace minimum {

/// Concludes from what is known of each part's pair and of the nearest one: `state` is `collision` and `upper` 0 if by
/// that a point is inside.
inline void conclude(certain_distance_result& r) {
  double lower = infinity;
  r.certain = {};
  for (certain_pair& part : r.parts) {
    if (part.point == none) continue;
    const uncertainty_shares& s = part.shares;
    const double least = double(part.to_ball) - s.gap - s.rounding - (s.joints + s.delay);
    part.lower = least > 0 && r.anywhere == 0 ? rounded_down(least) : 0;
    if (least < lower) {
      lower = least;
      r.certain = part;
    }
  }
  if (r.nominal.part == none) return;  // nothing is known
  const bool inside = (r.any_radius ? r.state : r.nominal.state) == state::collision;
  if (!r.any_radius) r.upper = r.nominal.upper;
  r.lower = lower > 0 && r.anywhere == 0 && !inside ? rounded_down(lower) : 0;
  r.state = inside ? state::collision : r.lower > 0 ? state::free : state::possible;
}

/// Answers about pieces of all clouds, up to that of one call.
template <class PartView>
class joined_certain {
 public:
  template <class Q>
  joined_certain(const Q&, std::span<const part_facts>) {}

  void add(certain_distance_result piece, const piece_place& place) {
    const auto put = [&](auto& r) {
      if (r.cloud != none) r.point += place.first[r.cloud];
    };
    put(piece.nominal);
    for (certain_pair& part : piece.parts) put(part);
    const of_pieces nominal(piece.nominal);
    if (!any_) {
      all_ = std::move(piece);
      nominal_ = nominal;
      any_ = true;
      return;
    }
    if (nearer(nominal.all, nominal_.all)) {
      all_.state = piece.state;
      all_.upper = piece.upper;
    }
    nominal_.add(nominal);
    all_.anywhere += piece.anywhere;
    for (std::size_t k = 0; k < piece.parts.size(); ++k) {
      const certain_pair &found = piece.parts[k], &best = all_.parts[k];
      if (std::tie(found.to_ball, found.cloud, found.point) < std::tie(best.to_ball, best.cloud, best.point))
        all_.parts[k] = found;
    }
  }
  certain_distance_result result() const {
    certain_distance_result r = all_;
    if (!any_) return r;
    r.nominal = nominal_.answer(scan::has_interior<PartView>);
    conclude(r);
    return r;
  }

 private:
  certain_distance_result all_;
  of_pieces nominal_;
  bool any_ = false;
};

}  // namespace minimum

/// By how much a part may be elsewhere. Metres.
struct part_radius {
  double joints = 0;  ///< How far it may be elsewhere because joints are not where they say.
  double delay = 0;   ///< How far it may be elsewhere because it moves while the answer is made.

  /// Both together.
  double sum() const { return joints + delay; }
};

/// Each part's radius as one number, as `radii` of other questions take it.
inline std::vector<double> sums(std::span<const part_radius> radii) {
  std::vector<double> radius_of_each;
  for (const part_radius& r : radii) radius_of_each.push_back(r.sum());
  return radius_of_each;
}

namespace minimum {

/// What is known of a part's least pair where its points lie.
struct uncertain_pair {
  part_witness measured;
  radius_shares shares;
  bool bounded = true;  ///< False: the point may be anywhere.
  real gap = 0;         ///< Of its cloud.
};

/// Point i as it was measured, as `scan::element_less`: without what is uncertain about it.
template <point_source S>
CLEARANCE_HD auto measured_less(const S& s, std::size_t i, vec3 x, vec3 origin) {
  if constexpr (vague_source<S> && requires { S::viewed; })
    return measured_less(s.*S::viewed, s.number_in_viewed(i), x, origin);
  else if constexpr (vague_source<S> && sharded_source<S>)
    return s.with_piece_of(i, [=](const auto& piece, std::size_t j) { return measured_less(piece, j, x, origin); });
  else
    return scan::element_less(s, i, x, origin);
}

/// Reads a part's pair again, as it was measured. The number after the last part's is the nominal answer's: of its
/// point the shares are read.
template <class PartView, point_source Source>
struct read_pair {
  const PartView* parts;
  backends::few_values<frames::placement, few> places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  world_transform world_from_cloud;
  real gap;  ///< The cloud's.
  std::uint32_t cloud;
  const part_minimum* minima;
  const min_distance_result* nominal;
  uncertain_pair* pairs;

  template <class Traversal>
  CLEARANCE_HD void operator()(std::size_t i, const Traversal& walk) const {
    if (cloud == 0) pairs[i] = {};
    const part_minimum least =
        i < part_count ? minima[i]
                       : part_minimum{nominal->distance, nominal->cloud, nominal->point, nominal->primitive};
    if (least.cloud != cloud || least.point >= source.size()) return;
    const sample s = source[least.point];
    const vec3 p = s.position;
    const radius_shares shares = shares_of(source, least.point, p);
    pairs[i].shares = shares;
    pairs[i].bounded = s.valid();
    pairs[i].gap = gap;
    if (i >= part_count) return;
    const auto k = std::uint32_t(i);
    const frames::placement place = places[k];
    const auto q = scan::moved(place.part_from_cloud, measured_less(source, least.point, p - origin, origin));
    const vec3 at = scan::start_of(q);
    const real radius = shares.sum() + gap,
               within = least.distance + radius + 4 * slack * (absolute(least.distance) + radius + length(at));
    const auto f = evaluate(parts[k], q, within, walk);  // not far beyond the nearest
    if (f.nearest.id == none) return;
    const contact touched = f.at(at, place.world_from_part);
    pairs[i].measured = {.distance = f.distance,
                         .part = k,
                         .cloud = cloud,
                         .point = least.point,
                         .primitive = f.nearest.id,
                         .at = world_from_cloud(p),
                         .nearest = touched.nearest,
                         .normal = touched.normal};
  }
};

}  // namespace minimum

/// The least distance as measured, and what is certain of it: the least of (distance - the point's radius - the part's)
/// over all pairs, less gap, tolerance and rounding. Clouds are `uncertain`; a bare one has radii 0. Throws
/// std::invalid_argument if there is neither no radius nor one per part, or if one is negative or not finite.
struct certain_distance {
  std::vector<part_radius> parts = {};

  using result = certain_distance_result;
  using can = clearance::can<checking, joining, partial, of_balls>;
  template <class On, class PartView>
  class engine;
  template <class PartView>
  using joined = minimum::joined_certain<PartView>;

  /// A point that is unseen may be anywhere.
  static void so_far(result& r, std::uint64_t unseen) {
    minimum::allow_for_unseen(r.nominal, unseen);
    if (unseen == 0) return;
    r.lower = r.certain.lower = 0;
    for (certain_pair& part : r.parts) part.lower = 0;
    if (r.state == state::free) r.state = state::possible;
  }
  void check(std::size_t count) const {
    if (!parts.empty() && parts.size() != count)
      throw std::invalid_argument("clearance: there are " + std::to_string(count) + " parts, but " +
                                  std::to_string(parts.size()) + " radii of parts");
    for (const part_radius& r : parts) {
      detail::check_uncertain(r.joints, "a part's radius by its joints");
      detail::check_uncertain(r.delay, "a part's radius by a delay");
    }
  }
};

template <class On, class PartView>
class certain_distance::engine {
 public:
  /// Throws std::invalid_argument as part_witnesses.
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : on_(on),
        model_(model),
        nominal_(on, model, from...),
        search_(on, model, from...),
        memory_(on, from...),
        back_(on, from...),
        readable_(on, from...) {
    scan::walk_of(on, model);
  }

  /// Enqueues three passes, none of which waits for the one before: what is measured, what is certain of each part, and
  /// the pairs of both.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const certain_distance& q) {
    q.check(model_.size());
    asked_ = &q;
    const std::size_t parts = model_.size();
    const auto& readable = readable_(clouds);
    memory_.begin();
    least_ = memory_.template space<min_distance_result>(2).data();
    minima_ = memory_.template space<part_minimum>(parts).data();
    pairs_ = memory_.template space<minimum::uncertain_pair>(parts + 1).data();
    nominal_.start(poses, mapped_clouds(readable, as_measured{}), min_distance{}, least_);
    search_.start(poses, mapped_clouds(readable, as_filled{}), min_distance_per_part{}, {least_ + 1, minima_});
    vague_ = read(poses, readable);
  }
  result finish() {
    using backends::read_array;
    std::vector<min_distance_result> least;  // as measured, and what is certain
    std::vector<part_minimum> minima;
    std::vector<minimum::uncertain_pair> pairs;
    back_(read_array{least, least_, 2}, read_array{minima, minima_, model_.size()},
          read_array{pairs, pairs_, model_.size() + 1});
    result r;
    r.nominal = least[0];
    r.any_radius = vague_ || !asked_->parts.empty();
    tell(*asked_, least[1], minima, pairs, r);
    minimum::conclude(r);
    return r;
  }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() {
    nominal_.forget();
    search_.forget();
  }

 private:
  /// Reads the pairs that were found. Is there an uncertain cloud?
  template <class Clouds>
  bool read(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds) {
    const auto parts = std::uint32_t(model_.size());
    errors_.assign(parts, 0);
    bool vague = false;
    frames::for_each_turn(
        frame_, model_.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          static_assert(points_or_balls<std::invoke_result_t<as_measured, const S&>>());
          vague = vague || vague_source<S>;
          for (std::uint32_t k = 0; k < parts; ++k) errors_[k] = std::max(errors_[k], double(frame_.places[k].error));
          const auto places = backends::few_or_kept<minimum::few>(frame_.places, memory_);
          minimum::apart<On>::each(on_, model_, parts + 1,
                                   minimum::read_pair<PartView, S>{.parts = model_.parts,
                                                                   .places = places,
                                                                   .part_count = parts,
                                                                   .source = source,
                                                                   .origin = frame_.origin,
                                                                   .world_from_cloud = frame_.world_from_cloud,
                                                                   .gap = rounded_up(rounding_of(source).gap),
                                                                   .cloud = now.cloud,
                                                                   .minima = minima_,
                                                                   .nominal = least_,
                                                                   .pairs = pairs_});
        });
    return vague;
  }

  void tell(const certain_distance& q, const min_distance_result& certain, std::span<const part_minimum> minima,
            std::span<const minimum::uncertain_pair> pairs, result& r) const {
    r.anywhere = certain.dropped[int(drop_reason::too_close)];
    const auto radius = [&q](std::size_t k) { return q.parts.empty() ? part_radius{} : q.parts[k]; };
    for (std::size_t k = 0; k < model_.size(); ++k) {
      const minimum::uncertain_pair& pair = pairs[k];
      certain_pair& part = r.parts.emplace_back();
      if (minima[k].point == none) continue;
      static_cast<part_witness&>(part) = pair.measured;
      part.to_ball = minima[k].distance;
      const frames::float_error error{errors_[k], frame_.error.per_metre};
      const radius_shares& s = pair.shares;
      part.shares = {.noise = s.noise,
                     .calibration = s.calibration,
                     .time = s.time,
                     .joints = radius(k).joints,
                     .delay = radius(k).delay,
                     .gap = frames::slop(model_.facts[k]),
                     .balls = pair.gap,
                     .rounding = error.at(part.to_ball)};
    }
    if (r.nominal.part == none) return;
    const minimum::uncertain_pair& nearest = pairs.back();
    const double uncertain =
        (nearest.bounded ? double(nearest.shares.sum()) : double(infinity)) + radius(r.nominal.part).sum();
    const double most = double(r.nominal.distance) + model_.facts[r.nominal.part].tolerance +
                        frame_.error.at(r.nominal.distance) + uncertain;
    r.state = most < 0 ? state::collision : state::possible;
    r.upper = most < 0 ? 0 : rounded_up(most);
  }

  On on_;
  model_view<PartView> model_;
  min_distance::engine<On, PartView> nominal_;
  min_distance_per_part::engine<On, PartView> search_;
  backends::kept_memory<On> memory_;
  backends::readback<On> back_;
  frames::readable_clouds<On> readable_;
  frames::cloud_frame frame_;
  std::vector<double> errors_;

  // The frame that began: where its answers will be, and is a cloud uncertain?
  const certain_distance* asked_ = nullptr;
  min_distance_result* least_ = nullptr;  // as measured, and what is certain
  part_minimum* minima_ = nullptr;
  minimum::uncertain_pair* pairs_ = nullptr;
  bool vague_ = false;
};

}  // namespace clearance

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From minima to what is certain.

#include <clearance/concepts/answer.hpp>
#include <clearance/frames/frame.hpp>
#include <clearance/result.hpp>

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

namespace clearance::frames {

/// The solid is certainly at least this far away (metres): `distance` less `slop` (gap and tolerance), the clouds' gap
/// and errors.
CLEARANCE_HD inline double certain_distance(real distance, double slop, const frames::float_error& error) {
  return double(distance) - slop - error.gap - error.at(distance);
}

/// By how much a part's nearest pair may be farther than the nearest pair of all, in metres, and still decide what is
/// certain: `slop` is taken from the part's distance, and `least` is the least that is taken of any part. Rounding
/// takes less than a third of a distance (`error_near`).
CLEARANCE_HD inline real extra_reach(double slop, double least) { return rounded_up(1.51 * (slop - least)); }
/// `extra_reach` of all parts. Empty if the nearest pair decides: if the same is taken from every part, or if some part
/// has no certificate, and so nothing is certain.
inline void extra_reaches(std::span<const part_facts> facts, std::vector<real>& extra) {
  double least = infinity, most = 0;
  for (const part_facts& f : facts) {
    least = std::min(least, frames::slop(f));
    most = std::max(most, frames::slop(f));
  }
  extra.clear();
  if (!(least < most && most < infinity)) return;
  for (const part_facts& f : facts) extra.push_back(extra_reach(frames::slop(f), least));
}
/// A bound that is `extra` metres farther, or more by rounding. From 0 on it stays: then nothing is certain of any
/// part.
CLEARANCE_HD inline real farther(real bound, real extra) {
  return extra > 0 && bound > 0 ? (bound + extra) * (1 + 0x1p-22f) : bound;
}
inline bool parts_decide(std::span<const part_facts> facts) {
  std::vector<real> extra;
  extra_reaches(facts, extra);
  return !extra.empty();
}

/// `certain_distance` over all parts' minima: `distance(k)` and `facts(k)` are those of part k. This is the one rule:
/// from each part's distance its own slop is taken.
template <class Distance, class Facts>
CLEARANCE_HD double certain_distance(std::uint32_t parts, Distance distance, Facts facts,
                                     const frames::float_error& error) {
  double least = infinity;
  for (std::uint32_t k = 0; k < parts; ++k) {
    const double lower = certain_distance(distance(k), frames::slop(facts(k)), error);
    least = lower < least ? lower : least;
  }
  return least;
}

/// Adds bracket and state to a result that has distance and part. The distance is at least `lower`, and the winning
/// part may differ by `tolerance` from its surface. `certain`: some point is certainly inside.
CLEARANCE_HD inline void bracket(min_distance_result& r, double lower, real tolerance, bool certain,
                                 const frames::float_error& error) {
  if (r.part == none) return;  // no data
  const double error_here = error.at(r.distance);
  const bool inside = certain || r.distance < -(error_here + tolerance);
  // With a point inside, the distance is 0. Without a certificate (an infinite gap) `lower` is 0.
  r.lower = lower > 0 && !inside ? rounded_down(lower) : 0;
  const double most = double(r.distance) + tolerance + error_here;  // below 0 only if it is certainly inside
  r.upper = inside || most < 0 ? 0 : rounded_up(most);
  r.state = inside ? clearance::state::collision : (r.lower > 0 ? clearance::state::free : clearance::state::possible);
}

/// Something nearer than a sensor can measure may be anywhere in front of it, so nothing is free then. Call it after
/// counts and bracket.
CLEARANCE_HD inline void allow_for_too_close(min_distance_result& r) {
  if (r.dropped[int(drop_reason::too_close)] != 0 && r.state == clearance::state::free) {
    r.state = clearance::state::possible;
    r.lower = 0;
  }
}

}  // namespace clearance::frames

namespace clearance {

/// By how much each part may be nearer than its primitives, metres: a list that is copied when it is written, so that
/// the frames of a prepared question share one.
class part_slops {
 public:
  using value_type = double;

  bool empty() const { return size() == 0; }
  std::size_t size() const { return list_ ? list_->size() : 0; }
  const double* data() const { return list_ ? list_->data() : nullptr; }
  const double* begin() const { return data(); }
  const double* end() const { return data() + size(); }
  double operator[](std::size_t part) const { return (*list_)[part]; }
  friend bool operator==(const part_slops& a, const part_slops& b) { return std::ranges::equal(a, b); }

  double* data() { return own().data(); }
  void resize(std::size_t parts) { own().resize(parts); }
  /// Becomes the slops of these parts; writes them only if they have changed.
  const part_slops& of(std::span<const part_facts> facts) {
    const auto slop_of = [](const part_facts& f) { return frames::slop(f); };
    if (std::ranges::equal(*this, facts, {}, {}, slop_of)) return *this;
    resize(facts.size());
    std::ranges::transform(facts, data(), slop_of);
    return *this;
  }
  /// Covers the other's slops, too.
  void widen(const part_slops& other) {
    if (*this == other) return;
    resize(std::max(size(), other.size()));
    for (std::size_t k = 0; k < other.size(); ++k) data()[k] = std::max((*this)[k], other[k]);
  }

 private:
  std::vector<double>& own() {
    if (!list_ || list_.use_count() > 1) list_ = std::make_shared<std::vector<double>>(begin(), end());
    return *list_;
  }

  std::shared_ptr<std::vector<double>> list_;
};

/// How certain a computed distance is: the error of arithmetic, poses and the source's own rounding and gap, and by how
/// much a part may be nearer than its primitives (gap and tolerance). Metres.
struct distance_certainty {
  frames::float_error error;
  double slop = 0;        ///< The largest slop of all parts.
  part_slops slops = {};  ///< Each part's own slop, if the answer is about each part.

  /// The solid is at least this far away, whichever part the distance is of; 0 if nothing more is certain, or if the
  /// distance is infinite or NaN.
  real lower(real distance) const { return at_least(distance, slop); }
  /// The solid of one part is at least this far away: only what that part may be nearer is taken from its distance.
  real lower(real distance, std::size_t part) const {
    return at_least(distance, part < slops.size() ? slops[part] : slop);
  }
  real lower(const pair_distance& pair) const { return lower(pair.distance, pair.part); }
  /// Covers the other's distances, too.
  void widen(const distance_certainty& other) {
    error.widen(other.error);
    slop = std::max(slop, other.slop);
    slops.widen(other.slops);
  }

 private:
  real at_least(real distance, double less) const {
    const double least = frames::certain_distance(distance, less, error);
    return least > 0 ? rounded_down(least) : 0;
  }
};

inline distance_certainty certainty_of(const frames::frame_facts& frame) { return {frame.error, frame.slop}; }

}  // namespace clearance

namespace clearance::frames {

// What is certain after a search that stopped at a distance.

/// Completes a concluded result without a minimum: if there were points, none of them is within `d_max`.
CLEARANCE_HD inline void beyond(min_distance_result& r, real d_max, double slop, const frames::float_error& error) {
  if (r.part != none || r.valid == 0 || !(d_max < infinity)) return;
  const double lower = certain_distance(d_max, slop, error);
  r.distance = infinity;
  r.lower = lower > 0 ? rounded_down(lower) : 0;
  r.state = r.lower > 0 ? state::free : state::possible;
  allow_for_too_close(r);
}
/// Changes a complete result as if its search had stopped at `d_max`.
CLEARANCE_HD inline void cut(min_distance_result& r, real d_max, double slop, const frames::float_error& error) {
  if (r.part == none || r.distance <= d_max) return;
  min_distance_result none_within;
  none_within.seen = r.seen;
  none_within.valid = r.valid;
  for (int k = 0; k < drop_reasons; ++k) none_within.dropped[k] = r.dropped[k];
  r = none_within;
  beyond(r, d_max, slop, error);
}

}  // namespace clearance::frames

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A source without the points that are no obstacles by their place: outside a work space, on the floor, in a table.

#include <clearance/ground/pose.hpp>
#include <clearance/points/passes_on.hpp>

namespace clearance {

/// A box in a frame of its own, as a cloud's points see it. `inside`: points in it count, its faces included; else
/// those beyond it. Metres; infinite where the box has no end.
struct crop_box {
  rigid_transform box_from_cloud = {};
  vec3 lower = {-infinity, -infinity, -infinity}, upper = {infinity, infinity, infinity};
  bool inside = true;

  CLEARANCE_HD bool keeps(vec3 p) const {
    const vec3 q = box_from_cloud(p);
    const bool in =
        q.x >= lower.x && q.x <= upper.x && q.y >= lower.y && q.y <= upper.y && q.z >= lower.z && q.z <= upper.z;
    return in == inside;
  }
  /// How far p is at least from the places that count, in metres; 0 if it is there.
  CLEARANCE_HD real beyond(vec3 p) const {
    const vec3 q = box_from_cloud(p), below = lower - q, above = q - upper;
    const real out = max(max(max(below.x, above.x), max(below.y, above.y)), max(below.z, above.z));
    const real lost = slack * (length(p) + length(box_from_cloud.translation));
    return max((inside ? out : -out) * (1 - slack) - lost, 0);
  }
  /// Does it certainly keep all that is in an extent?
  bool keeps_all(const extent& box) const {
    if (!(box.lower.x <= box.upper.x)) return true;  // nothing is
    const vec3 center = scaled(0.5f, box.lower + box.upper), half = box.upper - center, q = box_from_cloud(center);
    const real lost = slack * (length(center) + length(half) + length(box_from_cloud.translation));
    const real at[3] = {q.x, q.y, q.z}, low[3] = {lower.x, lower.y, lower.z}, high[3] = {upper.x, upper.y, upper.z};
    bool within = true, apart = false;
    for (int k = 0; k < 3; ++k) {
      const vec3 row = box_from_cloud.row[k];
      const real reach = std::fabs(row.x) * half.x + std::fabs(row.y) * half.y + std::fabs(row.z) * half.z + lost;
      within = within && at[k] - reach >= low[k] && at[k] + reach <= high[k];
      apart = apart || at[k] - reach > high[k] || at[k] + reach < low[k];
    }
    return inside ? within : apart;
  }
};

/// A few boxes: a point counts if all of them keep it.
struct crop_boxes {
  static constexpr std::uint32_t most = 4;
  crop_box box[most];
  std::uint32_t count = 0;

  CLEARANCE_HD bool keep(vec3 p) const {
    for (std::uint32_t k = 0; k < count; ++k)
      if (!box[k].keeps(p)) return false;
    return true;
  }
  CLEARANCE_HD real beyond(vec3 p) const {
    real farthest = 0;
    for (std::uint32_t k = 0; k < count; ++k) farthest = max(farthest, box[k].beyond(p));
    return farthest;
  }
  bool keep_all(const extent& seen) const {
    for (std::uint32_t k = 0; k < count; ++k)
      if (!box[k].keeps_all(seen)) return false;
    return true;
  }
  /// See `rounding_of`.
  void check() const {
    if (count > most) detail::refuse_source("a cloud is cropped by more than " + std::to_string(most) + " boxes");
    for (std::uint32_t k = 0; k < count; ++k) {
      const crop_box& b = box[k];
      if (!(b.lower.x <= b.upper.x && b.lower.y <= b.upper.y && b.lower.z <= b.upper.z))
        detail::refuse_source("a cloud is cropped by a box whose lower corner is not below its upper one");
      bool finite = is_finite(b.box_from_cloud.translation);
      for (const vec3 row : b.box_from_cloud.row) finite = finite && is_finite(row);
      if (!finite) detail::refuse_source("a cloud is cropped by a box at a place that is not finite");
    }
  }
};

/// A source without the points that boxes, in its own frame, do not keep: they are dropped as `cropped`, and the others
/// keep their numbers. Of an `uncertain` one a point counts if its ball reaches where points count. What pixels hide
/// (`unseen`) stays hidden. `cropped_clouds` takes boxes in world coordinates.
template <point_source S>
struct cropped
    : passes_on<cropped<S>, S, sources::fetched, sources::copied, sources::copied_in_pieces, sources::in_pieces> {
  static_assert(points_alone<S>());
  using can = can_all<typename cropped::passed, clearance::can<sources::checked>,
                      can_as<S, sources::surveyed, sources::unfiltered, sources::image>>;

  S source;
  crop_boxes boxes;
  static constexpr auto viewed = &cropped::source;

  CLEARANCE_HD explicit cropped(const S& source, const crop_boxes& boxes = {}) : source(source), boxes(boxes) {}

  CLEARANCE_HD sample operator[](std::size_t i) const {
    sample s = source[i];
    if (s.valid() && !boxes.keep(s.position)) s.dropped = drop_reason::cropped;
    return s;
  }
  /// See `fetched_source`.
  CLEARANCE_HD unsigned look(const typename detail::fetched_types<S>::four& f, std::size_t i, vec3 (&at)[4]) const
    requires fetched_source<S>
  {
    unsigned reasons = source.look(f, i, at);
    if (boxes.count == 0) return reasons;
    CLEARANCE_UNROLL
    for (int j = 0; j < 4; ++j)
      if ((reasons >> 8 * j & 0xff) == 0 && !boxes.keep(at[j])) reasons |= unsigned(drop_reason::cropped) << 8 * j;
    return reasons;
  }
  /// See `surveyed_source`. Only if all that is there is kept.
  bool survey(std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) const
    requires surveyed_source<S>
  {
    if (boxes.count == 0) return source.survey(begin, box, dropped);
    std::uint32_t dropped_now[drop_reasons] = {};
    if (!source.survey(begin, box, dropped_now) || !boxes.keep_all(box)) return false;
    for (int k = 0; k < drop_reasons; ++k) dropped[k] += dropped_now[k];
    return true;
  }
  CLEARANCE_HD bool unfiltered() const
    requires unfiltered_source<S>
  {
    return boxes.count == 0 && source.unfiltered();
  }
  std::uint32_t columns() const
    requires image_source<S>
  {
    return source.columns();
  }
  /// See `beyond_range`: how far p is from the source's range and from what boxes keep.
  CLEARANCE_HD real beyond(std::size_t i, vec3 p) const {
    const real by = boxes.beyond(p);
    return source[i].dropped == drop_reason::out_of_range ? max(by, beyond_range(source, i, p)) : by;
  }
  /// See `sharded_source`.
  auto piece(std::size_t k) const
    requires sharded_source<S>
  {
    return cropped<std::remove_cvref_t<decltype(source.piece(k))>>(source.piece(k), boxes);
  }
  /// See `rounding_of`.
  void check() const { boxes.check(); }
};

/// The image or cloud as it is without its boxes.
struct uncropped {
  template <point_source S>
  CLEARANCE_HD S operator()(const S& s) const {
    return s;
  }
  template <point_source S>
  CLEARANCE_HD auto operator()(const cropped<S>& s) const {
    return (*this)(s.source);
  }
};

}  // namespace clearance

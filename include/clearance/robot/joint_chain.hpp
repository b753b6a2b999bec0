// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Forward kinematics for many configurations: from joint vectors to poses of parts, on any backend, with the same bits.

#include <clearance/backends/host.hpp>
#include <clearance/ground/chain_rounding.hpp>
#include <clearance/ground/math.hpp>
#include <clearance/ground/pose.hpp>
#include <clearance/result.hpp>

#include <span>
#include <utility>

namespace clearance {

// Sine and cosine with the same bits everywhere. Those of libraries differ in the last bit.

struct sine_cosine {
  double sine, cosine;
};

/// Sine and cosine of an angle in radians, within 2e-16. NaN beyond 2^30 rad, where a double says little about an
/// angle.
CLEARANCE_HD inline sine_cosine sine_cosine_of(double angle) {
  if (!(-0x1p30 <= angle && angle <= 0x1p30)) return {double(not_a_number), double(not_a_number)};
  // Subtracts whole quarter turns, with pi / 2 in two doubles, so that the cancellation is exact enough.
  const double quarters = fma(angle, 0x1.45f306dc9c883p-1, angle < 0 ? -0.5 : 0.5);
  const long long turns = static_cast<long long>(quarters);
  const double r = fma(-double(turns), 0x1.1a62633145c07p-54, fma(-double(turns), 0x1.921fb54442d18p+0, angle)),
               rr = r * r;
  // Taylor's series: the first term left out is below 5e-17 at an eighth of a turn.
  constexpr double odd[] = {1.0 / 6227020800, -1.0 / 39916800, 1.0 / 362880, -1.0 / 5040, 1.0 / 120, -1.0 / 6};
  constexpr double even[] = {-1.0 / 87178291200, 1.0 / 479001600, -1.0 / 3628800, 1.0 / 40320,
                             -1.0 / 720,         1.0 / 24,        -1.0 / 2};
  double s = -1.0 / 1307674368000, c = 1.0 / 20922789888000;
  for (int k = 0; k < 6; ++k) s = fma(s, rr, odd[k]);
  for (int k = 0; k < 7; ++k) c = fma(c, rr, even[k]);
  s = fma(s * rr, r, r);
  c = fma(c, rr, 1.0);
  switch (turns & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

/// How a link hangs on its parent: `origin`, then a rotation about `axis` (of length 1) or a shift along it, by
/// `factor` times the joint vector's number `value` plus `offset`, in radians or metres.
struct chain_link {
  world_transform origin;
  position axis{1, 0, 0};
  double factor = 0, offset = 0;
  std::uint32_t value = none;   ///< `none`: the link does not move.
  std::uint32_t parent = none;  ///< `none`: the link hangs on the base.
  bool slides = false;

  /// By how much it moves for this number, and what the terms of that sum add up to.
  CLEARANCE_HD double moves_by(double q) const { return fma(factor, q, offset); }
  CLEARANCE_HD double terms(double q) const {
    const double x = factor * q;
    return (x < 0 ? -x : x) + (offset < 0 ? -offset : offset);
  }
  CLEARANCE_HD bool is_sum() const { return factor != 1 || offset != 0; }
};

struct joint_range {
  double lower = -double(infinity), upper = double(infinity);
};

/// What a kernel needs of a joint chain.
struct joint_chain_view {
  const chain_link* links;
  const std::uint32_t* link_of_part;
  const joint_range* ranges;  ///< One per value.
  std::uint32_t parts, values;
  world_transform base;  ///< World-from-base.

  CLEARANCE_HD bool allows(const double* q) const {
    for (std::uint32_t i = 0; i < values; ++i)
      if (!(q[i] >= ranges[i].lower && q[i] <= ranges[i].upper && q[i] - q[i] == 0)) return false;
    return true;
  }

  /// World-from-part. All its numbers are NaN, which no question takes for a pose, if the joint vector is not allowed,
  /// or if ways cancel so that double loses more than a bracket covers.
  CLEARANCE_HD world_transform pose(const double* q, std::uint32_t part) const {
    world_transform below;
    chain_rounding rounding;
    const auto on = [&](const world_transform& above) {
      const position way = below.translation();
      below = above * below;
      rounding.turn = 0;
      if (above.m[0][0] != 1 || above.m[1][1] != 1 || above.m[2][2] != 1) rounding.turned();
      rounding.step(way, above.translation(), below.translation(), chain_rounding::most(way));
    };
    for (std::uint32_t link = link_of_part[part]; link != none; link = links[link].parent) {
      const chain_link& by = links[link];
      const world_transform step = from_link(by, q);
      rounding.turn = 0;
      if (by.slides) {
        const double shift = by.moves_by(q[by.value]);
        if (by.is_sum()) rounding.lost += chain_rounding::of_sum(by.terms(q[by.value]));
        if (by.origin.m[0][0] != 1 || by.origin.m[1][1] != 1 || by.origin.m[2][2] != 1) rounding.turned();
        rounding.step(by.origin.translation(), {shift * by.axis.x, shift * by.axis.y, shift * by.axis.z},
                      step.translation(), shift < 0 ? -shift : shift);
      }
      on(step);
    }
    on(base);
    if (!allows(q) || !rounding.covered(chain_rounding::least(below.translation())))
      for (auto& row : below.m)
        for (double& x : row) x = double(not_a_number);
    return below;
  }

 private:
  /// Parent-from-link.
  CLEARANCE_HD static world_transform from_link(const chain_link& link, const double* q) {
    if (link.value == none) return link.origin;
    const double by = link.moves_by(q[link.value]);
    const position& a = link.axis;
    world_transform moved;
    if (link.slides) {
      moved.m[0][3] = by * a.x;
      moved.m[1][3] = by * a.y;
      moved.m[2][3] = by * a.z;
    } else {
      const auto [s, c] = sine_cosine_of(by);
      const double v = 1 - c, x = v * a.x, y = v * a.y, z = v * a.z, sx = s * a.x, sy = s * a.y, sz = s * a.z;
      const double turn[3][3] = {{fma(x, a.x, c), fma(x, a.y, -sz), fma(x, a.z, sy)},
                                 {fma(y, a.x, sz), fma(y, a.y, c), fma(y, a.z, -sx)},
                                 {fma(z, a.x, -sy), fma(z, a.y, sx), fma(z, a.z, c)}};
      for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k) moved.m[r][k] = turn[r][k];
    }
    return link.origin * moved;
  }
};

/// Computes poses of all parts, one configuration after another.
struct place_links {
  joint_chain_view chain;
  const double* q;
  world_transform* poses;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const std::size_t configuration = i / chain.parts;
    poses[i] = chain.pose(q + configuration * chain.values, std::uint32_t(i - configuration * chain.parts));
  }
};

/// The name and the range of one number of a joint vector.
struct joint_value {
  std::string name;
  joint_range range;
};

/// Owns a robot's links and joints, as `model` owns its trees. `io::joint_chain_of` makes one from a robot description.
template <class B = host>
class joint_chain {
  static_assert(backend<B>);

 public:
  /// Part k is link `link_of_part[k]`, and `base` is world-from-base. Throws std::invalid_argument if links form a
  /// ring, a number names nothing, an axis of a moving link is not of length 1, a factor or offset is not finite, a
  /// range is none, nothing moves, or a pose is not rigid.
  joint_chain(std::vector<chain_link> links, std::vector<std::uint32_t> link_of_part, std::vector<joint_value> values,
              const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity(), const B& on = {})
      : links_(std::move(links)),
        of_part_(std::move(link_of_part)),
        values_(std::move(values)),
        base_(rigid(base, "the base")) {
    check();
    std::vector<joint_range> ranges;
    for (const joint_value& value : values_) ranges.push_back(value.range);
    links_there_ = on.copy_in(std::span<const chain_link>(links_));
    of_part_there_ = on.copy_in(std::span<const std::uint32_t>(of_part_));
    ranges_there_ = on.copy_in(std::span<const joint_range>(ranges));
  }

  std::size_t parts() const { return of_part_.size(); }
  const std::vector<joint_value>& values() const { return values_; }
  joint_chain_view view() const& CLEARANCE_LIFETIMEBOUND {
    return {links_there_.data(),    of_part_there_.data(),         ranges_there_.data(),
            std::uint32_t(parts()), std::uint32_t(values_.size()), world_transform(base_)};
  }
  joint_chain_view view() const&& = delete;  // the chain would be gone when the view is read; give it a name

  /// A copy where `other` runs.
  template <backend Other>
  joint_chain<Other> on(const Other& other) const {
    return joint_chain<Other>(links_, of_part_, values_, base_, other);
  }

  /// The number of configurations in `q`: one number per value, one configuration after another. Throws
  /// std::invalid_argument if one is not whole, or a number is not finite, outside its range, or turns a link by more
  /// than 2^30 rad (2^22 by a factor and an offset), or if ways to a part cancel so that double loses more than a
  /// bracket covers.
  std::size_t count(std::span<const double> q) const {
    if (q.size() % values_.size() != 0)
      throw std::invalid_argument("clearance: " + std::to_string(q.size()) + " numbers are no whole joint vectors of " +
                                  std::to_string(values_.size()));
    for (std::size_t i = 0; i < q.size(); ++i) {
      const auto& [name, range] = values_[i % values_.size()];
      if (q[i] >= range.lower && q[i] <= range.upper && q[i] - q[i] == 0) continue;
      throw std::invalid_argument("clearance: configuration " + std::to_string(i / values_.size()) + ": joint \"" +
                                  name + "\" at " + std::to_string(q[i]) + " is outside " +
                                  std::to_string(range.lower) + " to " + std::to_string(range.upper));
    }
    for (std::size_t first = 0; first < q.size(); first += values_.size())
      for (const chain_link& link : links_)
        if (link.value != none && !link.slides &&
            !chain_rounding::turns(link.moves_by(q[first + link.value]), link.terms(q[first + link.value]),
                                   link.is_sum()))
          throw std::invalid_argument("clearance: configuration " + std::to_string(first / values_.size()) +
                                      ": joint \"" + values_[link.value].name + "\" turns a link by more than " +
                                      (link.is_sum() ? "2^22 rad, times a factor or plus an offset" : "2^30 rad"));
    check_ways(q);
    return q.size() / values_.size();
  }

  /// World-from-part, one per part of the first configuration, then those of the next, as min_distances takes them.
  /// Throws as `count`.
  std::vector<Eigen::Isometry3d> poses(std::span<const double> q) const
    requires std::is_same_v<B, host>
  {
    std::vector<world_transform> all(count(q) * parts());
    host{}.for_each(all.size(), place_links{view(), q.data(), all.data()});
    std::vector<Eigen::Isometry3d> out;
    for (const world_transform& t : all) out.push_back(to_isometry(t));
    return out;
  }

 private:
  /// A bound on all ways clears ordinary robots at once; only others are followed joint by joint.
  void check_ways(std::span<const double> q) const {
    double origins = chain_rounding::most(world_transform(base_).translation());
    for (const chain_link& link : links_) origins += chain_rounding::most(link.origin.translation());
    const double each = double(links_.size() + 1) * 64 * 0x1p-53;
    for (std::size_t first = 0; first < q.size(); first += values_.size()) {
      double ways = origins;
      for (const chain_link& link : links_)
        if (link.value != none && link.slides) ways += 2 * link.terms(q[first + link.value]);
      if (each * ways <= 1e-9) continue;
      joint_chain_view here{links_.data(), of_part_.data(), nullptr, std::uint32_t(parts()), 0, world_transform(base_)};
      for (std::uint32_t part = 0; part < parts(); ++part)
        if (const world_transform pose = here.pose(q.data() + first, part); !(pose.m[0][3] - pose.m[0][3] == 0))
          throw std::invalid_argument("clearance: configuration " + std::to_string(first / values_.size()) +
                                      " puts part " + std::to_string(part) +
                                      " by ways that cancel, and double loses more of them than a bracket covers");
    }
  }

  void check() const {
    const auto refuse = [](const std::string& why) { throw std::invalid_argument("clearance: a joint chain " + why); };
    if (values_.empty()) refuse("has no joint that moves");
    for (const auto& [name, range] : values_)
      if (!(range.lower <= range.upper))
        refuse("has joint \"" + name + "\" with a range from " + std::to_string(range.lower) + " to " +
               std::to_string(range.upper));
    std::vector<bool> hangs(links_.size());  // known to hang on the base
    for (const chain_link& link : links_) {
      rigid_transform_of(to_isometry(link.origin), "a link's origin");
      if (link.value != none && link.value >= values_.size())
        refuse("has a link that moves by number " + std::to_string(link.value) + ", which is none");
      const double length = std::hypot(link.axis.x, link.axis.y, link.axis.z);
      if (link.value != none && !(std::abs(length - 1) < 1e-9))
        refuse("has an axis of length " + std::to_string(length) + ", which must be 1");
      if (link.value != none && !(std::isfinite(link.factor) && std::isfinite(link.offset)))
        refuse("has a link that moves by a factor of " + std::to_string(link.factor) + " and an offset of " +
               std::to_string(link.offset) + ", which must be finite");
      std::size_t steps = 0;
      for (std::uint32_t at = link.parent; at != none && (at >= links_.size() || !hangs[at]); at = links_[at].parent)
        if (at >= links_.size() || ++steps > links_.size()) refuse("has links that hang on no base");
      for (std::uint32_t at = std::uint32_t(&link - links_.data()); at != none && !hangs[at]; at = links_[at].parent)
        hangs[at] = true;
    }
    for (const std::uint32_t link : of_part_)
      if (link >= links_.size()) refuse("has a part that is link " + std::to_string(link) + ", which is none");
  }

  std::vector<chain_link> links_;
  std::vector<std::uint32_t> of_part_;
  std::vector<joint_value> values_;
  Eigen::Isometry3d base_;
  typename B::template buffer<chain_link> links_there_;
  typename B::template buffer<std::uint32_t> of_part_there_;
  typename B::template buffer<joint_range> ranges_there_;
};

}  // namespace clearance

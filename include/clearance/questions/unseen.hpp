// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from what no camera sees?

#include <clearance/points/hidden.hpp>
#include <clearance/points/pinhole_view.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/part_witnesses.hpp>

#include <algorithm>
#include <bit>
#include <deque>

namespace clearance {

/// A part, and where the room that no camera sees is nearest to it: `cloud` is the camera, `point` the pixel, `at` lies
/// on the pixel's way. Metres.
struct unseen_part : part_witness {
  real lower = 0;        ///< At least so far away is all that no camera sees and some camera hides.
  real out_of_view = 0;  ///< Which share of the ball around the part no camera shows. Nothing is said about that. NaN
                         ///< if a ray image may show the rest.
};

/// `all`: as a min_distance_result. If the robot reaches into what is hidden its state is `unknown`. `seen` counts
/// pixels, `valid` those that hide room. With several cameras a place is hidden only if no camera sees it: `lower`
/// holds for that, `distance` is an estimate, and `upper` is not known (infinite).
struct unseen_result {
  min_distance_result all;
  std::vector<unseen_part> parts;
  min_distance_result own_shadow;  ///< What pixels of the robot's own points (`masked`) hide, of all cameras together.
};

/// Half the diagonal of the widest pixel of a ray table, at z = 1, in host memory.
inline double half_pixel_of(const ray* rays, std::size_t width, std::size_t height) {
  double widest = 0;
  const auto apart = [&](std::size_t i, std::size_t j) {
    const double d = std::hypot(double(rays[i].x) - rays[j].x, double(rays[i].y) - rays[j].y) / 2;
    if (d > widest) widest = d;
  };
  for (std::size_t v = 0; v + 1 < height; ++v)
    for (std::size_t u = 0; u + 1 < width; ++u) {
      const std::size_t i = v * width + u;
      apart(i, i + width + 1), apart(i + 1, i + width);
    }
  return widest;
}

/// How far is the robot from the room that depth images hide? Clouds are depth_image or ray_image, or `masked` ones, or
/// `uncertain` ones of those: then hidden is what may be hidden, so that the state is not `unknown` but `possible`.
/// Throws std::invalid_argument for depths that are no range, and for a ray image without `half_pixel`.
struct unseen {
  hiding room = {};
  double half_pixel = 0;  ///< For ray images: `half_pixel_of` their table.

  using result = unseen_result;
  template <class On, class PartView>
  class engine;

  void check() const {
    if (!(room.nearest > 0 && room.farthest > room.nearest && room.farthest <= 1e6f))
      throw std::invalid_argument("clearance: unseen room is from z = " + std::to_string(room.nearest) + " m to " +
                                  std::to_string(room.farthest) + " m, which must be a range above 0 and below 1e6");
    if (!(half_pixel >= 0 && half_pixel < 0.25))
      throw std::invalid_argument("clearance: half a pixel is " + std::to_string(half_pixel) +
                                  " wide at z = 1, which must be 0 or more and below 0.25");
  }
};

namespace detail {

template <class S>
struct bare_image {
  static const S& of(const S& s) { return s; }
};
template <class S>
struct bare_image<masked<S>> {
  static const S& of(const masked<S>& s) { return s.source; }
};

/// What of an image is hidden room, with what is uncertain about the image.
template <bool Own, class S>
hidden<S, Own> hidden_of(const S& image, const hiding& room, real half_pixel) {
  return {image, room, half_pixel};
}
template <bool Own, class S, class N>
uncertain<hidden<S, Own>, N> hidden_of(const uncertain<S, N>& image, const hiding& room, real half_pixel) {
  return image.around_same(hidden<S, Own>{image.source, room, half_pixel});
}

}  // namespace detail

template <class On, class PartView>
class unseen::engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : on_(on), model_(model), witnesses_(on, model, from...) {}

  template <class Clouds>
  result run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const unseen& q) {
    q.check();
    cameras_.clear();
    result r;
    std::uint32_t number = 0;
    for_each_cloud(clouds,
                   [&](const auto& image, const Eigen::Isometry3d& pose) { look(poses, image, pose, q, number++, r); });
    conclude(q, r);
    return r;
  }

 private:
  using asks = min_distance_per_part;
  using there = typename minimum::loop_of<On>::type;
  using search = minimum::engine<there, PartView, asks>;

  /// What one camera says about each part.
  struct camera {
    min_distance_result all;
    std::vector<part_witness> nearest;
    std::vector<double> lower, own;  ///< How far at least all is that it hides, and its own shadow.
    std::vector<double> from_edge;
    std::vector<std::uint64_t> shown;  ///< Of the samples of a part's ball, one bit each.
    bool tells_shown, vague;
  };

  template <class S>
  void look(std::span<const Eigen::Isometry3d> poses, const S& image, const Eigen::Isometry3d& pose, const unseen& q,
            std::uint32_t number, result& r) {
    using seen = std::invoke_result_t<as_measured, const S&>;
    static_assert(seeing_image<seen>, "unseen is asked about depth_image and ray_image, or masked or uncertain ones");
    const seen measured = as_measured{}(image);
    const auto& bare = detail::bare_image<seen>::of(measured);
    constexpr bool pinhole = requires { bare.inverse_fx; };
    double half = q.half_pixel;
    if constexpr (pinhole) half = std::hypot(double(bare.inverse_fx), double(bare.inverse_fy)) / 2;
    if (image.size() != 0 && !(half > 0))
      throw std::invalid_argument(
          "clearance: unseen needs half_pixel for a ray image; half_pixel_of(rays, width, "
          "height) computes it");
    const auto room = detail::hidden_of<false>(image, q.room, rounded_up(half));
    camera c;
    auto found = ask_of(2 * number, poses, room, pose);
    c.all = found.all, c.nearest = witnesses_.run(poses, placed{room, pose}, part_witnesses{found.parts});
    const frames::cloud_frame frame(model_.facts, poses, pose, rounding_of(room));
    const auto lower = [&](std::size_t k, const min_distance_per_part_result& of) {
      if (of.all.dropped[int(drop_reason::too_close)] != 0) return -double(infinity);  // an unbounded radius
      if (of.parts[k].cloud == none) return double(infinity);
      return minimum::certain_distance(of.parts[k].distance, frames::slop(model_.facts[k]),
                                       {frame.places[k].error, frame.error.per_metre});
    };
    c.own.assign(model_.size(), infinity), c.tells_shown = pinhole;
    c.vague = vague_source<S>;
    for (std::size_t k = 0; k < model_.size(); ++k) {
      c.lower.push_back(lower(k, found));
      c.nearest[k].cloud = c.nearest[k].part == none ? none : number;
      c.from_edge.push_back(0), c.shown.push_back(0);
      if constexpr (pinhole) {
        const pinhole_view view(bare, q.room.nearest, q.room.farthest);
        const ball& around = frame.places[k].around;
        const vec3 middle = around.center + frame.origin;
        double& edge = c.from_edge.back() = view.from_edge({middle, around.radius}) - frames::slop(model_.facts[k]);
        if constexpr (requires { image.turn; })  // the view may be turned and shifted
          edge = fma(-double(image.turn), double(length(middle)) + around.radius, edge - image.shift) /
                 (1 + double(image.turn));
        c.shown.back() = shown(view, model_.facts[k], pose.inverse() * poses[k]);
      }
    }
    if constexpr (requires { measured.labels; }) {
      const auto shadow = detail::hidden_of<true>(image, q.room, rounded_up(half));
      const auto each = ask_of(2 * number + 1, poses, shadow, pose);
      for (std::size_t k = 0; k < model_.size(); ++k) c.own[k] = lower(k, each);
      min_distance_result own = each.all;
      if (own.cloud != none) own.cloud = number;
      if (c.vague) own.upper = infinity;
      r.own_shadow = merge(r.own_shadow, own);
    }
    cameras_.push_back(std::move(c));
  }

  template <class S>
  min_distance_per_part_result ask_of(std::size_t slot, std::span<const Eigen::Isometry3d> poses, const S& room,
                                      const Eigen::Isometry3d& pose) {
    while (searches_.size() <= slot) searches_.emplace_back(minimum::loop_of<On>::on(on_), model_);
    return searches_[slot].run(poses, placed<S>{room, pose}, asks{});
  }

  /// Which of 64 places in the ball around a part a camera shows, one bit each.
  static std::uint64_t shown(const pinhole_view& view, const part_facts& facts,
                             const Eigen::Isometry3d& camera_from_part) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i) {  // equal shares of the volume, turned by the golden angle
      const double away = facts.radius * std::cbrt((i * 37 % 64 + 0.5) / 64), up = 1 - (2 * i + 1) / 64.0,
                   turn = 2.399963229728653 * i, beside = std::sqrt(1 - up * up);
      const Eigen::Vector3d at(facts.center.x + away * beside * std::cos(turn),
                               facts.center.y + away * beside * std::sin(turn), facts.center.z + away * up);
      const Eigen::Vector3d there = camera_from_part * at;
      bits |= std::uint64_t(view.shows(there.x(), there.y(), there.z())) << i;
    }
    return bits;
  }

  /// A place is unseen only if no camera sees it. So what camera j hides near a part is also hidden by every other
  /// camera, or by the robot before it, or out of its view.
  void conclude(const unseen& q, result& r) const {
    if (cameras_.empty()) return;
    if (r.own_shadow.state == state::collision) r.own_shadow.state = state::unknown;
    r.all = cameras_[0].all;
    for (std::size_t j = 1; j < cameras_.size(); ++j) {
      const min_distance_result& more = cameras_[j].all;
      r.all.seen += more.seen, r.all.valid += more.valid;
      for (int i = 0; i < drop_reasons; ++i) r.all.dropped[i] += more.dropped[i];
    }
    double lower = infinity;
    const unseen_part* least = nullptr;
    r.parts.resize(model_.size());
    for (std::size_t k = 0; k < model_.size(); ++k) {
      unseen_part& part = r.parts[k];
      double its_lower = infinity;
      std::uint64_t shown = 0;
      bool tells_shown = true;
      for (const camera& j : cameras_) {
        double distance = j.nearest[k].distance, at_least = j.lower[k];
        for (const camera& i : cameras_)
          if (&i != &j) {
            distance = std::max(distance, std::min<double>(i.nearest[k].distance, std::max(i.from_edge[k], 0.0)));
            at_least = std::max(at_least, std::min({i.lower[k], i.own[k], i.from_edge[k]}));
          }
        if (distance < part.distance) static_cast<part_witness&>(part) = j.nearest[k], part.distance = real(distance);
        its_lower = std::min(its_lower, at_least);
        shown |= j.shown[k], tells_shown &= j.tells_shown;
      }
      part.lower = its_lower > 0 ? rounded_down(its_lower) : 0;
      const int out_of_view = 64 - std::popcount(shown);
      part.out_of_view = tells_shown || out_of_view == 0 ? real(out_of_view) / 64 : not_a_number;
      lower = std::min(lower, its_lower);
      if (least == nullptr || part.distance < least->distance) least = &part;
    }
    if (r.all.seen == 0 || least == nullptr) return;  // nothing is known
    min_distance_result& all = r.all;
    all.cloud = least->cloud, all.point = least->point, all.part = least->part, all.primitive = least->primitive;
    all.at = least->at, all.nearest = least->nearest, all.normal = least->normal;
    all.distance = least->distance;
    all.lower = lower > 0 ? rounded_down(lower) : 0;
    const bool vague = std::ranges::any_of(cameras_, &camera::vague);
    if (cameras_.size() > 1 || all.part == none || vague) all.upper = infinity;
    const bool reaches = all.distance <= 4 * slack * q.room.farthest;  // up to rounding
    all.state = all.lower > 0 ? state::free : reaches && !vague ? state::unknown : state::possible;
  }

  On on_;
  model_view<PartView> model_;
  part_witnesses::engine<On, PartView> witnesses_;
  std::deque<search> searches_;  // one for each camera, and one for its own shadow
  std::vector<camera> cameras_;
};

}  // namespace clearance

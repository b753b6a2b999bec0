// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from what no camera sees?

#include <clearance/backend/kept_memory.hpp>
#include <clearance/points/hidden.hpp>
#include <clearance/points/pinhole_view.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/part_witnesses.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <deque>
#include <functional>
#include <span>
#include <variant>

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

/// How far is the robot from the room that depth images hide? Clouds are depth_image or ray_image, or `masked` ones, or
/// `uncertain` ones of those: then hidden is what may be hidden, so that the state is not `unknown` but `possible`.
/// Refused: depths that are no range, a ray image without `half_pixel`, and not one label per pixel.
struct unseen {
  hiding room = {};                          ///< Where hidden room begins and ends.
  double half_pixel = 0;                     ///< For ray images: `half_pixel_of` their table.
  std::span<const point_label> labels = {};  ///< Of all pixels of all clouds, as self_filter gives them, or none.
  bool places = false;  ///< Also where every part is nearest: `at`, `nearest` and `normal`, as the robot always has.

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
inline constexpr bool is_masked = false;
template <class S>
inline constexpr bool is_masked<masked<S>> = true;

template <class T>
concept some_variant = requires { typename std::variant_size<T>::type; };
/// Is it known only when they are asked about which of these clouds are images?
template <class T>
concept clouds_of_variants =
    some_variant<T> || requires(const T t) { requires some_variant<std::remove_cvref_t<decltype(*std::begin(t))>>; };

/// Hidden room with what is uncertain about its image.
template <class S>
hidden<S> as_uncertain(const auto&, const hidden<S>& room) {
  return room;
}
template <class Image, class S, class N>
uncertain<hidden<S>, N> as_uncertain(const uncertain<Image, N>& image, const hidden<S>& room) {
  return image.around_same(room);
}

}  // namespace detail

template <class On, class PartView>
class unseen::engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : model_(model),
        memory_(on, from...),
        witnesses_(on, model, from...),
        make_([on, model, from...] { return search(on, model, from...); }) {}

  template <class Clouds>
  result run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const unseen& q) {
    q.check();
    cameras_.clear();
    result r;
    const point_label* labels = nullptr;
    if (!q.labels.empty()) {
      std::size_t pixels = 0;
      for_each_cloud(clouds, [&](const auto& image, const auto&) { pixels += image.size(); });
      if (q.labels.size() != pixels)
        throw std::invalid_argument("clearance: unseen has " + std::to_string(q.labels.size()) +
                                    " labels, and there are " + std::to_string(pixels) + " pixels");
      memory_.begin();
      labels = std::get<0>(memory_.put(q.labels));
    }
    std::uint32_t number = 0;
    const bool places = q.places || count_clouds(clouds) > 1;  // the least of several cameras may be any part's
    for_each_cloud(clouds, [&]<class S>(const S& given, const Eigen::Isometry3d& pose) {
      const auto image = as_measured{}(given);
      if constexpr (seeing_image<decltype(as_measured{}(given))>) {
        look(poses, given, image, pose, labels, q, number++, places, r);
        if (labels != nullptr) labels += image.size();
      } else if constexpr (detail::is_masked<std::remove_cvref_t<decltype(as_measured{}(given))>>) {
        if (labels != nullptr)
          throw std::invalid_argument("clearance: unseen has labels, and so has cloud " + std::to_string(number));
        look(poses, given, image.source, pose, image.labels, q, number++, places, r);
      } else {
        refuse<Clouds, S>(number);
      }
    });
    conclude(q, r);
    return r;
  }

 private:
  using asks = min_distance_per_part;
  using search = minimum::engine<On, PartView, asks>;

  /// What one camera says about each part.
  struct camera {
    min_distance_result all;
    std::vector<part_witness> nearest;
    std::vector<double> lower, own;  ///< How far at least all is that it hides, and its own shadow.
    std::vector<double> from_edge;
    std::vector<std::uint64_t> shown;  ///< Of the samples of a part's ball, one bit each.
    bool tells_shown, vague;
  };

  template <class Clouds, class S>
  [[noreturn]] static void refuse(std::uint32_t number) {
    static_assert(detail::clouds_of_variants<Clouds>,
                  "unseen is asked about depth_image and ray_image, or masked or uncertain ones");
    throw std::invalid_argument("clearance: unseen is asked about depth images, and cloud " + std::to_string(number) +
                                " is none");
  }

  /// `labels`: of this image, or null.
  template <class Given, seeing_image S>
  void look(std::span<const Eigen::Isometry3d> poses, const Given& given, const S& image, const Eigen::Isometry3d& pose,
            const point_label* labels, const unseen& q, std::uint32_t number, bool places, result& r) {
    constexpr bool pinhole = requires(const S& s) { s.inverse_fx; };
    double half = q.half_pixel;
    if constexpr (pinhole) half = std::hypot(double(image.inverse_fx), double(image.inverse_fy)) / 2;
    if (image.size() != 0 && !(half > 0 && half < infinity))
      throw std::invalid_argument(
          pinhole
              ? "clearance: unseen needs focal lengths that are numbers, not 0"
              : "clearance: unseen needs half_pixel for a ray image; half_pixel_of(rays, width, height) computes it");
    if constexpr (pinhole)
      if (!is_finite(vec3{image.cx, image.cy, 0}))
        throw std::invalid_argument("clearance: unseen needs a centre of the image (cx, cy) that is finite");
    const auto hides = [&](bool own) {
      return detail::as_uncertain(given, hidden<S>{image, q.room, rounded_up(half), labels, own});
    };
    const auto room = hides(false);
    camera c;
    auto found = ask_of(2 * number, poses, room, pose);
    c.all = found.all;
    if (places)
      c.nearest = witnesses_.run(poses, placed{room, pose}, part_witnesses{found.parts});
    else
      for (std::uint32_t k = 0; k < model_.size(); ++k)
        if (const part_minimum& its = found.parts[k]; its.cloud != none)
          c.nearest.push_back({its.distance, k, its.cloud, its.point, its.primitive});
        else
          c.nearest.push_back({});
    const frames::cloud_frame frame(model_.facts, poses, pose, rounding_of(room));
    const auto lower = [&](std::size_t k, const min_distance_per_part_result& of) {
      if (of.all.dropped[int(drop_reason::too_close)] != 0) return -double(infinity);  // an unbounded radius
      if (of.parts[k].cloud == none) return double(infinity);
      return minimum::certain_distance(of.parts[k].distance, frames::slop(model_.facts[k]),
                                       {frame.places[k].error, frame.error.per_metre});
    };
    c.own.assign(model_.size(), infinity), c.tells_shown = pinhole;
    c.vague = vague_source<Given>;
    for (std::size_t k = 0; k < model_.size(); ++k) {
      c.lower.push_back(lower(k, found));
      c.nearest[k].cloud = c.nearest[k].part == none ? none : number;
      c.from_edge.push_back(0), c.shown.push_back(0);
      if constexpr (pinhole) {
        const pinhole_view view(image, q.room.nearest, q.room.farthest);
        const ball& around = frame.places[k].around;
        const vec3 middle = around.center + frame.origin;
        double& edge = c.from_edge.back() = view.from_edge({middle, around.radius}) - frames::slop(model_.facts[k]);
        if constexpr (vague_source<Given>)  // the view may be turned and shifted
          edge = fma(-double(given.turn), double(length(middle)) + around.radius, edge - given.shift) /
                 (1 + double(given.turn));
        c.shown.back() = view.shows_of_ball(model_.facts[k].center, model_.facts[k].radius, pose.inverse() * poses[k]);
      }
    }
    if (labels != nullptr) {
      const auto each = ask_of(2 * number + 1, poses, hides(true), pose);
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
    while (searches_.size() <= slot) searches_.push_back(make_());
    return searches_[slot].run(poses, placed<S>{room, pose}, asks{});
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
    // A pixel without a direction shows and hides nothing. If no other is there, nothing is known.
    const bool blind = r.all.seen == r.all.dropped[int(drop_reason::not_finite)];
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
      part.lower = its_lower > 0 && !blind ? rounded_down(its_lower) : 0;
      const int out_of_view = 64 - std::popcount(shown);
      part.out_of_view = tells_shown || out_of_view == 0 ? real(out_of_view) / 64 : not_a_number;
      lower = std::min(lower, its_lower);
      if (least == nullptr || part.distance < least->distance) least = &part;
    }
    if (blind || least == nullptr) return;
    min_distance_result& all = r.all;
    if (cameras_.size() > 1 || all.part == none) {
      all.cloud = least->cloud, all.point = least->point, all.part = least->part, all.primitive = least->primitive;
      all.at = least->at, all.nearest = least->nearest, all.normal = least->normal;
      all.distance = least->distance, all.upper = infinity;
    }
    all.lower = lower > 0 ? rounded_down(lower) : 0;
    const bool vague = std::ranges::any_of(cameras_, &camera::vague);
    if (vague) all.upper = infinity;
    const bool reaches = all.distance <= 4 * slack * q.room.farthest;  // up to rounding
    all.state = all.lower > 0 ? state::free : reaches && !vague ? state::unknown : state::possible;
  }

  model_view<PartView> model_;
  backends::kept_memory<On> memory_;
  part_witnesses::engine<On, PartView> witnesses_;
  std::function<search()> make_;
  std::deque<search> searches_;  // one for each camera, and one for its own shadow
  std::vector<camera> cameras_;
};

}  // namespace clearance

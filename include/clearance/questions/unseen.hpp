// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from what no camera sees?

#include <clearance/backends/kept_memory.hpp>
#include <clearance/backends/readback.hpp>
#include <clearance/ground/borrowed.hpp>
#include <clearance/minimum/merge.hpp>
#include <clearance/points/cropped.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/hidden.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/robot/widened.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <functional>
#include <span>
#include <variant>
#include <vector>

namespace clearance {

// What several cameras hide together, part by part.

/// A part, and where the room that no camera sees is nearest to it: `cloud` is the camera, `point` the pixel, `at` lies
/// on the pixel's way. Metres.
struct unseen_part : part_witness {
  real lower = 0;        ///< Room that some camera hides and no camera sees is at least so far away.
  real out_of_view = 0;  ///< The share, 0 to 1, of the ball around the part that no camera shows; nothing is said about
                         ///< it. NaN if a ray image may show the rest.
  /// If `edges` are asked for: at least so many metres lie between the ball around the part and all that no image
  /// shows. 0: some of the ball is not shown. NaN: there are ray images alone.
  real to_edge = not_a_number;
};

/// `all`: as a min_distance_result. If the robot reaches into what is hidden its state is `unknown`. `seen` counts
/// pixels, `valid` those that hide room. With several cameras a place is hidden only if no camera sees it: `lower`
/// holds for that, `distance` is an estimate, and `upper` is not known (infinite).
struct unseen_result {
  min_distance_result all;
  std::vector<unseen_part> parts;
  /// The least distance to what pixels of the robot's own points (`masked`) hide from all cameras together.
  min_distance_result own_shadow;
};

namespace minimum {

/// What one camera says about each part. It is kept from frame to frame.
struct camera_finding {
  // What is known before the search ends.
  std::vector<frames::float_error> errors;  ///< How far off each part's distance may be.
  frames::float_error error;                ///< How far off any part's distance may be.
  std::vector<double> from_edge;
  std::vector<std::uint64_t> shown;  ///< Which samples of each part's ball the camera shows, one bit each.
  bool tells_shown, vague;
  bool shadow;  ///< Is the robot's own shadow asked about?

  // What the search has found.
  min_distance_result all;
  std::vector<part_witness> nearest;
  std::vector<double> lower, own;  ///< How far at least all is that it hides, and its own shadow.

  void clear() {
    errors.clear();
    from_edge.clear();
    shown.clear();
    nearest.clear();
    lower.clear();
    own.clear();
  }
};

/// A place is unseen only if no camera sees it. So what camera j hides near a part is also hidden by every other
/// camera, or by the robot before it, or out of its view.
inline void join(std::span<const camera_finding> cameras, real farthest, std::span<const double> radii, bool edges,
                 std::size_t parts, unseen_result& r) {
  if (cameras.empty()) return;
  if (r.own_shadow.state == state::collision) r.own_shadow.state = state::unknown;
  r.all = cameras[0].all;
  for (const camera_finding& other : cameras.subspan(1)) {
    const min_distance_result& more = other.all;
    r.all.seen += more.seen;
    r.all.valid += more.valid;
    for (int i = 0; i < drop_reasons; ++i) r.all.dropped[i] += more.dropped[i];
  }
  // A pixel without a direction shows and hides nothing. If no other is there, nothing is known.
  const bool blind = r.all.seen == r.all.dropped[int(drop_reason::not_finite)];
  double lower = infinity;
  const unseen_part* least = nullptr;
  r.parts.resize(parts);
  for (std::size_t k = 0; k < parts; ++k) {
    unseen_part& part = r.parts[k];
    double its_lower = infinity;
    std::uint64_t shown = 0;
    bool tells_shown = true;
    double edge = -1;
    for (const camera_finding& j : cameras) {
      double distance = j.nearest[k].distance, at_least = j.lower[k];
      for (const camera_finding& i : cameras)
        if (&i != &j) {
          distance = std::max(distance, std::min<double>(i.nearest[k].distance, std::max(i.from_edge[k], 0.0)));
          at_least = std::max(at_least, std::min({i.lower[k], i.own[k], i.from_edge[k]}));
        }
      if (distance < part.distance) {
        static_cast<part_witness&>(part) = j.nearest[k];
        part.distance = real(distance);
      }
      its_lower = std::min(its_lower, at_least);
      shown |= j.shown[k];
      tells_shown &= j.tells_shown;
      if (j.tells_shown) edge = std::max({edge, j.from_edge[k], 0.0});
    }
    if (edges && edge >= 0) part.to_edge = rounded_down(edge);
    part.lower = its_lower > 0 && !blind ? rounded_down(its_lower) : 0;
    const int out_of_view = 64 - std::popcount(shown);
    part.out_of_view = tells_shown || out_of_view == 0 ? real(out_of_view) / 64 : not_a_number;
    lower = std::min(lower, its_lower);
    if (least == nullptr || part.distance < least->distance) least = &part;
  }
  if (blind || least == nullptr) return;
  min_distance_result& all = r.all;
  if (cameras.size() > 1 || all.part == none) {
    all.cloud = least->cloud;
    all.point = least->point;
    all.part = least->part;
    all.primitive = least->primitive;
    all.at = least->at;
    all.nearest = least->nearest;
    all.normal = least->normal;
    all.distance = least->distance;
    all.upper = infinity;
  }
  all.lower = lower > 0 ? rounded_down(lower) : 0;
  const bool vague = std::ranges::any_of(cameras, &camera_finding::vague);
  if (vague) all.upper = infinity;
  const double radius = all.part == none ? 0 : radius_of(radii, all.part);
  const bool reaches = all.distance + radius <= 4 * slack * farthest;  // up to rounding
  all.state = all.lower > 0 ? state::free : reaches && !vague ? state::unknown : state::possible;
}

}  // namespace minimum

// What a camera can see at all, whatever is there.

/// The room that a pinhole image shows, between two depths (metres of z): a pyramid without its tip.
struct pinhole_view {
  double left, right, top, bottom;  ///< The image's edges at z = 1, pixels' own halves included.
  double nearest, farthest;

  template <class Pixel>
  pinhole_view(const depth_image<Pixel>& image, double nearest, double farthest)
      : left((-0.5 - image.cx) * image.inverse_fx),
        right((image.width - 0.5 - image.cx) * image.inverse_fx),
        top((-0.5 - image.cy) * image.inverse_fy),
        bottom((image.height - 0.5 - image.cy) * image.inverse_fy),
        nearest(nearest),
        farthest(farthest) {}

  bool shows(double x, double y, double z) const {
    return z >= nearest && z <= farthest && x >= left * z && x <= right * z && y >= top * z && y <= bottom * z;
  }
  /// How far everything in a ball is at least from all that is not shown; 0 or less if some of the ball is not. The
  /// camera's frame, metres.
  double from_edge(const ball& b) const {
    const double x = b.center.x, y = b.center.y, z = b.center.z;
    const auto inward = [&](double across, double slope, double sign) {
      return sign * (slope * z - across) / std::hypot(1, slope);
    };
    const double least = std::min({inward(x, left, -1), inward(x, right, 1), inward(y, top, -1), inward(y, bottom, 1),
                                   z - nearest, farthest - z});
    return least - b.radius - 1e-6 * (std::fabs(x) + std::fabs(y) + std::fabs(z));
  }

  /// Which of 64 places in a ball it shows, one bit each. `center` and `radius` in a part's frame, metres.
  std::uint64_t shows_of_ball(vec3 center, double radius, const Eigen::Isometry3d& camera_from_part) const {
    static const auto places = [] {  // equal shares of the volume, turned by the golden angle
      std::array<Eigen::Vector3d, 64> all;
      for (int i = 0; i < 64; ++i) {
        const double away = std::cbrt((i * 37 % 64 + 0.5) / 64), up = 1 - (2 * i + 1) / 64.0,
                     turn = 2.399963229728653 * i, beside = std::sqrt(1 - up * up);
        all[std::size_t(i)] = away * Eigen::Vector3d(beside * std::cos(turn), beside * std::sin(turn), up);
      }
      return all;
    }();
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i) {
      const Eigen::Vector3d at =
          camera_from_part * (Eigen::Vector3d(center.x, center.y, center.z) + radius * places[std::size_t(i)]);
      bits |= std::uint64_t(shows(at.x(), at.y(), at.z())) << i;
    }
    return bits;
  }
};

/// How far is the robot from the room that depth images hide? Clouds are depth_image or ray_image, or `masked` or
/// `cropped` ones (what is cropped hides as before), or `uncertain` ones of those: then hidden is what may be hidden,
/// so that the state is not `unknown` but `possible`. Refused: depths that are no range, a ray image without
/// `half_pixel`, not one label per pixel, and radii as in_collision.
struct unseen {
  hiding room = {};                   ///< Where hidden room begins and ends.
  double half_pixel = 0;              ///< What `half_pixel_of` says of a ray image's table; 0 without ray images.
  borrowed<point_label> labels = {};  ///< Whose each pixel of all clouds is, as self_filter gives it; or none.
  bool places = false;                ///< Whether to tell of every part, as of the robot, `at`, `nearest` and `normal`.
  bool edges = false;                 ///< Whether to tell `to_edge`: how far every part is from the edge of the view.
  std::vector<double> radii = {};     ///< By how much parts may be elsewhere, in metres: all alike, or each.

  using result = unseen_result;
  using can = clearance::can<checking, of_images>;
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
  void check(std::size_t parts) const {
    check();
    check_radii(radii, parts);
  }
};

namespace detail {

template <class S>
inline constexpr bool is_masked = false;
template <class S>
inline constexpr bool is_masked<masked<S>> = true;

/// Hidden room with what is uncertain about its image.
template <class S>
hidden<S> as_uncertain(const auto&, const hidden<S>& room) {
  return room;
}
template <class Image, class S, class N>
uncertain<hidden<S>, N> as_uncertain(const uncertain<Image, N>& image, const hidden<S>& room) {
  return image.around_same(room, image.noise);
}

/// Throws std::invalid_argument unless there are no labels, or one for each pixel.
template <class Clouds>
void check_labels(std::span<const point_label> labels, const Clouds& clouds) {
  std::size_t pixels = 0;
  for_each_cloud(clouds, [&](const auto& image, const auto&) { pixels += image.size(); });
  if (!labels.empty() && labels.size() != pixels)
    throw std::invalid_argument("clearance: unseen has " + std::to_string(labels.size()) + " labels, and there are " +
                                std::to_string(pixels) + " pixels");
}

}  // namespace detail

template <class On, class PartView>
class unseen::engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : model_(model),
        memory_(on, from...),
        back_(on, from...),
        readable_(on, from...),
        witnesses_(on, model, from...),
        make_([on, model, from...] { return search(on, model, from...); }) {}

  /// Enqueues all cameras' searches.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const unseen& q) {
    q.check(model_.size());
    asked_ = &q;
    used_ = 0;
    memory_.begin();
    const point_label* labels = nullptr;
    if (!q.labels.empty()) {
      detail::check_labels(q.labels, clouds);
      labels = std::get<0>(memory_.put(q.labels));
    }
    const auto& images = readable_(clouds);
    const std::size_t cameras = count_clouds(images), parts = model_.size();
    shadows_ = labels != nullptr || any_masked(images);
    places_ = q.places || cameras > 1;  // the least of several cameras may be any part's
    const std::size_t searches = shadows_ ? 2 * cameras : cameras;
    all_ = memory_.template space<min_distance_result>(searches).data();
    minima_ = memory_.template space<part_minimum>(searches * parts).data();
    if (places_) nearest_ = memory_.template space<part_witness>(cameras * parts).data();
    for_each_cloud(images, [&]<class S>(const S& given, const Eigen::Isometry3d& pose) {
      const auto image = uncropped{}(as_measured{}(given));
      using kind = std::remove_const_t<decltype(image)>;
      if constexpr (seeing_image<kind>) {
        begin_camera(poses, given, image, pose, labels, cameras);
        if (labels != nullptr) labels += image.size();
      } else if constexpr (detail::is_masked<kind>) {
        if (labels != nullptr)
          throw std::invalid_argument("clearance: unseen has labels, and so has cloud " + std::to_string(used_));
        begin_camera(poses, given, uncropped{}(image.source), pose, image.labels, cameras);
      } else {
        refuse(std::uint32_t(used_));
      }
    });
  }
  /// The result stays valid until the next call.
  result& finish() {
    using backends::read_array;
    const std::size_t parts = model_.size(), searches = shadows_ ? 2 * used_ : used_;
    back_(read_array{found_, all_, searches}, read_array{found_minima_, minima_, searches * parts},
          read_array{found_nearest_, nearest_, places_ ? used_ * parts : 0});
    result& r = result_;
    r.all = {};
    r.own_shadow = {};
    r.parts.clear();
    for (std::size_t number = 0; number < used_; ++number) finish_camera(number, r);
    minimum::join(std::span<const camera>(cameras_).first(used_), asked_->room.farthest, asked_->radii, asked_->edges,
                  parts, r);
    return r;
  }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() {
    for (search& s : searches_) s.forget();
  }

 private:
  using asks = min_distance_per_part;
  using search = minimum::engine<On, PartView, asks>;
  using camera = minimum::camera_finding;

  part_facts facts_of(std::size_t k) const { return widened(model_.facts[k], radius_of(asked_->radii, k)); }

  template <class Clouds>
  static bool any_masked(const Clouds& clouds) {
    bool any = false;
    for_each_cloud(clouds, [&](const auto& given, const Eigen::Isometry3d&) {
      any = any || detail::is_masked<std::remove_cvref_t<decltype(uncropped{}(as_measured{}(given)))>>;
    });
    return any;
  }
  /// One of a variant's kinds; others do not compile.
  [[noreturn]] static void refuse(std::uint32_t number) {
    throw std::invalid_argument("clearance: unseen is asked about depth images, and cloud " + std::to_string(number) +
                                " is none");
  }

  /// `labels`: of this image, or null. Its searches write their results behind those of the cameras before it, and
  /// those of shadows behind all `cameras`.
  template <class Given, seeing_image S>
  void begin_camera(std::span<const Eigen::Isometry3d> poses, const Given& given, const S& image,
                    const Eigen::Isometry3d& pose, const point_label* labels, std::size_t cameras) {
    constexpr bool pinhole = requires(const S& s) { s.inverse_fx; };
    const unseen& q = *asked_;
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
    const std::size_t number = used_++, parts = model_.size();
    const auto room = hides(false);
    start(2 * number, poses, room, pose, number);
    if (places_)
      witnesses_.start(poses, placed{room, pose}, part_witnesses{},
                       {minima_ + number * parts, nearest_ + number * parts});
    if (labels != nullptr) start(2 * number + 1, poses, hides(true), pose, cameras + number);

    frame_.start(model_.facts, poses);
    frame_.put(model_.facts, pose, 0, rounding_of(room));
    if (used_ > cameras_.size()) cameras_.emplace_back();
    camera& c = cameras_[number];
    c.clear();
    c.error = frame_.error;
    c.tells_shown = pinhole;
    c.vague = vague_source<Given>;
    c.shadow = labels != nullptr;
    for (std::size_t k = 0; k < parts; ++k) {
      c.errors.push_back({frame_.places[k].error, frame_.error.per_metre});
      c.from_edge.push_back(0);
      c.shown.push_back(0);
      if constexpr (pinhole) {
        const pinhole_view view(image, q.room.nearest, q.room.farthest);
        const ball& around = frame_.places[k].around;
        const vec3 middle = around.center + frame_.origin;
        double& edge = c.from_edge.back() = view.from_edge({middle, around.radius}) - frames::slop(facts_of(k));
        if constexpr (vague_source<Given>)  // the view may be turned and shifted, and what was outside has moved in
          edge = fma(-double(given.turn), double(length(middle)) + around.radius, edge - given.shift - given.drift) /
                 (1 + double(given.turn));
        c.shown.back() = view.shows_of_ball(model_.facts[k].center, model_.facts[k].radius, pose.inverse() * poses[k]);
      }
    }
  }

  /// Enqueues the search with this number about hidden room. Its results are the `place`-th.
  template <class S>
  void start(std::size_t number, std::span<const Eigen::Isometry3d> poses, const S& room, const Eigen::Isometry3d& pose,
             std::size_t place) {
    while (searches_.size() <= number) searches_.push_back(make_());
    searches_[number].start(poses, placed<S>{room, pose}, asks{}, {all_ + place, minima_ + place * model_.size()});
  }

  void finish_camera(std::size_t number, result& r) {
    const std::size_t parts = model_.size();
    camera& c = cameras_[number];
    const auto minima_of = [&](std::size_t place) {
      return std::span<const part_minimum>(found_minima_).subspan(place * parts, parts);
    };
    const auto lower = [&](std::size_t k, std::size_t place) {
      if (found_[place].dropped[int(drop_reason::too_close)] != 0) return -double(infinity);  // an unbounded radius
      const part_minimum& least = minima_of(place)[k];
      if (least.cloud == none) return double(infinity);
      return frames::certain_distance(least.distance, frames::slop(facts_of(k)), c.errors[k]);
    };
    const auto widen = [&](min_distance_result& of, const std::vector<double>& lowers) {
      if (asked_->radii.empty() || of.part == none) return;
      frames::bracket(of, std::ranges::min(lowers), facts_of(of.part).tolerance, false, c.error);
      frames::allow_for_too_close(of);
    };
    c.all = found_[number];
    c.own.assign(parts, infinity);
    for (std::uint32_t k = 0; k < parts; ++k) {
      const part_minimum& least = minima_of(number)[k];
      part_witness nearest;
      if (places_)
        nearest = found_nearest_[number * parts + k];
      else if (least.cloud != none)
        nearest = {least.distance, k, least.cloud, least.point, least.primitive};
      nearest.cloud = nearest.part == none ? none : std::uint32_t(number);
      c.nearest.push_back(nearest);
      c.lower.push_back(lower(k, number));
    }
    widen(c.all, c.lower);
    if (!c.shadow) return;
    const std::size_t place = used_ + number;
    for (std::size_t k = 0; k < parts; ++k) c.own[k] = lower(k, place);
    min_distance_result own = found_[place];
    widen(own, c.own);
    if (own.cloud != none) own.cloud = std::uint32_t(number);
    if (c.vague) own.upper = infinity;
    r.own_shadow = merge(r.own_shadow, own);
  }

  model_view<PartView> model_;
  backends::kept_memory<On> memory_;
  backends::readback<On> back_;
  frames::readable_clouds<On> readable_;
  part_witnesses::engine<On, PartView> witnesses_;
  std::function<search()> make_;
  std::deque<search> searches_;  // one for each camera, and one for its own shadow
  std::vector<camera> cameras_;  // of which this frame has the first `used_`
  std::size_t used_ = 0;
  frames::cloud_frame frame_;

  // The frame that began: does it ask for shadows and for witnesses, and where are the answers?
  const unseen* asked_ = nullptr;
  bool shadows_ = false, places_ = false;
  min_distance_result* all_ = nullptr;
  part_minimum* minima_ = nullptr;
  part_witness* nearest_ = nullptr;

  std::vector<min_distance_result> found_;
  std::vector<part_minimum> found_minima_;
  std::vector<part_witness> found_nearest_;
  result result_;
};

}  // namespace clearance

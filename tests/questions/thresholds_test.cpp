// SPDX-License-Identifier: BSD-3-Clause
// A limit takes radii first: what may be within a range, a depth or a distance, wherever points and parts are within
// their radii, is answered for. Each limit with each source of a radius, about scenes whose points lie on both sides.
#include "questions/uncertain_scenes.hpp"
#include "questions/unseen_scenes.hpp"

#include <clearance/motion_clearance.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/nearest_points.hpp>

namespace thresholds_test {

using namespace testing;
using clearance::any_noise, clearance::cloud_uncertainty, clearance::drop_reason, clearance::host,
    clearance::noise_kind, clearance::placed, clearance::point_filter, clearance::point_span, clearance::state,
    clearance::uncertain;

namespace {

/// One source of radii in each round, then several at once.
struct doubt {
  std::string name;
  any_noise noise;
  cloud_uncertainty off;
  std::vector<real> radii;  // what `noise` may view
  std::vector<double> parts;

  doubt(dice& d, unsigned n, std::size_t points, std::size_t robots) {
    const bool all = n % 8 == 7;
    if (n % 8 == 0 || all) noise = {.kind = noise_kind::lidar, .lidar = {d.number(0, 0.05), 0.01f}}, name += "lidar ";
    if (n % 8 == 1) noise = {.kind = noise_kind::kinect, .kinect = {d.number(1, 20)}}, name += "kinect ";
    if (n % 8 == 2) {
      for (std::size_t i = 0; i < points; ++i) radii.push_back(d.below(3) == 0 ? 0 : d.number(0, 0.3));
      noise = {.kind = noise_kind::radii, .radii = {radii.data(), radii.size()}}, name += "radii ";
    }
    if (n % 8 == 3 || all) off.shift = d.uniform(0, 0.2), name += "shift ";
    if (n % 8 == 4 || all) off.turn = d.uniform(0, 0.1), name += "turn ";
    if (n % 8 == 5 || all) off.max_speed = d.uniform(0, 2), off.age = 0.1, name += "time ";
    if (n % 8 == 6 || all)
      for (std::size_t k = 0; k < robots; ++k) parts.push_back(d.uniform(0, 0.2));
    if (!parts.empty()) name += "parts ";
  }
  template <class S>
  auto around(const S& source) const {
    return uncertain(source, noise, off);
  }
};

/// The places of a cloud's points that may be in its range, each somewhere.
template <class S, class InRange>
std::vector<oracle::vec> places_in_range(dice& d, const S& seen, const InRange& in_range) {
  std::vector<oracle::vec> all;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const clearance::sample s = seen.source[i];
    if (!s.valid() && s.dropped != drop_reason::out_of_range) continue;
    const auto shares = seen.shares(i, s.position);
    const wide most = wide(shares.sum()) / seen.spread * (d.below(2) == 0 ? 1 : wide(d.uniform(0, 1)));
    const auto way = wider(d.direction());
    const auto at = wider(s.position) + (0.9999L * most / oracle::length(way)) * way;
    if (in_range(at)) all.push_back(at);
  }
  return all;
}

point_filter some_filter(dice& d) {
  point_filter f{.nearest = d.below(2) == 0 ? 0 : d.number(0.2, 0.8), .farthest = d.number(1, 2)};
  f.sensor = d.point(0.3);
  return f;
}
bool within(const point_filter& f, const oracle::vec& p) {
  const wide away = oracle::length(p - wider(f.sensor));
  return away >= f.nearest && away <= f.farthest;
}

/// Every point that may be in range is valid, every other one is not.
template <class S, class InRange>
void check_points(dice& d, const S& seen, const InRange& in_range, verdict& v, std::size_t& taken,
                  const std::string& what) {
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const clearance::sample bare = seen.source[i], now = seen[i];
    if (bare.valid() || bare.dropped != drop_reason::out_of_range) {
      v.require(now.valid() == bare.valid() || now.dropped == drop_reason::too_close, what, ": another point");
      continue;
    }
    const auto shares = seen.shares(i, bare.position);
    const wide most = wide(shares.sum()) / seen.spread;
    bool may = false;
    for (int k = 0; k < 20 && !may; ++k) {
      const auto way = wider(d.direction());
      may = in_range(wider(bare.position) + (0.9999L * most / oracle::length(way)) * way);
    }
    v.require(!may || now.valid() || now.dropped == drop_reason::too_close, what, ": point", i, " is left out");
    v.require(most > 0 || !now.valid(), what, ": without a radius");
    taken += now.valid();
  }
}

struct kinds_of_points {
  std::vector<vec3> points;
  std::vector<double> doubles;
  std::vector<float> pixels;
  std::vector<std::uint16_t> millimetres;
  std::vector<clearance::ray> rays;
  std::vector<point_label> labels;

  explicit kinds_of_points(dice& d, std::size_t n = 120) {
    for (std::size_t i = 0; i < n; ++i) {
      points.push_back(clearance::scaled(d.number(0.1, 2.4), d.direction()));
      for (const real x : {points[i].x, points[i].y, points[i].z}) doubles.push_back(double(x) + 1e-9);
      pixels.push_back(d.below(15) == 0 ? 0 : d.number(0.1, 2.4));
      millimetres.push_back(std::uint16_t(1000 * pixels[i]));
      rays.push_back({d.number(-0.5, 0.5), d.number(-0.5, 0.5)});
      labels.push_back(d.below(9) == 0 ? point_label::own : point_label::rest);
    }
  }
  point_span span(const point_filter& f) const { return {points, f}; }
  auto records(const point_filter& f) const {
    clearance::strided_points<double> all{reinterpret_cast<const std::byte*>(doubles.data()), points.size(), 24};
    all.offset[1] = 8, all.offset[2] = 16, all.filter = f;
    return all;
  }
  template <class Pixel>
  auto image(const std::vector<Pixel>& of, const point_filter& f) const {
    clearance::depth_image<Pixel> all(of.data(), 12, std::uint32_t(of.size() / 12), {12, 12, 5.5, 4.5});
    all.nearest = f.nearest, all.farthest = f.farthest;
    return all;
  }
  auto by_rays(const point_filter& f) const {
    clearance::ray_image all(pixels.data(), rays.data(), 12, std::uint32_t(pixels.size() / 12));
    all.nearest = f.nearest, all.farthest = f.farthest;
    return all;
  }
};

/// A robot of two bodies, and where it is in several configurations.
struct bodies {
  std::vector<std::vector<inner_sphere>> parts;
  std::vector<Eigen::Isometry3d> poses;

  explicit bodies(dice& d) : parts{random_spheres(d, 8, 0.15), random_spheres(d, 8, 0.15)} {
    for (int k = 0; k < 2; ++k) {
      poses.push_back(d.pose(0));
      const auto way = d.direction();
      const double away = d.uniform(0.3, 1.9);
      poses.back().translation() = away * doubles(way).normalized();
    }
  }
  /// The distance of each part, somewhere within its radius, to places in the world.
  std::vector<double> to(dice& d, const std::vector<oracle::vec>& places, const std::vector<double>& radii) const {
    std::vector<double> least(parts.size(), infinity);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const place by = (radii.empty() ? 0 : 0.9999 * radii[k]) * doubles(d.direction()).normalized();
      for (const auto& s : parts[k]) {
        const place c = poses[k] * doubles(s.center) + by;
        for (const auto& p : places)
          least[k] = std::min(least[k], (c - place(double(p.x), double(p.y), double(p.z))).norm() - double(s.radius));
      }
      least[k] = std::max(least[k], 0.0);
    }
    return least;
  }
};

/// Asks everything that takes balls, and compares with places that may be.
template <class S, class InRange>
void check_questions(dice& d, const bodies& robot, const S& seen, const doubt& its, const InRange& in_range, verdict& v,
                     const std::string& what) {
  const auto model = clearance::make_model<clearance::sphere>(robot.parts);
  const auto& poses = robot.poses;
  const std::vector<double>& radii = its.parts;
  std::vector<double> truth{infinity, infinity};
  for (int n = 0; n < 4; ++n) {
    const auto some = robot.to(d, places_in_range(d, seen, in_range), radii);
    for (std::size_t k = 0; k < 2; ++k) truth[k] = std::min(truth[k], some[k]);
  }
  const double least = std::min(truth[0], truth[1]);
  const auto holds = [&](const auto& r, double true_one, const char* name) {
    v.require(double(r.lower) <= true_one && (r.state != state::free || r.lower > 0), what, ", ", name, ": at least",
              r.lower, ", and may be", true_one);
  };
  std::vector<clearance::part_radius> of_parts;
  for (const double r : radii) of_parts.push_back({r / 2, r / 2});
  const auto certain = ask(host{}, model, poses, seen, clearance::certain_distance{of_parts});
  holds(certain, least, "certain_distance");
  for (std::size_t k = 0; k < 2; ++k)
    v.require(double(certain.parts[k].lower) <= truth[k], what, ", certain_distance: part", k);
  if (radii.empty()) {
    holds(ask(host{}, model, poses, seen, clearance::min_distance{}), least, "min_distance");
    holds(ask(host{}, model, poses, seen, clearance::min_distance_per_part{}).all, least, "min_distance_per_part");
    const double reach = least < infinity ? least * d.uniform(0.5, 1.5) : 0.1;
    const auto near = ask(host{}, model, poses, seen, clearance::nearest_k{.k = 3});
    const auto listed = ask(host{}, model, poses, seen, clearance::within{{reach}});
    const auto rows = ask(host{}, model, poses, seen, clearance::distances_per_part{});
    for (std::size_t k = 0; k < 2; ++k) {
      double row = infinity;
      for (const real its : rows.of(k)) row = std::min(row, its < infinity ? double(rows.certain.lower(its, k)) : row);
      v.require(double(near.certain.lower(near.of(k)[0])) <= truth[k], what, ", nearest_k: part", k);
      v.require(row <= truth[k], what, ", distances_per_part: part", k);
      v.require(listed.offsets[k] != listed.offsets[k + 1] || truth[k] > reach, what, ", within: part", k);
    }
  }
  const double limit = least < infinity ? least * d.uniform(0.5, 1.5) : 0.1;
  holds(ask(host{}, model, poses, seen, clearance::min_distances{limit, radii}).of[0], least, "min_distances");
  const auto each = ask(host{}, model, poses, seen, clearance::min_distances_per_part{limit, radii});
  for (std::size_t k = 0; k < 2; ++k) holds(each.all[k], truth[k], "min_distances_per_part");
  v.require(
      ask(host{}, model, poses, seen, clearance::in_collision{{limit}, radii}).state != state::free || least > limit,
      what, ", in_collision: free within", limit, ", and may be", least);
  v.require(
      ask(host{}, model, poses, seen, clearance::in_collisions{{limit}, radii}).of[0] != state::free || least > limit,
      what, ", in_collisions: free within", limit, ", and may be", least);
  const auto around =
      ask(host{}, model, poses, seen, clearance::zones{.thresholds = {limit, 2 * limit}, .radii = radii});
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t z = 0; z < 2; ++z)
      v.require(around.of(k, z).points != 0 || truth[k] > double(z + 1) * limit, what, ", zones: zone", z, " is empty");
  const clearance::straight_motion still(poses, poses);
  holds(clearance::motion_clearance(host{}, model, still, seen, {.margin = limit, .radii = radii}), least,
        "motion_clearance");
}

}  // namespace

TEST_CASE("A point that was measured out of range counts if it may be in it, whatever says the range and the radius") {
  verdict v;
  dice d(46);
  std::size_t taken = 0;
  for (unsigned n = 0; n < 160; ++n) {
    const kinds_of_points all(d);
    const point_filter f = some_filter(d);
    const doubt its(d, n, all.points.size(), 0);
    const std::string what = "round " + std::to_string(n) + ", " + its.name;
    const auto by_way = [&](const oracle::vec& p) { return within(f, p); };
    const auto by_depth = [&](const oracle::vec& p) { return p.z >= f.nearest && p.z <= f.farthest; };
    const auto check = [&](const auto& source, const auto& in_range, const char* kind) {
      check_points(d, its.around(source), in_range, v, taken, what + kind);
    };
    check(all.span(f), by_way, "floats");
    check(all.records(f), by_way, "records");
    check(clearance::masked(all.span(f), all.labels.data()), by_way, "behind a mask");
    check(clearance::masked(all.image(all.pixels, f), all.labels.data()), by_depth, "an image behind a mask");
    check(all.image(all.pixels, f), by_depth, "an image");
    check(all.image(all.millimetres, f), by_depth, "an image of 16 bits");
    check(all.by_rays(f), by_depth, "a lens");
    check(clearance::thinned<point_span>{all.span(f), 3}, by_way, "thinned");
    const clearance::sharded pieces(std::vector{all.span(f).slice(0, 50), all.span(f).slice(50, 120)});
    check(pieces, by_way, "pieces");
    const auto some = its.around(all.records(f)).slice(8, 60);
    check_points(d, some, by_way, v, taken, what + "a slice");
  }
  CHECK(taken > 5000);
}

TEST_CASE("Nothing is free that a point would be near to which may be in range, for every question and radius") {
  verdict v;
  dice d(47);
  for (unsigned n = 0; n < 240; ++n) {
    const kinds_of_points all(d, 36);
    const point_filter f = some_filter(d);
    const bodies robot(d);
    const doubt its(d, n, all.points.size(), 2);
    const std::string what = "round " + std::to_string(n) + ", " + its.name;
    check_questions(d, robot, its.around(all.span(f)), its, [&](const auto& p) { return within(f, p); }, v, what);
    check_questions(
        d, robot, its.around(all.image(all.pixels, f)), its,
        [&](const auto& p) { return p.z >= f.nearest && p.z <= f.farthest; }, v, what + "an image");
  }
}

TEST_CASE("Behind a return that was measured beyond the end of hidden room, room is hidden if it may begin before it") {
  verdict v;
  dice d(48);
  std::size_t free = 0, beyond = 0;
  for (unsigned n = 0; n < 600; ++n) {
    picture<float> image(d, d.below(2) == 0 ? 0 : 0.2, 1.5);
    image.camera = {6, 6, 4, 3}, image.scale = 1;
    clearance::unseen q{some_room(d, 1.5)};
    for (float& z : image.pixels)
      if (std::isfinite(z) && z != 0 && d.below(2) == 0) z = q.room.farthest + d.number(-0.1, 0.3);
    const seen_robot<inner_sphere> robot(d, image.pose, 1.5);
    const doubt its(d, n, image.width * image.height, robot.parts.size());
    q.radii = its.parts;
    const auto bare = image.image();
    const auto seen = its.around(bare);
    const auto r = clearance::ask(host{}, robot.model<clearance::sphere>(8), robot.poses, placed{seen, image.pose}, q);
    free += r.all.state == state::free;
    for (int k = 0; k < 300; ++k) {
      const std::uint32_t i = d.below(image.width * image.height);
      const clearance::sample s = bare[i];
      place at;
      if (s.valid() && d.below(2) == 0) {  // the return itself, which may be nearer
        const real radius = seen.radius(i, s.position);
        if (!(radius < 1e6f)) continue;
        at = doubles(s.position) + 0.9999 * double(radius) / seen.spread * doubles(d.direction()).normalized();
        beyond += s.position.z >= q.room.farthest && at.z() < q.room.farthest;
      } else {
        const auto from = image.hides_from(i, q.room, false, false);
        if (!from) continue;
        at = d.uniform(*from, q.room.farthest) * doubles(bare.way(i)) +
             (0.9999 * its.off.shift + its.off.max_speed * its.off.age) * doubles(d.direction()).normalized();
      }
      if (!(at.z() < q.room.farthest && at.z() > 0)) continue;
      const place world = image.pose * at;
      for (std::size_t part = 0; part < robot.parts.size(); ++part) {
        const place by = (q.radii.empty() ? 0 : 0.9999 * q.radii[part]) * doubles(d.direction()).normalized();
        for (const auto& ball : robot.parts[part]) {
          const double away =
              std::max((robot.poses[part] * doubles(ball.center) + by - world).norm() - double(ball.radius), 0.0);
          v.require(r.parts[part].lower <= away && r.all.lower <= away, "round", n, ", ", its.name, ": part", part,
                    " is at least", r.parts[part].lower, " away, but", away, " away is what may be hidden");
        }
      }
    }
  }
  INFO(free << " free, " << beyond << " from beyond");
  CHECK((free > 20 && beyond > 200));
}

TEST_CASE("What moves into a camera's view from beside it is not seen by that camera") {
  verdict v;
  dice d(49);
  std::size_t by_other = 0;
  for (int n = 0; n < 200; ++n) {
    clearance::unseen q{{.nearest = 0.1f, .farthest = 3}};
    const cloud_uncertainty off{.max_speed = 1, .age = d.uniform(0, 0.4)};
    const double drift = off.max_speed * off.age;
    // The first camera sees a wall before the robot, the second nothing up to the end of the room.
    const std::vector<float> wall(12 * 12, 0.5f), open(12 * 12, 10.0f);
    const clearance::intrinsics camera{12, 12, 5.5, 5.5};
    const clearance::depth_image<float> first(wall.data(), 12, 12, camera), second(open.data(), 12, 12, camera);
    const Eigen::Isometry3d beside = Eigen::Translation3d(0, 0, 1.5) *
                                     Eigen::AngleAxisd(1.5707963, Eigen::Vector3d::UnitY()) *
                                     Eigen::Translation3d(0, 0, -1.5);
    const std::vector cameras{placed{uncertain(first, any_noise{}, off), Eigen::Isometry3d::Identity()},
                              placed{uncertain(second, any_noise{}, off), beside}};
    const double x = d.uniform(-0.3, 0.3), y = d.uniform(-0.6, 0.6), z = d.uniform(1.2, 1.8);
    const std::vector<std::vector<inner_sphere>> ball{{{{0, 0, 0}, 0.05f}}};
    const std::vector poses{shifted(x, y, z)};
    const auto r = clearance::ask(host{}, clearance::make_model<clearance::sphere>(ball), poses, cameras, q);
    by_other += r.all.lower > 0;
    for (int k = 0; k < 400; ++k) {
      const place now = place(x, y, z) + d.uniform(0.05, 1) * doubles(d.direction()).normalized();
      const auto moved = [&] { return place(now + 0.9999 * drift * doubles(d.direction()).normalized()); };
      const auto shows = [&](const Eigen::Isometry3d& pose, const place& then) {
        const place p = pose.inverse() * then;
        return p.z() >= q.room.nearest && p.z() <= q.room.farthest && std::abs(p.x()) <= 0.5 * p.z() &&
               std::abs(p.y()) <= 0.5 * p.z();
      };
      const place at_first = moved(), at_second = moved();
      const bool hidden = shows(Eigen::Isometry3d::Identity(), at_first) && at_first.z() >= 0.5;
      if (!hidden || shows(beside, at_second)) continue;
      const double away = (now - place(x, y, z)).norm() - 0.05;
      v.require(r.all.lower <= away, "round", n, ": at least", r.all.lower, ", but", away, " away may be something");
    }
  }
  CHECK(by_other > 20);
}

}  // namespace thresholds_test

// SPDX-License-Identifier: BSD-3-Clause
// The bracket of `unseen` contains the distance to the true pyramids behind the pixels; several cameras, own shadow and
// what is out of view; and what is refused.
#include "questions/unseen_scenes.hpp"

#include "support/laws.hpp"

#include <cstdlib>
#include <functional>

namespace unseen_test {

using namespace testing;
using clearance::host, clearance::state, clearance::unseen;

namespace {

/// CLEARANCE_TEST_MORE multiplies the rounds of random tests.
int rounds(int n) {
  const char* more = std::getenv("CLEARANCE_TEST_MORE");
  return n * (more == nullptr ? 1 : std::max(1, std::atoi(more)));
}

/// What one camera says about a robot against the truth. `extent`: how far the robot may be from the camera.
template <class P, class Image>
void check_one(const seen_robot<P>& robot, const clearance::unseen_result& r, const Image& image, const unseen& q,
               bool with_labels, double extent, verdict& v, const std::string& what) {
  const auto rooms = image.hidden(q.room, with_labels);
  double least = infinity;
  for (std::size_t k = 0; k < robot.parts.size(); ++k) {
    const double truth = to_rooms(robot.parts[k], robot.poses[k], rooms, image.pose);
    least = std::min(least, truth);
    const auto& part = r.parts[k];
    v.require(part.lower <= std::max(truth, 0.0), what, ": part", k, " at least", part.lower, ", but is", truth);
    v.require((part.point == clearance::none) == rooms.empty(), what, ": part", k, ": is there room?");
  }
  if (rooms.empty()) {
    v.require(r.all.state == state::free && r.all.point == clearance::none, what, ": nothing is hidden");
    return;
  }
  const double truth = std::max(least, 0.0), width = image.half_pixel();
  v.require(r.all.lower <= truth && truth <= r.all.upper, what, ": bracket", r.all.lower, " to", r.all.upper, " misses",
            truth);
  v.require(r.all.valid == rooms.size(), what, ":", r.all.valid, " pixels hide something, and not", rooms.size());
  if (width < 0.2) {
    const double most = 4 * width * (extent + truth) + 1e-4;
    v.require(truth - r.all.lower <= most && r.all.upper - truth <= most, what, ": a wide bracket around", truth, ":",
              r.all.lower, " to", r.all.upper);
  }
  v.require((r.all.state == state::free) == (r.all.lower > 0), what, ": free, or not");
  v.require(r.all.state != state::unknown || r.all.distance <= 1e-4f, what, ": unknown, but far");
  // The witness: on the pixel's way behind its start, and so far from the robot.
  const place at = image.pose.inverse() * place(r.all.at.x, r.all.at.y, r.all.at.z);
  const std::uint32_t i = r.all.point;
  const auto from = image.hides_from(i, q.room, with_labels, false);
  v.require(from.has_value(), what, ": pixel", i, " hides nothing");
  if (!from) return;
  const place way((i % image.width - image.camera.cx) / image.camera.fx,
                  (i / image.width - image.camera.cy) / image.camera.fy, 1);
  v.require((at - at.z() * way).norm() <= 1e-5 * (1 + extent + way.norm() * q.room.farthest) &&
                at.z() >= *from - 1e-5 * extent && at.z() <= q.room.farthest + 1e-5 * extent,
            what, ": the witness is not in its pixel");
  if (r.all.distance > 1e-3f) {
    const place near(r.all.nearest.x, r.all.nearest.y, r.all.nearest.z), there(r.all.at.x, r.all.at.y, r.all.at.z);
    v.require(std::abs((near - there).norm() - r.all.distance) <= 1e-5 * (1 + extent), what, ": witnesses are",
              (near - there).norm(), " apart and not", r.all.distance);
  }
}

template <class V, class P, class Pixel>
void random_frames(unsigned seed, int count) {
  dice d(seed);
  verdict v;
  for (int n = 0; n < rounds(count); ++n) {
    const double size = d.below(4) == 0 ? 30 : 1.5;
    picture<Pixel> image(d, d.uniform(0, 1), size);
    if (d.below(5) == 0) image.pose.translation() += place(500, -300, 200);  // as on a map
    const seen_robot<P> robot(d, image.pose, size);
    const unseen q{some_room(d, size)};
    const auto model = robot.template model<V>(d.below(2) == 0 ? 4 : 8);
    const std::string what = "frame " + std::to_string(n);
    const double extent = 3 * size + 1 + 0.01 * image.pose.translation().norm();
    const auto plainly = clearance::ask(host{}, model, robot.poses, placed{image.image(), image.pose}, q);
    check_one(robot, plainly, image, q, false, extent, v, what);
    const auto labelled = clearance::ask(host{2}, model, robot.poses, placed{image.masked_image(), image.pose}, q);
    check_one(robot, labelled, image, q, true, extent, v, what + ", masked");
    using other = std::conditional_t<std::is_same_v<V, clearance::sphere>, clearance::obb, clearance::sphere>;
    v.require(same_unseen(clearance::ask(host{1}, robot.template model<other>(2), robot.poses,
                                         placed{image.masked_image(), image.pose}, q),
                          labelled),
              what, ": another tree says something else");
    unseen with_labels = q;
    with_labels.labels = image.labels;
    v.require(same_unseen(clearance::ask(host{}, model, robot.poses, placed{image.image(), image.pose}, with_labels),
                          labelled),
              what, ": labels of the question say something else than a mask");
    // Its own shadow.
    const auto own = image.hidden(q.room, true, true);
    double truth = infinity;
    for (std::size_t k = 0; k < robot.parts.size(); ++k)
      truth = std::min(truth, to_rooms(robot.parts[k], robot.poses[k], own, image.pose));
    const auto& shadow = labelled.own_shadow;
    v.require(shadow.valid == own.size() && (shadow.state == state::no_data) == own.empty(), what, ": own shadow of",
              shadow.valid, " pixels, and not", own.size());
    if (!own.empty())
      v.require(shadow.lower <= std::max(truth, 0.0) && std::max(truth, 0.0) <= shadow.upper, what, ": own shadow",
                shadow.lower, " to", shadow.upper, " misses", truth);
    v.require(plainly.own_shadow.state == state::no_data, what, ": a shadow without a mask");
    // The same pixels as rays.
    const auto rays = image.rays();
    clearance::ray_image<Pixel> lens(image.pixels.data(), rays.data(), image.width, image.height, image.scale);
    lens.row = image.row, lens.nearest = real(image.rule.nearest), lens.farthest = real(image.rule.farthest);
    lens.minus_infinity_is_near = image.rule.minus_infinity_is_near;
    if (image.half_pixel() < 0.24) {
      const unseen by_rays{q.room, image.half_pixel()};
      check_one(robot, clearance::ask(host{}, model, robot.poses, placed{lens, image.pose}, by_rays), image, by_rays,
                false, extent, v, what + ", rays");
    }
  }
}

/// The least distance of a primitive along a way, by a golden section. Distances to convex things are convex.
template <class Distance>
double least_along(const place& from, const place& along, const Distance& distance) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double low = 0, high = 1, left = 1 - golden, right = golden;
  double at_left = distance(from + left * along), at_right = distance(from + right * along);
  for (int k = 0; k < 76; ++k)
    if (at_left <= at_right) {
      high = right, right = left, at_right = at_left;
      left = high - golden * (high - low), at_left = distance(from + left * along);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + golden * (high - low), at_right = distance(from + right * along);
    }
  return std::min({at_left, at_right, distance(from), distance(from + along)});
}

vec3 rounded(const place& p) { return {real(p.x()), real(p.y()), real(p.z())}; }

/// Ways that miss, cross, touch, run along and end at a primitive of size 1.
std::pair<vec3, vec3> some_way(dice& d, const std::vector<vec3>& marks) {
  const auto mark = [&] {
    const vec3 m = marks[d.below(unsigned(marks.size()))];
    return d.below(3) == 0 ? m : m + d.point(d.below(2) == 0 ? 1.0 : 1e-4);
  };
  const vec3 a = mark(), b = mark();
  const real reach = d.below(3) == 0 ? d.number(1, 50) : real(d.below(3));
  const vec3 along = d.below(4) == 0 ? d.direction() : b - a;
  return {d.below(2) == 0 ? a : a - along, clearance::scaled(reach, along)};
}

template <class V, class P>
void check_bound(const std::vector<P>& some, const clearance::capsule& c, double least, verdict& v) {
  std::vector<ball> balls;
  for (const P& p : some)
    for (const ball& b : p.balls()) balls.push_back(b);
  const V volume = clearance::bounding_volume_traits<V>::fit(balls);
  for (const real reach : {-1.0f, 0.0f, real(0.9 * least), infinity})
    v.require(clearance::lower_bound(volume, c, reach) <= least, "a bound of", clearance::lower_bound(volume, c, reach),
              " above", least, " from ", c.from, " along ", c.along);
}

}  // namespace

TEST_CASE(
    "The least distance along a way is the reference's, to spheres and triangles, and no volume bounds above it") {
  verdict v;
  dice d(3201);
  for (int n = 0; n < rounds(50000); ++n) {
    const auto face = [&] {
      const vec3 a = d.point(1), b = d.below(9) == 0 ? a : a + d.point(1),
                 c = d.below(9) == 0   ? clearance::scaled(0.5f, a + b)
                     : d.below(9) == 0 ? b + d.point(1e-5)
                                       : d.point(1);
      return triangle::from(a, b, c);
    };
    const triangle t = face();
    const inner_sphere s{d.point(1), d.number(1e-4, 1)};
    const auto check = [&](const auto& p, const std::vector<vec3>& marks, const auto& distance) {
      const auto [from, along] = some_way(d, marks);
      const double truth = least_along(doubles(from), doubles(along), distance);
      const real share = p.least_along(from, along);
      const clearance::capsule c{from, along, 0};
      const real found = p.distance(c.at(share));
      const double size = 4 + doubles(from).norm() + doubles(along).norm();
      v.require(share >= 0 && share <= 1 && std::abs(found - truth) <= 4e-7 * size, "round", n, ": found", found,
                ", and not", truth, " from ", from, " along ", along);
      const std::vector some{p};
      check_bound<clearance::sphere>(some, c, found, v);
      check_bound<clearance::aabb>(some, c, found, v);
      check_bound<clearance::obb>(some, c, found, v);
    };
    const std::array<place, 3> corners{doubles(t.a), doubles(t.b), doubles(t.c)};
    check(t, {t.a, t.b, t.c, clearance::scaled(1.0f / 3, t.a + t.b + t.c)},
          [&](const place& p) { return to_polygon(p, corners); });
    check(s, {s.center, clearance::fma(s.radius, d.direction(), s.center)},
          [&](const place& p) { return (p - doubles(s.center)).norm() - s.radius; });
  }
}

TEST_CASE("Behind 16-bit pixels the bracket contains the distance from spheres to the true pyramids") {
  random_frames<clearance::sphere, inner_sphere, std::uint16_t>(3202, 120);
  random_frames<clearance::obb, inner_sphere, std::uint16_t>(3203, 60);
}
TEST_CASE("Behind float pixels the bracket contains the distance from spheres to the true pyramids") {
  random_frames<clearance::sphere, inner_sphere, float>(3204, 120);
  random_frames<clearance::aabb, inner_sphere, float>(3205, 60);
}
TEST_CASE("Behind 16-bit pixels the bracket contains the distance from triangles to the true pyramids") {
  random_frames<clearance::obb, triangle, std::uint16_t>(3206, 60);
  random_frames<clearance::sphere, triangle, std::uint16_t>(3207, 40);
}
TEST_CASE("Behind float pixels the bracket contains the distance from triangles to the true pyramids") {
  random_frames<clearance::obb, triangle, float>(3208, 60);
  random_frames<clearance::aabb, triangle, float>(3209, 60);
}

TEST_CASE("A solid that room begins in, passes through or touches is 0 away and unknown") {
  verdict v;
  dice d(3210);
  const auto box = clearance::close_mesh(shapes::cube(0.3));
  std::vector<triangle> faces;
  for (const auto& t : box.surface.triangles) {
    const auto corner = [&](std::uint32_t i) { return rounded(box.surface.vertices[i]); };
    faces.push_back(triangle::from(corner(t[0]), corner(t[1]), corner(t[2])));
  }
  const auto model = clearance::make_model<clearance::obb>(std::vector{box});
  int inside = 0, free = 0;
  for (int n = 0; n < rounds(300); ++n) {
    const picture<float> image(d, 0.1, 1.5);
    const unseen q{some_room(d, 1.5)};
    Eigen::Isometry3d pose = image.pose * d.pose(0.3);
    pose.translation() += image.pose.linear().col(2) * d.uniform(0, 1.5);
    const auto r = clearance::ask(host{}, model, std::vector{pose}, placed{image.image(), image.pose}, q);
    const auto rooms = image.hidden(q.room, false);
    if (rooms.empty()) continue;
    double truth = to_rooms(faces, pose, rooms, image.pose);
    bool starts_inside = false;
    for (std::uint32_t i = 0; i < image.width * image.height; ++i)
      if (const auto from = image.hides_from(i, q.room, false, false)) {
        const place way((i % image.width - image.camera.cx) / image.camera.fx,
                        (i / image.width - image.camera.cy) / image.camera.fy, 1);
        starts_inside |= (pose.inverse() * (image.pose * (*from * way))).cwiseAbs().maxCoeff() < 0.3 - 1e-5;
      }
    if (starts_inside) truth = 0, ++inside;
    free += r.all.state == state::free;
    v.require(r.all.lower <= truth && truth <= r.all.upper, "frame", n, ": bracket", r.all.lower, " to", r.all.upper,
              " misses", truth);
    if (starts_inside)
      v.require(r.all.state == state::unknown && r.all.distance == 0, "frame", n, ": begins inside, but is",
                r.all.distance, " away");
  }
  CHECK((inside > 20 && free > 20));
}

TEST_CASE("With several cameras no place is nearer than `lower` that none sees and some hides") {
  verdict v;
  dice d(3211);
  int told = 0;
  for (int n = 0; n < rounds(150); ++n) {
    const double size = 1.5;
    const unseen q{some_room(d, size)};
    const unsigned cameras = 2 + d.below(2);
    std::vector<picture<float>> images;
    for (unsigned k = 0; k < cameras; ++k) {
      images.emplace_back(d, n % 2 == 0 ? 0.1 : 0.0, size);
      auto& image = images.back();
      if (n % 2 == 1) {  // it sees the robot and a wall, which need not be behind the robot
        image.camera = {2.5, 2.5, (image.width - 1) / 2.0, (image.height - 1) / 2.0};
        const double wall = d.uniform(0.4, 1.5) * size;
        for (float& z : image.pixels) z = real(wall / image.scale);
        for (auto& label : image.labels) label = point_label::rest;
      }
      image.pose.translation() = -0.7 * size * image.pose.linear().col(2);
    }
    seen_robot<inner_sphere> robot(d, Eigen::Isometry3d::Identity(), 0.3);
    std::vector<placed<clearance::masked<clearance::depth_image<float>>>> all;
    for (const auto& image : images) all.push_back({image.masked_image(), image.pose});
    const auto r = clearance::ask(host{}, robot.model<clearance::sphere>(8), robot.poses, all, q);
    v.require(r.all.upper == infinity || cameras == 1, "an upper end");
    const auto seen_by = [&](const picture<float>& image, const place& world, bool& hidden) {
      const place p = image.pose.inverse() * world;
      const double u = p.x() / p.z() * image.camera.fx + image.camera.cx,
                   w = p.y() / p.z() * image.camera.fy + image.camera.cy;
      if (!(p.z() > 0 && u > -0.5 && u < image.width - 0.5 && w > -0.5 && w < image.height - 0.5)) return false;
      const std::uint32_t i = std::uint32_t(w + 0.5) * image.width + std::uint32_t(u + 0.5);
      if (p.z() > q.room.farthest) return false;
      const auto world_hides = image.hides_from(i, q.room, true, false), own = image.hides_from(i, q.room, true, true);
      if (world_hides && p.z() >= *world_hides) return hidden = true, false;
      return !(own && p.z() >= *own) && p.z() >= q.room.nearest;
    };
    for (int k = 0; k < 2000; ++k) {
      const auto& image = images[d.below(cameras)];
      const std::uint32_t i = d.below(image.width * image.height);
      const auto from = image.hides_from(i, q.room, true, false);
      if (!from) continue;
      const double z = *from + (k % 2 == 0 ? 1e-6 : d.uniform(0, q.room.farthest - *from));
      const double u = (i % image.width) + d.uniform(-0.5, 0.5), w = (i / image.width) + d.uniform(-0.5, 0.5);
      const place at = image.pose * place((u - image.camera.cx) / image.camera.fx * z,
                                          (w - image.camera.cy) / image.camera.fy * z, z);
      bool hidden = false, seen = false;
      for (const auto& each : images) seen |= seen_by(each, at, hidden);
      if (seen || !hidden) continue;
      for (std::size_t part = 0; part < robot.parts.size(); ++part)
        for (const auto& s : robot.parts[part]) {
          const double away = std::max((robot.poses[part] * doubles(s.center) - at).norm() - s.radius, 0.0);
          v.require(r.parts[part].lower <= away && r.all.lower <= away, "frame", n, ": part", part, " is at least",
                    r.parts[part].lower, " away, but", away, " away is a place that is unseen");
        }
    }
    for (std::size_t part = 0; part < robot.parts.size(); ++part) {  // each camera alone says no more
      double alone = infinity;
      for (const auto& image : all)
        alone = std::min(alone, double(clearance::ask(host{}, robot.model<clearance::sphere>(8), robot.poses,
                                                      placed{image.source, image.pose}, q)
                                           .parts[part]
                                           .lower));
      v.require(r.parts[part].lower >= alone, "frame", n, ": several cameras say less than each alone");
      told += r.parts[part].lower > alone;
    }
  }
  CHECK(told > 10);  // a second camera does tell something
}

namespace {

/// A camera at the origin that sees a wall at 2 m.
struct wall_camera {
  std::vector<float> pixels;
  std::uint32_t width = 64, height = 48;
  clearance::intrinsics camera{50, 50, 31.5, 23.5};

  explicit wall_camera(float z = 2) : pixels(64 * 48, z) {}
  clearance::depth_image<float> image() const { return {pixels.data(), width, height, camera}; }
};

const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();

auto ball_at(double x, double y, double z, real radius = 0.1f) {
  clearance::model robot{std::vector{
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, radius}}))}};
  Eigen::Isometry3d pose = here;
  pose.translation() << x, y, z;
  return std::pair(robot, std::vector{pose});
}

template <class Source>
clearance::unseen_result look(
    const std::pair<clearance::model<clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>>,
                    std::vector<Eigen::Isometry3d>>& robot,
    const Source& source, const unseen& q = {}) {
  return clearance::ask(host{}, robot.first, robot.second, source, q);
}

}  // namespace

TEST_CASE("A prepared question says in every frame what a fresh one says, whatever it saw before") {
  verdict v;
  dice d(3212);
  const seen_robot<triangle> robot(d, here, 1);
  const auto model = robot.model<clearance::obb>(8);
  auto poses = robot.poses;
  clearance::query prepared(host{}, model, unseen{});
  for (int n = 0; n < rounds(60); ++n) {
    std::vector<picture<std::uint16_t>> images;
    std::vector<placed<clearance::depth_image<std::uint16_t>>> all;
    for (unsigned k = 0; k < 1 + d.below(3); ++k) images.emplace_back(d, 0.2, 1.5);
    std::vector<point_label> labels;
    for (const auto& image : images) {
      all.push_back({image.image(), image.pose});
      labels.insert(labels.end(), image.labels.begin(), image.labels.end());
    }
    unseen q{some_room(d, 1.5)};
    if (d.below(2) == 0) q.labels = labels;
    if (d.below(2) == 0) poses[0] = d.pose(0.5);
    if (n % 5 == 4) prepared.forget();
    v.require(same_unseen(prepared(poses, all, q), clearance::ask(host{}, model, poses, all, q)), "frame ", n);
  }
}

TEST_CASE("A ball before a wall is as far from what the wall hides as from the wall, wherever that begins") {
  const wall_camera wall;
  const auto r = look(ball_at(0.02, 0, 1), wall.image());
  CHECK(r.all.distance == Approx(0.9).margin(1e-3));
  CHECK((r.all.state == state::free && r.all.lower < 0.9f && 0.9f < r.all.upper + 1e-3f));
  CHECK(r.parts[0].out_of_view == 0);
  const auto behind = look(ball_at(0, 0, 5), wall.image());
  CHECK((behind.all.state == state::unknown && behind.all.lower == 0));
  CHECK(behind.all.distance <= 0);
  const auto beyond = look(ball_at(0, 0, 5), wall.image(), {{.nearest = 0.1f, .farthest = 4}});
  CHECK(beyond.all.distance == Approx(0.9).margin(5e-3));  // what is farther does not matter
  const auto nowhere = look(ball_at(0, 0, 1), wall.image(), {{.nearest = 0.1f, .farthest = 2}});
  CHECK((nowhere.all.state == state::free && nowhere.all.point == clearance::none && nowhere.all.valid == 0));
}

TEST_CASE("What the robot itself hides is its own shadow, and hides from other cameras nothing that they see") {
  wall_camera wall;
  std::vector<point_label> labels(wall.pixels.size(), point_label::rest);
  for (std::uint32_t v = 20; v < 28; ++v)
    for (std::uint32_t u = 28; u < 36; ++u) {
      wall.pixels[v * 64 + u] = 0.95f;  // the robot's surface
      labels[v * 64 + u] = point_label::own;
    }
  const auto robot = ball_at(0, 0, 1);
  CHECK(look(robot, wall.image()).all.state == state::unknown);  // without a mask it touches its own shadow for ever
  const auto r = look(robot, clearance::masked{wall.image(), labels.data()});
  CHECK(r.all.distance == Approx(0.9).margin(0.02));
  CHECK(r.all.state == state::free);
  CHECK((r.own_shadow.state == state::unknown && r.own_shadow.valid == 64 && r.own_shadow.lower == 0));
  CHECK(r.all.dropped[int(clearance::drop_reason::masked)] == 64);

  // A second camera sees what is behind the robot. So its shadow there is no matter; but where the second sees
  // nothing, the first's own shadow does not make room free that the second hides.
  Eigen::Isometry3d beside = here;
  beside.linear() << 0, 0, -1, 0, 1, 0, 1, 0, 0;  // looks along -x
  beside.translation() << 1.4, 0, 1.6;
  const wall_camera other(1.3f);  // so all that is left of x = 0.1 is hidden from it
  using own = clearance::masked<clearance::depth_image<float>>;
  const std::vector<point_label> no_labels(wall.pixels.size(), point_label::rest);
  const std::vector<placed<own>> both{{own{wall.image(), labels.data()}, here},
                                      {own{other.image(), no_labels.data()}, beside}};
  const auto two = clearance::ask(host{}, robot.first, robot.second, both, unseen{});
  CHECK(two.all.lower <= 0.02);  // behind the ball is a place that neither sees: the second hides it
  CHECK((two.all.state != state::free || two.all.lower < 0.02f));
}

TEST_CASE("The share of a part that no camera shows is counted, and said to be unknown for a table of rays") {
  const wall_camera wall;
  CHECK(look(ball_at(0, 0, 1), wall.image()).parts[0].out_of_view == 0);
  CHECK(look(ball_at(0, 0, -1), wall.image()).parts[0].out_of_view == 1);
  const real half = look(ball_at(0.64, 0, 1), wall.image()).parts[0].out_of_view;  // the view's edge at 1 m
  CHECK((half > 0.3f && half < 0.7f));
  CHECK(look(ball_at(0.64, 0, 1), wall.image()).all.state == state::free);  // nothing is said about that
  Eigen::Isometry3d back = here;
  back.linear() << -1, 0, 0, 0, 1, 0, 0, 0, -1;
  back.translation() << 0, 0, 2;
  const std::vector<placed<clearance::depth_image<float>>> both{{wall.image(), here}, {wall.image(), back}};
  CHECK(look(ball_at(0.64, 0, 1), both).parts[0].out_of_view >= 0.3f);
  std::vector<clearance::ray> rays(wall.pixels.size());
  for (std::uint32_t i = 0; i < rays.size(); ++i) rays[i] = {real((i % 64 - 31.5) / 50), real((i / 64 - 23.5) / 50)};
  const clearance::ray_image lens(wall.pixels.data(), rays.data(), 64, 48);
  const double half_pixel = clearance::half_pixel_of(rays.data(), 64, 48);
  CHECK(half_pixel == Approx(std::hypot(0.02, 0.02) / 2).epsilon(1e-3));
  const auto r = look(ball_at(0, 0, 1), lens, {{}, half_pixel});
  CHECK((r.parts[0].out_of_view != r.parts[0].out_of_view && r.all.state == state::free));
  const auto mixed = std::tuple(placed{lens, here}, placed{wall.image(), here});
  CHECK(look(ball_at(0, 0, 1), mixed, {{}, half_pixel}).parts[0].out_of_view == 0);
}

TEST_CASE("Wherever parts are within their radii, the bracket contains the distance to the true pyramids") {
  dice d(909);
  verdict v;
  std::size_t free = 0, unknown = 0;
  for (int n = 0; n < rounds(200); ++n) {
    const picture<float> image(d, d.uniform(0, 0.5), 1.5);
    const seen_robot<inner_sphere> robot(d, image.pose, 1.5);
    unseen q{some_room(d, 1.5)};
    for (std::size_t k = 0; k < robot.parts.size(); ++k) q.radii.push_back(d.below(3) == 0 ? 0 : d.uniform(0, 0.05));
    const auto model = robot.template model<clearance::sphere>(4);
    const auto r = clearance::ask(host{}, model, robot.poses, placed{image.masked_image(), image.pose}, q);
    const auto rooms = image.hidden(q.room, true), own = image.hidden(q.room, true, true);
    double least = infinity, least_own = infinity;
    for (std::size_t k = 0; k < robot.parts.size(); ++k) {
      const place by = q.radii[k] * d.uniform(0, 1) * doubles(d.direction()).normalized();
      const Eigen::Isometry3d there = Eigen::Translation3d(by) * robot.poses[k];
      const double truth = to_rooms(robot.parts[k], there, rooms, image.pose);
      v.require(r.parts[k].lower <= std::max(truth, 0.0), "frame", n, ": part", k, " at least", r.parts[k].lower,
                ", but is", truth);
      least = std::min(least, truth);
      least_own = std::min(least_own, to_rooms(robot.parts[k], there, own, image.pose));
    }
    v.require(rooms.empty() || (r.all.lower <= std::max(least, 0.0) && std::max(least, 0.0) <= r.all.upper), "frame", n,
              ": bracket", r.all.lower, " to", r.all.upper, " misses", least);
    v.require(own.empty() || (r.own_shadow.lower <= std::max(least_own, 0.0) && least_own <= r.own_shadow.upper),
              "frame", n, ": its own shadow");
    v.require(r.all.state != state::unknown || least <= 0, "frame", n, ": unknown, but", least);
    v.require(r.own_shadow.state != state::unknown || least_own <= 0, "frame", n, ": its own shadow is unknown");
    free += r.all.state == state::free, unknown += r.all.state == state::unknown;
  }
  INFO(free << " free, " << unknown << " unknown");
  CHECK((free > 5 && unknown > 1));
}

TEST_CASE("No place that no image shows is nearer to a part than the edge of the view") {
  const wall_camera wall;
  const auto edge = [&](double x, double z) { return look(ball_at(x, 0, z), wall.image(), {.edges = true}).parts[0]; };
  CHECK(look(ball_at(0, 0, 1), wall.image()).parts[0].to_edge != 0);  // NaN: not asked
  const double beside = 0.48 / std::hypot(1, 0.48);                   // rows end at y = 0.48 z
  CHECK(edge(0, 1).to_edge == Approx(beside - 0.1).epsilon(1e-3));
  CHECK((edge(0.64, 1).to_edge == 0 && edge(0, -1).to_edge == 0));
  dice d(910);
  verdict v;
  std::size_t some = 0;
  for (int n = 0; n < rounds(60); ++n) {
    picture<float> first(d, 0, 1.5), second(d, 0, 1.5);
    for (picture<float>* its : {&first, &second})
      its->camera = {0.4 * its->width, 0.4 * its->height, 0.5 * its->width - 0.5, 0.4 * its->height};
    const std::vector cameras{placed{first.image(), first.pose}, placed{second.image(), second.pose}};
    const seen_robot<inner_sphere> robot(d, d.below(2) == 0 ? first.pose : second.pose, 1.5);
    unseen q{{.nearest = 0.05f, .farthest = 3}};
    q.edges = true, q.radii = {d.below(2) == 0 ? 0 : d.uniform(0, 0.05)};
    const auto r = clearance::ask(host{}, robot.template model<clearance::sphere>(4), robot.poses, cameras, q);
    const auto shows = [&](const picture<float>& image, const place& at) {
      const place p = image.pose.inverse() * at;
      const double u = p.x() / p.z() * image.camera.fx + image.camera.cx + 0.5,
                   v = p.y() / p.z() * image.camera.fy + image.camera.cy + 0.5;
      return p.z() >= q.room.nearest && p.z() <= q.room.farthest && u >= 0 && u <= image.width && v >= 0 &&
             v <= image.height;
    };
    for (std::size_t k = 0; k < robot.parts.size(); ++k) {
      const double edge = r.parts[k].to_edge;
      v.require(edge >= 0 && edge < 3, "frame", n, ": part", k, " is", edge, " from the edge");
      some += edge > 0;
      for (int i = 0; edge > 0 && i < 500; ++i) {
        const inner_sphere& ball = robot.parts[k][d.below(unsigned(robot.parts[k].size()))];
        const double away = d.uniform(-double(ball.radius), edge + 0.1);
        const place by = (ball.radius + away) * doubles(d.direction()).normalized();
        const place at = robot.poses[k] * (doubles(ball.center) + by);
        v.require(away >= edge + q.radii[0] || shows(first, at) || shows(second, at), "frame", n, ": part", k, " is",
                  edge, " from the edge, and a place at", away, " is not shown");
      }
    }
  }
  CHECK(some > 5);
  std::vector<clearance::ray> rays(wall.pixels.size());
  for (std::uint32_t i = 0; i < rays.size(); ++i) rays[i] = {real((i % 64 - 31.5) / 50), real((i / 64 - 23.5) / 50)};
  const clearance::ray_image lens(wall.pixels.data(), rays.data(), 64, 48);
  unseen q{.half_pixel = clearance::half_pixel_of(rays.data(), 64, 48), .edges = true};
  const real none = look(ball_at(0, 0, 1), lens, q).parts[0].to_edge;
  CHECK(none != none);
  const auto mixed = std::tuple(placed{lens, here}, placed{wall.image(), here});
  CHECK(look(ball_at(0, 0, 1), mixed, q).parts[0].to_edge == Approx(beside - 0.1).epsilon(1e-3));
}

TEST_CASE("A bracket allows for what is between a part's spheres, also where other cameras see") {
  const wall_camera wall;
  Eigen::Isometry3d back = here;
  back.linear() << -1, 0, 0, 0, 1, 0, 0, 0, -1;
  back.translation() << 0, 0, 2;
  auto part = clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 0.1f}}));
  const std::vector<placed<clearance::depth_image<float>>> both{{wall.image(), here}, {wall.image(), back}};
  const auto ask = [&](real gap) {
    part.facts.gap = gap;
    return clearance::ask(host{}, part, ball_at(0, 0, 1).second[0], both, unseen{}).all.lower;
  };
  CHECK(ask(0) > 0.25f);
  CHECK(ask(0) - ask(0.1f) == Approx(0.1).margin(1e-5));
  CHECK(ask(infinity) == 0);
}

TEST_CASE("A picture without pixels says nothing, and one without a return hides everything from `nearest` on") {
  const auto robot = ball_at(0, 0, 1);
  const clearance::depth_image<float> none(nullptr, 0, 0, {50, 50, 0, 0});
  const auto nothing = look(robot, none);
  CHECK((nothing.all.state == state::no_data && nothing.all.lower == 0 && nothing.all.upper == infinity));
  CHECK((nothing.parts[0].lower == 0 && nothing.parts[0].out_of_view == 1));
  const wall_camera wall;
  const std::vector<placed<clearance::depth_image<float>>> and_one{{none, here}, {wall.image(), here}};
  CHECK(look(robot, and_one).all.distance == Approx(0.9).margin(5e-3));
  CHECK(look(robot, and_one).all.lower <= look(robot, wall.image()).all.lower);
  std::vector<clearance::ray> no_rays(wall.pixels.size(), {clearance::not_a_number, 0});  // as where a lens folds
  const auto folded = look(robot, clearance::ray_image(wall.pixels.data(), no_rays.data(), 64, 48), {{}, 0.01});
  CHECK((folded.all.state == state::no_data && folded.all.lower == 0 && folded.parts[0].lower == 0));
  no_rays[100] = {0, 0};
  CHECK(look(robot, clearance::ray_image(wall.pixels.data(), no_rays.data(), 64, 48), {{}, 0.01}).all.state ==
        state::free);
  CHECK(look(robot, std::vector<placed<clearance::depth_image<float>>>{}).all.state == state::no_data);
  for (const float lost : {0.0f, clearance::not_a_number, infinity, -1.0f}) {
    const wall_camera blind(lost);
    const auto inside = look(robot, blind.image());
    CHECK((inside.all.state == state::unknown && inside.all.lower == 0));
    const auto before = look(robot, blind.image(), {{.nearest = 1.5f}});
    CHECK(before.all.distance == Approx(0.4).margin(0.01));
  }
  const auto open = look(robot, wall_camera(infinity).image(), {{.infinite_is_free = true}});
  CHECK((open.all.state == state::free && open.all.valid == 0));
  const auto shut = look(robot, wall_camera(-infinity).image(), {{.nearest = 1.5f}});
  CHECK(shut.all.state == state::unknown);  // something lies on the lens
}

TEST_CASE("A camera inside a part sees only that part, which is unknown") {
  const auto r = look(ball_at(0, 0, 0, 0.5f), wall_camera(0.4f).image());
  CHECK((r.all.state == state::unknown && r.all.lower == 0));
}

TEST_CASE("Pixels that are nearly 0 hide all that is behind them, also far from the camera") {
  for (const float tiny : {std::numeric_limits<float>::denorm_min(), 1e-39f, 1e-30f, 1e-10f}) {
    const wall_camera near(tiny);
    auto image = near.image();
    image.nearest = 0.01f;
    for (const real scale : {1.0f, 0.1f}) {  // products may underflow
      image.scale = scale;
      const auto r = look(ball_at(0.3, 0.2, 1), image, {{.nearest = 1.5f}});
      CHECK((r.all.state == state::unknown && r.all.valid == 64 * 48));
    }
  }
  wall_camera one(200);  // a metre wide at 100 m; one pixel has no return, from 1 mm on
  one.camera = {5000, 5000, 31.5, 23.5};
  one.pixels[24 * 64 + 40] = 0;
  const place way(8.5 / 5000, 0.5 / 5000, 1);
  for (const double z : {30.0, 40.0, 99.0}) {
    const place at = z * way + place(0, 0.3, 0);
    const auto r = look(ball_at(at.x(), at.y(), at.z()), one.image(), {{.nearest = 0.001f, .farthest = 150}});
    CHECK(r.all.distance == Approx(0.2).margin(1e-4));
  }
}

TEST_CASE("What is seen and what is not, asked together, are the answers of both questions") {
  check_seen_and_unseen(host{}, 3240);
}

TEST_CASE("What would change an answer of `unseen` is refused in a sentence") {
  const wall_camera wall;
  const auto robot = ball_at(0, 0, 1);
  const real nan = clearance::not_a_number;
  for (const hiding room : {hiding{0, 10}, hiding{-1, 10}, hiding{1, 1}, hiding{2, 1}, hiding{nan, 1}, hiding{1, nan},
                            hiding{0.1f, infinity}})
    CHECK(refusal([&] { look(robot, wall.image(), {room}); }).find("must be a range above 0") != std::string::npos);
  for (const double half : {-0.1, 0.25, double(nan)})
    CHECK(refusal([&] { look(robot, wall.image(), {{}, half}); }).find("half a pixel is") != std::string::npos);
  for (const double odd : {0.0, double(nan), double(infinity)}) {
    auto image = wall.image();
    if (!(odd > 0)) image.inverse_fx = real(1 / odd);
    if (odd == 0) CHECK(refusal([&] { look(robot, image); }).find("focal lengths") != std::string::npos);
    image.inverse_fx = 0.02f, image.cy = real(odd);
    if (odd != 0) CHECK(refusal([&] { look(robot, image); }).find("cx, cy") != std::string::npos);
  }
  const std::vector<point_label> labels(wall.pixels.size(), point_label::rest);
  CHECK(refusal([&] { look(robot, wall.image(), {{}, 0, std::span(labels).first(7)}); }).find("7 labels") !=
        std::string::npos);
  CHECK(refusal([&] {
          look(robot, clearance::masked{wall.image(), labels.data()}, {{}, 0, labels});
        }).find("has labels, and so has cloud 0") != std::string::npos);
  using some = std::variant<placed<clearance::point_span>, placed<clearance::depth_image<float>>>;
  CHECK(refusal([&] {
          look(robot, std::vector<some>{placed{wall.image()}, placed{clearance::point_span()}});
        }).find("asked about depth images, and cloud 1 is none") != std::string::npos);
  std::vector<clearance::ray> rays(wall.pixels.size(), {0, 0});
  const clearance::ray_image lens(wall.pixels.data(), rays.data(), 64, 48);
  CHECK(refusal([&] { look(robot, lens); }).find("half_pixel_of(rays, width, height)") != std::string::npos);
  for (const int which : {0, 1}) {
    Eigen::Isometry3d camera = here, part = robot.second[0];
    (which == 0 ? camera : part).translation().x() = std::nan("");
    const std::string said = refusal(
        [&] { clearance::ask(host{}, robot.first, std::vector{part}, placed{wall.image(), camera}, unseen{}); });
    INFO(said);
    CHECK(said.find("pose") != std::string::npos);
  }
  CHECK(refusal([&] {
          clearance::ask(host{}, robot.first, std::vector<Eigen::Isometry3d>{}, wall.image(), unseen{});
        }).find("pose") != std::string::npos);
}

}  // namespace unseen_test

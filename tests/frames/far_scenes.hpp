// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots and clouds with most points far away, in every kind of source, and the truth in long double.

#include "solid/shapes.hpp"
#include "support/laws.hpp"

#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/strided_points.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

#include <optional>

namespace testing {

struct ball_body {
  using part_type = clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>;
  std::vector<inner_sphere> spheres;

  explicit ball_body(dice& d) : spheres(random_spheres(d, 20, 0.3, 0.1)) {}
  part_type part() const { return clearance::make_part(clearance::build<clearance::sphere>(spheres)); }
  wide distance(oracle::vec q) const {
    wide least = infinity;
    for (const auto& s : spheres) least = std::min(least, oracle::to_sphere(q, wider(s.center), s.radius));
    return std::max(least, wide(0));
  }
};

struct box_body {
  using part_type = decltype(clearance::make_part<clearance::obb>(clearance::closed_mesh{}));
  double half[3];  // floats

  explicit box_body(dice& d) {
    for (double& h : half) h = d.number(0.05, 0.5);
  }
  part_type part() const {
    const Eigen::Vector3d high(half);
    return clearance::make_part<clearance::obb>(clearance::close_mesh(shapes::box(-high, high)));
  }
  wide distance(oracle::vec q) const {
    const auto beyond = [](wide x, double h) { return std::max(std::abs(x) - h, wide(0)); };
    return oracle::length({beyond(q.x, half[0]), beyond(q.y, half[1]), beyond(q.z, half[2])});
  }
};

/// What a source stands for: positions before anything was rounded (none: no point), and where they are in the world.
struct truth {
  std::vector<std::optional<oracle::vec>> points;
  Eigen::Isometry3d pose;

  template <class Body>
  wide distance(const std::vector<Body>& robot, const std::vector<Eigen::Isometry3d>& poses) const {
    wide least = infinity;
    for (const auto& p : points)
      for (std::size_t k = 0; p && k < robot.size(); ++k)
        least =
            std::min(least, robot[k].distance(oracle::moved_back(poses[k].matrix(), oracle::moved(pose.matrix(), *p))));
    return least;
  }
};

inline void require_bracket(const clearance::min_distance_result& r, wide distance, verdict& v,
                            const std::string& what) {
  using clearance::state;
  v.require(r.state != state::no_data && r.lower <= distance && distance <= r.upper, what, ": the distance is",
            distance, ", not from", r.lower, " to", r.upper);
  v.require(r.state != state::collision || distance == 0, what, ": no collision, but", distance);
  v.require((r.state == state::free) == (r.lower > 0) && !(r.lower > r.upper), what, ": the state");
}

inline double magnitude(dice& d, double low, double high) { return std::pow(10, d.uniform(low, high)); }
inline Eigen::Vector3d away(dice& d, double by) {
  const vec3 u = d.direction();
  return by * Eigen::Vector3d(u.x, u.y, u.z);
}

/// A robot, and coordinates (double) of which most are 1 m to 1e9 m away.
template <class Body>
struct far_scene {
  std::string name;
  std::vector<Body> robot;
  std::vector<Eigen::Isometry3d> poses;
  Eigen::Isometry3d world_from_cloud;
  Eigen::Vector3d middle, cluster;  // of the robot and of the far points, in the cloud's frame
  std::vector<Eigen::Vector3d> points;

  far_scene(dice& d, int round)
      : name("scene " + std::to_string(round)), world_from_cloud(d.pose(round % 3 == 0 ? 1 : magnitude(d, 0, 7))) {
    middle = round % 4 == 0 ? Eigen::Vector3d::Zero().eval() : away(d, magnitude(d, -1, 7));
    cluster = middle + away(d, magnitude(d, 0, 9));
    for (int k = 0; k < 2; ++k) {
      robot.emplace_back(d);
      poses.push_back(world_from_cloud * Eigen::Translation3d(middle) * d.pose(0.5));
    }
    const double spread = magnitude(d, -2, 3);
    for (int k = 0; k < 40; ++k) points.push_back(cluster + (k % 2 ? 0 : 1) * away(d, spread));
    // One a metre or so off, inside, or at a surface; or none.
    for (unsigned k = 0; k < 1 + d.below(3); ++k)
      if (round % 5 != 4)
        points.insert(points.begin() + d.below(40), middle + away(d, d.uniform(0, round % 2 ? 0.3 : 2)));
  }

  /// `use(source, truth, name)` for records and floats relative to the robot, to the far points, and to nothing.
  template <class Use>
  void each_source(Use use) const {
    const std::pair<const char*, Eigen::Vector3d> origins[] = {
        {"the robot", middle.array().round()}, {"the far points", cluster}, {"nothing", Eigen::Vector3d::Zero()}};
    for (const auto& [from, at] : origins) {
      clearance::strided_points<double> records;
      records.data = reinterpret_cast<const std::byte*>(points.data()), records.count = points.size(),
      records.step = sizeof points[0];
      records.offset[1] = 8, records.offset[2] = 16;
      // g++ 12 omits the rounding of neighbouring conversions to float and back; see to_float.
      records.origin = {clearance::to_float(at.x()), clearance::to_float(at.y()), clearance::to_float(at.z())};
      truth t{{}, world_from_cloud};
      t.pose.translation() = world_from_cloud * Eigen::Vector3d(records.origin.x, records.origin.y, records.origin.z);
      std::vector<vec3> floats;
      for (const auto& p : points) {
        t.points.push_back(oracle::vec{wide(p.x()) - records.origin.x, wide(p.y()) - records.origin.y,
                                       wide(p.z()) - records.origin.z});
        floats.push_back({real(t.points.back()->x), real(t.points.back()->y), real(t.points.back()->z)});
      }
      use(records, t, name + ", doubles less " + from);
      clearance::point_span span(floats);
      span.off = {0, 0x1.001p-24};
      use(span, t, name + ", floats less " + from);
    }
  }
};

/// A robot before a camera, near what some pixel shows, up to `farthest` away; principal points that are far out, too.
template <class Body>
struct camera_scene {
  std::string name;
  std::vector<Body> robot;
  std::vector<Eigen::Isometry3d> poses;
  Eigen::Isometry3d world_from_camera;
  clearance::intrinsics camera;
  double scale;
  std::vector<std::uint16_t> raw;
  std::vector<float> metres;
  std::vector<clearance::ray> rays;
  static constexpr std::uint32_t width = 16, height = 8;

  camera_scene(dice& d, int round)
      : name("camera " + std::to_string(round)), world_from_camera(d.pose(magnitude(d, 0, 6))) {
    const double f = magnitude(d, 1, 3), off = round % 3 ? 1 : magnitude(d, 0, 6);
    camera = {f, f * d.uniform(0.9, 1.1), off * d.uniform(0, width), off * d.uniform(0, height)};
    scale = round % 2 ? 0.001 : magnitude(d, -4, 0);
    for (std::uint32_t i = 0; i < width * height; ++i) {
      raw.push_back(d.below(8) == 0 ? 0 : std::uint16_t(magnitude(d, 2, 4.8)));
      metres.push_back(d.below(8) == 0 ? 0 : float(magnitude(d, -1, round % 2 ? 2 : 9)));
      rays.push_back({d.number(-2, 2), d.number(-2, 2)});
    }
  }
  /// Where a pixel's point is, if there is one, by what the user gave.
  std::optional<oracle::vec> at(std::uint32_t i, wide z, bool by_ray) const {
    if (z == 0) return {};
    if (by_ray) return oracle::vec{wide(rays[i].x) * z, wide(rays[i].y) * z, z};
    return oracle::deprojected(i % width, i / width, z, camera.fx, camera.fy, camera.cx, camera.cy);
  }
  template <class Use>
  void each_source(dice& d, Use use) {
    const auto one = [&](const auto& source, bool by_ray, const std::string& what) {
      truth t{{}, world_from_camera};
      for (std::uint32_t i = 0; i < width * height; ++i) {
        const auto pixel = source.pixels[i];
        t.points.push_back(
            at(i, wide(pixel) * (std::is_same_v<decltype(pixel), const float> ? wide(1) : wide(scale)), by_ray));
      }
      std::uint32_t seen = d.below(width * height);
      while (!t.points[seen]) seen = (seen + 1) % (width * height);
      const auto& p = *t.points[seen];
      robot.clear(), poses.clear();
      for (int k = 0; k < 2; ++k) {
        robot.emplace_back(d);
        poses.push_back(
            world_from_camera *
            Eigen::Translation3d(Eigen::Vector3d(double(p.x), double(p.y), double(p.z)) + away(d, d.uniform(0, 2))) *
            d.pose(0.3));
      }
      use(source, t, name + what);
    };
    one(clearance::depth_image<std::uint16_t>(raw.data(), width, height, camera, scale), false, ", 16 bits");
    one(clearance::depth_image<float>(metres.data(), width, height, camera), false, ", metres");
    one(clearance::ray_image<std::uint16_t>(raw.data(), rays.data(), width, height, scale), true, ", 16 bits by rays");
    one(clearance::ray_image<float>(metres.data(), rays.data(), width, height), true, ", metres by rays");
  }
};

template <class Body>
auto model_of(const std::vector<Body>& robot) {
  std::vector<typename Body::part_type> parts;
  for (const Body& b : robot) parts.push_back(b.part());
  return clearance::model(std::move(parts));
}

/// `use(robot, poses, source, truth, name)` for all of them.
template <class Body, class Use>
void each_far_question(int rounds, Use use) {
  dice d(91);
  for (int round = 0; round < rounds; ++round) {
    far_scene<Body> s(d, round);
    s.each_source(
        [&](const auto& source, const truth& t, const std::string& name) { use(s.robot, s.poses, source, t, name); });
    camera_scene<Body> c(d, round);
    c.each_source(d, [&](const auto& source, const truth& t, const std::string& name) {
      use(c.robot, c.poses, source, t, name);
    });
  }
}

/// Poses that are absurdly far away: the bracket becomes wide, and stays true.
template <class Body, class Use>
void each_far_pose(int rounds, Use use) {
  dice d(92);
  for (int round = 0; round < rounds; ++round) {
    const double far = magnitude(d, 6, 17.9);
    const Eigen::Isometry3d world_from_cloud = Eigen::Translation3d(away(d, far)) * d.pose(1);
    std::vector<Body> robot;
    std::vector<Eigen::Isometry3d> poses;
    for (int k = 0; k < 2; ++k) {
      robot.emplace_back(d);
      poses.push_back(world_from_cloud * Eigen::Translation3d(away(d, round % 2 ? 1 : far / 3)) * d.pose(0.5));
    }
    const Eigen::Vector3d middle = world_from_cloud.inverse() * poses[0].translation();
    std::vector<vec3> floats;
    truth t{{}, world_from_cloud};
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d p = middle + away(d, magnitude(d, -2, 3));
      floats.push_back({real(p.x()), real(p.y()), real(p.z())});
      t.points.push_back(wider(floats.back()));
    }
    use(robot, poses, clearance::point_span(floats), t, "pose " + std::to_string(round));
  }
}

}  // namespace testing

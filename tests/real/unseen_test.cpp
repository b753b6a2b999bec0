// SPDX-License-Identifier: BSD-3-Clause
// Random poses of a robot before recorded frames: the bracket of `unseen` contains the distance to all true pyramids.
#include "real/robots.hpp"
#include "support/brute_unseen.hpp"

#include <clearance/questions/unseen.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdlib>

namespace real_unseen_test {

using namespace testing;
using clearance::hiding, clearance::host, clearance::placed, clearance::state, clearance::unseen;

namespace {

constexpr hiding room{.nearest = 0.4f, .farthest = 4};

/// The pixels of a frame that hide room.
struct hiding_pixels {
  std::vector<float> x, y, from;  // the way's x and y at z = 1, and where it begins

  explicit hiding_pixels(const clearance::io::depth_frame& frame) {
    pixel_rule rule;
    rule.room = room;
    for (std::size_t i = 0; i < frame.pixels.size(); ++i)
      if (const auto z = rule.hides_from(frame.pixels[i], double(0.001f), true, false, false)) {
        x.push_back(float((double(i % frame.width) - kinect.cx) / kinect.fx));
        y.push_back(float((double(i / frame.width) - kinect.cy) / kinect.fy));
        from.push_back(float(*z));
      }
  }

  /// The least distance of any of `balls` from a true pyramid, if that is at most `within`.
  double nearest(const std::vector<std::pair<place, double>>& balls, double within) const {
    place middle(0, 0, 0);
    for (const auto& b : balls) middle += b.first / double(balls.size());
    double radius = 0, least = infinity;
    for (const auto& b : balls) radius = std::max(radius, (b.first - middle).norm() + b.second);
    const double half = std::hypot(1 / kinect.fx, 1 / kinect.fy) / 2, wide = half * (middle.norm() + radius + within);
    const float cx = float(middle.x()), cy = float(middle.y()), cz = float(middle.z()),
                most = float(std::pow((radius + within + wide) * 1.001 + 1e-4, 2));
    for (std::size_t i = 0; i < x.size(); ++i) {  // pixels whose middle is near enough that the pyramid may be
      const float t =
          std::clamp((cx * x[i] + cy * y[i] + cz) / (x[i] * x[i] + y[i] * y[i] + 1), from[i], room.farthest);
      const float dx = cx - t * x[i], dy = cy - t * y[i], dz = cz - t;
      if (!(dx * dx + dy * dy + dz * dz <= most)) continue;
      const place way(x[i], y[i], 1);
      std::optional<pyramid> its;
      for (const auto& [center, r] : balls) {
        if (to_segment(center, from[i] * way, room.farthest * way) - r > std::min(least, within) + 2 * wide) continue;
        if (!its)
          its.emplace(x[i] - 0.5 / kinect.fx, x[i] + 0.5 / kinect.fx, y[i] - 0.5 / kinect.fy, y[i] + 0.5 / kinect.fy,
                      from[i], room.farthest);
        least = std::min(least, its->distance(center) - r);
        if (least <= 0) return 0;
      }
    }
    return least <= within ? least : double(infinity);
  }
};

}  // namespace

TEST_CASE("Before recorded frames the bracket contains the true distance for 1,000 random poses of a robot", "[data]") {
  verdict v;
  dice d(3230);
  const real_robot robot("kuka_lwr_kresse/kuka.urdf", 24);
  std::vector<clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>> parts;
  for (const auto& packing : robot.packings)
    parts.push_back(clearance::make_part(clearance::build<clearance::sphere>(packing.spheres)));
  const clearance::model model(parts);
  std::vector<clearance::io::depth_frame> frames;
  std::vector<hiding_pixels> hiding;
  for (const char* name : kinect_frames) {
    frames.push_back(clearance::io::load_png(data_folder + "/clouds/kinect_seq/frame_" + name + "_depth.png"));
    hiding.emplace_back(frames.back());
  }
  int free = 0, unknown = 0;
  for (int n = 0; n < 1000; ++n) {
    const std::size_t f = std::size_t(n) % frames.size();
    Eigen::Isometry3d base = d.pose(0.7);
    base.translation().z() += n % 2 == 0 ? -0.3 : 0.3;
    const auto poses = robot.poses(base, d.uniform(-1.5, 1.5));
    const auto r = clearance::ask(host{}, model, poses, view_of(frames[f], kinect, 0.001), unseen{room});
    free += r.all.state == state::free, unknown += r.all.state == state::unknown;
    double least = infinity;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      std::vector<std::pair<place, double>> balls;
      for (const auto& s : robot.packings[k].spheres) balls.emplace_back(poses[k] * doubles(s.center), s.radius);
      const double truth = hiding[f].nearest(balls, r.parts[k].distance > 0 ? double(r.parts[k].distance) + 1e-4 : 0);
      least = std::min(least, truth);
      v.require(r.parts[k].lower <= truth, "pose", n, ", part", k, ": at least", r.parts[k].lower, ", but is", truth);
    }
    v.require(r.all.lower <= least && least <= r.all.upper, "pose", n, ": bracket", r.all.lower, " to", r.all.upper,
              " misses", least);
  }
  CHECK((free > 100 && unknown > 100));
}

}  // namespace real_unseen_test

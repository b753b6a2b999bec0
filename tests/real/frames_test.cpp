// SPDX-License-Identifier: BSD-3-Clause
// The same frame as a depth image and as a cloud, and frames of other sensors.
#include "real/robots.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

namespace frames_test {

using namespace testing;

TEST_CASE("A depth image and the cloud of the same frame agree to 1e-6 m, and in which pixels are invalid", "[data]") {
  for (const char* name : kinect_frames) {
    const std::string frame = data_folder + "/clouds/kinect_seq/frame_" + name;
    const auto png = clearance::io::load_png(frame + "_depth.png");
    const auto pcd = clearance::io::load_cloud(frame + ".pcd").relative_to({0, 0, 0});
    const auto image = view_of(png, kinect, 0.001);
    const clearance::point_span cloud(pcd.points);
    REQUIRE(image.size() == cloud.size());
    check_point_source_laws(image);
    verdict v;
    for (std::size_t i = 0; i < image.size(); ++i) {
      const auto a = image[i], b = cloud[i];
      v.require(a.valid() == b.valid(), "pixel", i, " is valid in one of both");
      if (a.valid())
        v.require(oracle::between(wider(a.position), wider(b.position)) <= 1e-6L, "pixel", i,
                  " is elsewhere: ", a.position, b.position);
    }
    // And so is the answer.
    dice d(1);
    const auto part = clearance::make_part(clearance::build<clearance::sphere>(random_spheres(d, 500, 0.2, 0.05)));
    for (const double z : {0.2, 0.9, 3.0}) {
      const auto pose = shifted(0, 0, z);
      const auto a = clearance::ask(clearance::host{}, part, pose, image, clearance::min_distance{}),
                 b = clearance::ask(clearance::host{}, part, pose, cloud, clearance::min_distance{});
      CHECK(std::abs(a.distance - b.distance) <= 1e-6f);
      CHECK(a.valid == b.valid);
      CHECK(a.state == b.state);
      CHECK(a.dropped[int(clearance::drop_reason::missing)] == b.dropped[int(clearance::drop_reason::not_finite)]);
    }
  }
}

TEST_CASE("A frame of an arm's own camera, decoded, has the depths that its source states", "[data]") {
  const auto frame = shelf_frame(0);
  const auto image = view_of(frame, shelf_camera, 1e-4);
  check_point_source_laws(image);
  std::uint64_t missing = 0;
  real nearest = infinity, farthest = 0;
  verdict v;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const auto s = image[i];
    missing += s.dropped == clearance::drop_reason::missing;
    if (!s.valid()) continue;
    nearest = std::min(nearest, s.position.z), farthest = std::max(farthest, s.position.z);
    const wide u = wide(i % 640), w = wide(i / 640);
    const auto truth = oracle::deprojected(u, w, wide(frame.pixels[i]) * 1e-4L, shelf_camera.fx, shelf_camera.fy,
                                           shelf_camera.cx, shelf_camera.cy);
    v.require(oracle::between(wider(s.position), truth) <= 1e-6L, "pixel", i, " is elsewhere");
  }
  CHECK(missing == 182138);
  CHECK(nearest == Approx(0.084).margin(5e-4));
  CHECK(farthest == Approx(1.563).margin(5e-4));
}

}  // namespace frames_test

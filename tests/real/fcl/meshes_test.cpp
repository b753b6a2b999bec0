// SPDX-License-Identifier: BSD-3-Clause
// A real robot and a real frame, compared with FCL's mesh distance (BVHModel<OBBRSS>, points as degenerate triangles).
#include "real/robots.hpp"

#include <clearance/io/robot.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/obb.hpp>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/distance.h>

namespace meshes_test {

using namespace testing;

TEST_CASE("A real robot's triangles are as far from a real frame as FCL says, link by link", "[data]") {
  using mesh = fcl::BVHModel<fcl::OBBRSSd>;
  const auto png = clearance::io::load_png(data_folder + "/clouds/kinect_seq/frame_" + kinect_frames[0] + "_depth.png");
  const auto image = view_of(png, kinect, 0.001);
  std::vector<vec3> some;
  mesh cloud;
  cloud.beginModel();
  for (std::size_t i = 0; i < image.size(); i += 23) {
    if (!image[i].valid()) continue;
    some.push_back(image[i].position);
    const Eigen::Vector3d q(some.back().x, some.back().y, some.back().z);
    cloud.addTriangle(q, q + Eigen::Vector3d(1e-10, 0, 0), q + Eigen::Vector3d(0, 1e-10, 0));
  }
  cloud.endModel();
  for (const char* urdf : {"kuka_lwr_kresse/kuka.urdf", "ur5e/ur5e.urdf"}) {
    const real_robot robot(urdf, 1);
    const auto model = robot.triangles<clearance::obb>();
    for (const double away : {1.5, 3.0}) {
      const Eigen::Isometry3d camera = looking_inward(away, 0.2, 0.6);
      const auto poses = robot.poses(shifted(0, 0, 0), 0.4);
      const auto [r, minima] =
          clearance::ask(clearance::host{}, model, poses, clearance::placed{clearance::point_span(some), camera},
                         clearance::min_distance_per_part{});
      int compared = 0;
      for (std::size_t k = 0; k < minima.size(); ++k) {
        if (minima[k].distance < 0.01f) continue;  // FCL knows no inside
        mesh link;
        link.beginModel();
        for (const auto& t : model.parts()[k].tree.primitives)
          if (t.unit_normal != vec3{0, 0, 0}) {
            const auto corner = [](vec3 c) { return Eigen::Vector3d(c.x, c.y, c.z); };
            link.addTriangle(corner(t.a), corner(t.b), corner(t.c));
          }
        link.endModel();
        fcl::DistanceRequestd request;
        fcl::DistanceResultd result;
        const double truth = fcl::distance(&link, poses[k], &cloud, camera, request, result);
        const double size = model.parts()[k].facts.radius + model.parts()[k].facts.center.z;
        CHECK(std::abs(minima[k].distance - truth) <=
              8 * 0x1p-23 * (2 * away + poses[k].translation().norm() + std::abs(size)) + 1e-9);
        ++compared;
      }
      CHECK(compared > 2);
    }
  }
}

}  // namespace meshes_test

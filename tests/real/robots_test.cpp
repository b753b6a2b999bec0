// SPDX-License-Identifier: BSD-3-Clause
// Real robots and real frames: both models and all volumes must agree within the bracket.
#include "real/robots.hpp"
#include "support/brute_force.hpp"

#include <clearance/io/robot.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace robots_test {

using namespace testing;
using clearance::host, clearance::io::robot_geometry, clearance::min_distance_per_part, clearance::placed,
    clearance::state;

namespace {

struct seen_frame {
  std::string name;
  clearance::io::depth_frame image = {};
  clearance::io::float_cloud cloud = {};
  clearance::intrinsics camera = kinect;
  double scale = 0.001;

  template <class Use>
  auto with_source(Use use) const {
    return image.pixels.empty() ? use(cloud.view().source) : use(view_of(image, camera, scale));
  }
};

std::vector<seen_frame> frames() {
  const std::string clouds = data_folder + "/clouds/";
  std::vector<seen_frame> all;
  all.push_back({"kinect", clearance::io::load_png(clouds + "kinect_seq/frame_" + kinect_frames[0] + "_depth.png")});
  for (const char* name : {"capture0001", "five_people", "table_scene_mug_stereo_textured"})
    all.push_back({name, {}, clearance::io::load_cloud(clouds + "organized/" + name + ".pcd").relative_to({0, 0, 0})});
  all.push_back({"shelf", shelf_frame(0), {}, shelf_camera, 1e-4});
  return all;
}

using answer = clearance::min_distance_per_part_result;

template <class Model>
answer ask(const Model& model, const std::vector<Eigen::Isometry3d>& poses, const seen_frame& frame,
           const Eigen::Isometry3d& camera) {
  return frame.with_source(
      [&](const auto& source) { return ask(host{}, model, poses, placed{source, camera}, min_distance_per_part{}); });
}

void require_same(const answer& a, const answer& b, verdict& v, const std::string& what) {
  const auto& [r, s] = std::pair(a.all, b.all);
  v.require(same_bits(r.distance, s.distance) && r.point == s.point && r.part == s.part && r.primitive == s.primitive &&
                r.state == s.state && same_bits(r.lower, s.lower) && same_bits(r.upper, s.upper),
            what, ": volumes disagree:", r.distance, " and", s.distance);
  for (std::size_t k = 0; k < a.parts.size(); ++k)
    v.require(same_bits(a.parts[k].distance, b.parts[k].distance) && a.parts[k].point == b.parts[k].point, what,
              ": minima of part", k);
}

void check_robot(const char* urdf, std::size_t parts, robot_geometry geometry = robot_geometry::collision) {
  const real_robot robot(urdf, 60, geometry);
  REQUIRE(robot.solids.size() == parts);
  const auto t_sphere = robot.triangles<clearance::sphere>();
  const auto t_aabb = robot.triangles<clearance::aabb>();
  const auto t_obb = robot.triangles<clearance::obb>();
  const auto s_sphere = robot.spheres<clearance::sphere>();
  const auto s_aabb = robot.spheres<clearance::aabb>();
  const auto s_obb = robot.spheres<clearance::obb>();
  verdict v;
  int free = 0, touched = 0;
  for (const seen_frame& frame : frames())
    for (const double away : {0.9, 2.5, 6.0}) {  // within the scene, at its edge, before it
      const Eigen::Isometry3d camera = looking_inward(frame.name == "shelf" ? away / 2 : away, 0.2, 0.6);
      const auto poses = robot.poses(shifted(0, 0, 0), 0.4);
      const std::string what = frame.name + " from " + std::to_string(away);
      const answer triangles = ask(t_obb, poses, frame, camera), spheres = ask(s_sphere, poses, frame, camera);
      require_same(triangles, ask(t_sphere, poses, frame, camera), v, what + ", triangles in spheres");
      require_same(triangles, ask(t_aabb, poses, frame, camera), v, what + ", triangles in boxes");
      require_same(spheres, ask(s_aabb, poses, frame, camera), v, what + ", spheres in boxes");
      require_same(spheres, ask(s_obb, poses, frame, camera), v, what + ", spheres in oriented boxes");
      const auto &t = triangles.all, &s = spheres.all;
      v.require(t.seen == 640 * 480 && t.valid == s.valid && t.valid > 0, what, ": counts");
      v.require(std::max(t.lower, s.lower) <= std::min(t.upper, s.upper), what, ": brackets do not meet:", t.lower,
                t.upper, s.lower, s.upper);
      v.require(t.state != state::no_data && s.state != state::no_data, what, ": no data");
      // No sphere reaches out of its solid, and none leaves more than the gap.
      const double room = 1e-5;
      for (std::size_t k = 0; k < triangles.parts.size(); ++k) {
        const double exact = triangles.parts[k].distance, inner = spheres.parts[k].distance,
                     gap = robot.packings[k].gap;
        v.require(std::max(inner, 0.0) >= exact - room, what, ": spheres of part", k, " reach out of the solid:", inner,
                  " but", exact);
        v.require(inner - gap <= exact + room, what, ": part", k, " leaves more than its gap", gap, ":", inner, " but",
                  exact);
      }
      v.require(!(s.state == state::collision && t.state == state::free), what,
                ": one certain of collision, the other of freedom");
      v.require(!(t.state == state::collision && s.state == state::free), what,
                ": one certain of freedom, the other of collision");
      free += t.state == state::free, touched += t.state == state::collision;
    }
  CHECK(free > 0);
  CHECK(touched > 0);
}

}  // namespace

TEST_CASE("KUKA LWR (kresse), as collision geometry: models and volumes agree within the bracket", "[data]") {
  check_robot("kuka_lwr_kresse/kuka.urdf", 8);
}
TEST_CASE("KUKA LWR (kresse), as it looks: models and volumes agree within the bracket", "[data]") {
  check_robot("kuka_lwr_kresse/kuka.urdf", 8, robot_geometry::visual);
}
TEST_CASE("KUKA LWR 4+ from CAD: models and volumes agree within the bracket", "[data]") {
  check_robot("kuka_lwr4plus_cad/kuka_lwr4plus.urdf", 8);
}
TEST_CASE("UR5e: models and volumes agree within the bracket", "[data]") { check_robot("ur5e/ur5e.urdf", 7); }
TEST_CASE("JVRC-1: models and volumes agree within the bracket", "[data]") { check_robot("jvrc1/jvrc1.urdf", 35); }

TEST_CASE("A real robot before every 997th pixel of a real frame is brute force, bit for bit", "[data]") {
  const real_robot robot("kuka_lwr_kresse/kuka.urdf", 60);
  const auto model = robot.triangles<clearance::obb>();
  std::vector<brute_part<clearance::triangle, clearance::winding_view>> parts;
  for (const auto& p : model.parts()) {
    std::vector<clearance::triangle> in_order(p.tree.primitives.size());
    for (std::size_t k = 0; k < in_order.size(); ++k) in_order[p.tree.ids[k]] = p.tree.primitives[k];
    parts.push_back({in_order, p.facts, p.interior.view()});
  }
  verdict v;
  for (const seen_frame& frame : frames())
    for (const double away : {0.9, 2.5}) {
      const Eigen::Isometry3d camera = looking_inward(away, 0.2, 0.6);
      std::vector<vec3> some;
      frame.with_source([&](const auto& source) {
        for (std::size_t i = 0; i < source.size(); i += 997)
          some.push_back(source[i].valid() ? source[i].position : vec3{clearance::not_a_number, 0, 0});
      });
      const auto poses = robot.poses(shifted(0, 0, 0), 0.4);
      const auto expected = brute_force(parts, poses, {brute_cloud(clearance::point_span(some), camera)});
      const auto [r, minima] =
          ask(host{}, model, poses, placed{clearance::point_span(some), camera}, min_distance_per_part{});
      require_equal(r, expected, v, frame.name);
      require_equal(minima, expected, v, frame.name);
      require_equal(
          clearance::ask(host{}, model, poses, placed{clearance::point_span(some), camera}, clearance::min_distance{}),
          expected, v, frame.name);
    }
}

}  // namespace robots_test

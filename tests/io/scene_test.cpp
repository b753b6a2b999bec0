// SPDX-License-Identifier: BSD-3-Clause
#include "io/glb_writer.hpp"
#include "io/scratch_file.hpp"
#include "support/catch.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/hidden_mesh.hpp>
#include <clearance/io/packing_scene.hpp>
#include <clearance/io/scene.hpp>
#include <clearance/volume/sphere.hpp>

#include <nlohmann/json.hpp>

#include <clearance/io/mesh.hpp>

#include <cstring>
#include <map>
#include <set>

namespace scene_test {

using namespace clearance;

namespace {

/// The JSON of a binary glTF file, with nodes, meshes and materials by name.
struct gltf_file {
  nlohmann::json all;
  std::map<std::string, nlohmann::json> nodes, meshes, materials;

  explicit gltf_file(const std::string& file) {
    const std::string bytes = io::read_bytes(file);
    std::uint32_t size;
    std::memcpy(&size, bytes.data() + 12, 4);
    all = nlohmann::json::parse(bytes.substr(20, size));
    for (const auto& each : all["nodes"]) nodes[each["name"]] = each;
    for (const auto& each : all["meshes"]) meshes[each["name"]] = each;
    for (const auto& each : all["materials"]) materials[each["name"]] = each;
  }
  std::size_t faces(const std::string& mesh) const {
    return all["accessors"][std::size_t(meshes.at(mesh)["primitives"][0]["indices"])]["count"].get<std::size_t>() / 3;
  }
};

}  // namespace

TEST_CASE("a scene file holds every body, point and segment where it is, z up, away from a far origin") {
  io::scene world;
  const Eigen::Vector3d far(447000, 5411000, 250);
  Eigen::Isometry3d pose = Eigen::Translation3d(far + Eigen::Vector3d(1, 2, 3)) * Eigen::Isometry3d::Identity();
  world.origin = far;
  world.bodies.push_back({.name = "link", .mesh = io::icosphere(0), .pose = pose});
  world.clouds.push_back({.name = "cloud", .points = {{1, 2, 3}, {not_a_number, 0, 0}, {4, 5, 6}}, .pose = pose});
  world.clouds.push_back({.name = "nothing", .points = {}});
  world.balls.push_back({.name = "balls", .balls = {{{0, 0, 0}, 1}, {{3, 0, 0}, 2}}, .pose = pose});
  world.segments.push_back({.name = "witness", .from = far, .to = far + Eigen::Vector3d(0, 0, 0.5)});
  const scratch_file file(".glb");
  io::save_scene(world, file.path);

  const gltf_file read(file.path);
  REQUIRE(read.meshes.size() == 4);
  CHECK(read.faces("link") == 20);
  CHECK(read.faces("balls") == 1280 + 320);
  CHECK(read.faces("witness") == 12);
  const auto points = read.meshes.at("cloud")["primitives"][0];
  CHECK(points["mode"] == 0);
  CHECK(read.all["accessors"][std::size_t(points["attributes"]["POSITION"])]["count"] == 2);
  CHECK(read.all["accessors"][std::size_t(points["attributes"]["COLOR_0"])]["count"] == 2);
  CHECK(read.nodes.at("link")["matrix"][12] == 1.0);
  CHECK(read.nodes.at("link")["matrix"][14] == 3.0);
  CHECK(read.nodes.at("world")["matrix"][9] == 1);  // z becomes y
  CHECK(read.nodes.at("world")["matrix"][6] == -1);
  CHECK(read.nodes.at("world")["children"].size() == 4);
}

TEST_CASE("points have the colour of their cloud, or each its own, also where some are left out") {
  io::scene world;
  const std::vector<vec3> points = {{1, 2, 3}, {not_a_number, 0, 0}, {4, 5, 6}};
  world.clouds.push_back({.name = "one", .points = points, .paint = {0.5f, 0.25f, 0, 1}});
  world.clouds.push_back({.name = "each", .points = points, .colours = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}}});
  const scratch_file file(".glb");
  io::save_scene(world, file.path);
  const gltf_file read(file.path);
  const std::string bytes = io::read_bytes(file.path);
  const std::size_t data = bytes.find(std::string("BIN\0", 4)) + 4;
  const auto colours = [&](const std::string& name) {
    const auto& at = read.all["accessors"][std::size_t(read.meshes.at(name)["primitives"][0]["attributes"]["COLOR_0"])];
    std::vector<float> values(4 * at["count"].get<std::size_t>());
    std::memcpy(
        values.data(),
        bytes.data() + data + read.all["bufferViews"][std::size_t(at["bufferView"])]["byteOffset"].get<std::size_t>(),
        4 * values.size());
    return values;
  };
  CHECK(colours("one") == std::vector<float>{0.5f, 0.25f, 0, 1, 0.5f, 0.25f, 0, 1});
  CHECK(colours("each") == std::vector<float>{1, 0, 0, 1, 0, 0, 1, 1});
}

TEST_CASE("the mesh of a scene file is the mesh that went in, turned so that y is up") {
  io::scene world;
  world.bodies.push_back(
      {.name = "a\xffname", .mesh = io::icosphere(1), .pose = Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3))});
  world.bodies.push_back({.name = "grouped", .mesh = io::icosphere(0), .group = "g"});
  const scratch_file file(".glb");
  io::save_scene(world, file.path);
  const triangle_mesh read = io::load_mesh(file.path, {}, io::gltf_axis::z);
  REQUIRE(read.triangles.size() == 100);
  for (std::size_t t = 0; t < 80; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d in =
          world.bodies[0].mesh.vertices[world.bodies[0].mesh.triangles[t][k]] + Eigen::Vector3d(1, 2, 3);
      CHECK((read.vertices[read.triangles[t][k]] - Eigen::Vector3d(in.x(), in.z(), -in.y())).norm() < 1e-6);
    }
  const gltf_file json(file.path);
  CHECK(json.nodes.count("a\\xffname") == 1);
}

TEST_CASE("drawn balls are where they are, and look outward") {
  std::vector<ball> balls;
  for (int i = 0; i < 600; ++i) balls.push_back({{real(20 * i), 1, 2}, real(0.5 + i % 7)});
  const auto mesh = io::faces_of(balls);
  std::vector<int> corners(balls.size(), 0);
  const auto eigen = [](vec3 v) { return Eigen::Vector3f(v.x, v.y, v.z); };
  REQUIRE(mesh.normals.size() == mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto nearest = std::size_t(std::lround(mesh.positions[v].x / 20));
    const ball& b = balls[nearest];
    ++corners[nearest];
    const Eigen::Vector3f out = eigen(mesh.positions[v]) - eigen(b.center);
    if (!(std::abs(out.norm() - b.radius) < 5e-3) || !((out / b.radius - eigen(mesh.normals[v])).norm() < 1e-2))
      FAIL("vertex " << v);
  }
  for (const int count : corners) CHECK(count >= 12);
  for (std::size_t f = 0; f < mesh.corners.size(); f += 3) {
    const auto at = [&](std::size_t k) { return eigen(mesh.positions[mesh.corners[f + k]]); };
    if (!((at(1) - at(0)).cross(at(2) - at(0)).dot(eigen(mesh.normals[mesh.corners[f]])) > 0)) FAIL("face " << f);
  }
}

TEST_CASE("a packing is drawn as its mesh, its spheres by size, and a node for each level of its tree") {
  io::scene_packing part{.name = "arm", .mesh = io::icosphere(1), .spheres = {}};
  for (int i = 0; i < 200; ++i)
    part.spheres.spheres.push_back({{real(i % 20), real(i / 20), 0}, i % 2 ? 0.003f : 0.3f});
  part.pose = Eigen::Translation3d(1, 2, 3);
  const scratch_file file(".glb");
  io::save_scene(io::packing_scene({part}), file.path);
  const gltf_file read(file.path);
  const auto tree = build<sphere>(part.spheres.spheres);
  std::set<std::string> members;
  for (const std::size_t child : read.nodes.at("arm")["children"]) members.insert(read.all["nodes"][child]["name"]);
  CHECK(members.size() == 1 + 2 + tree.depth + 1);
  for (std::uint32_t level = 0; level <= tree.depth; ++level)
    CHECK(members.count("arm level " + std::to_string(level)));
  REQUIRE(members.count("arm mesh"));
  CHECK(read.nodes.at("arm mesh")["matrix"][13] == 2.0);
  CHECK(read.materials.at("arm mesh")["alphaMode"] == "BLEND");
  // Every node of the tree is drawn once, on its level.
  std::size_t drawn = 0;
  for (const auto& level : io::levels_of(tree.view())) drawn += level.size();
  CHECK(drawn == tree.nodes.size());
}

TEST_CASE("the faces of drawn balls and rods look outward") {
  for (const triangle_mesh& mesh : {io::icosphere(0), io::icosphere(2), io::rod({0, 0.3, 0.4}), io::rod({0, 0, 0})}) {
    double six_volumes = 0;
    for (const auto& t : mesh.triangles)
      six_volumes += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
    CHECK(six_volumes > 0);
  }
}

TEST_CASE("a scene that cannot be written is refused") {
  io::scene world;
  CHECK(!refusal([&] { io::save_scene(world, "/tmp/x.glb"); }).empty());
  world.segments.push_back({.name = "witness", .from = {0, 0, 0}, .to = {0, 0, 1}});
  CHECK(refusal([&] { io::save_scene(world, "/nonexistent/folder/x.glb"); }).find("/nonexistent/folder/x.glb") == 0);
}

TEST_CASE("hidden room is drawn from what hides it to where it ends, in blocks of the nearest") {
  std::vector<float> depth(40 * 30, 2);
  depth[10 * 40 + 20] = 0;  // no return: from `nearest` on
  const depth_image image(depth.data(), 40, 30, intrinsics{50, 50, 19.5, 14.5});
  const hiding room{.nearest = 0.5f, .farthest = 3};
  const auto fine = io::hidden_mesh(image, room), coarse = io::hidden_mesh(image, room, {}, 12);
  CHECK(coarse.triangles.size() < 200);
  CHECK(fine.triangles.size() > 2 * 2 * 40 * 30);
  for (const auto& mesh : {fine, coarse}) {
    double low = 10, high = 0, wide = 0;
    for (const auto& v : mesh.vertices) {
      low = std::min(low, v.z()), high = std::max(high, v.z()), wide = std::max(wide, v.x() / v.z());
      REQUIRE((v.z() > 0.49 && v.z() < 3.01));
    }
    CHECK((low == 0.5 && high == 3));
    CHECK(wide == Approx(0.4));
  }
  const std::vector<point_label> own(depth.size(), point_label::own);  // but for the pixel that has no point
  CHECK(io::hidden_mesh(image, room, own, 12).triangles.empty());
  CHECK(io::hidden_mesh(image, {.nearest = 0.1f, .farthest = 0.2f}).triangles.size() == 12);
  CHECK(io::hidden_mesh(depth_image<float>(), room).triangles.empty());
}

}  // namespace scene_test

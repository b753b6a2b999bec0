// SPDX-License-Identifier: BSD-3-Clause
#include "io/scratch_file.hpp"
#include "support/catch.hpp"

#include <clearance/io/scene.hpp>

#include <assimp/Importer.hpp>

#include <map>

using namespace clearance;

TEST_CASE("a scene file holds every body, point and segment where it is, z up, away from a far origin") {
  io::scene world;
  const Eigen::Vector3d far(447000, 5411000, 250);
  Eigen::Isometry3d pose = Eigen::Translation3d(far + Eigen::Vector3d(1, 2, 3)) * Eigen::Isometry3d::Identity();
  world.origin = far;
  world.bodies.push_back({.name = "link", .mesh = io::octahedra({{{0, 0, 0}, 1}}), .pose = pose});
  world.clouds.push_back({.name = "cloud", .points = {{1, 2, 3}, {not_a_number, 0, 0}, {4, 5, 6}}, .pose = pose});
  world.clouds.push_back({.name = "nothing", .points = {}});
  world.balls.push_back({.name = "balls", .balls = {{{0, 0, 0}, 1}, {{3, 0, 0}, 2}}, .pose = pose});
  world.segments.push_back({.name = "witness", .from = far, .to = far + Eigen::Vector3d(0, 0, 0.5)});
  const scratch_file file(".glb");
  io::save_scene(world, file.path);

  Assimp::Importer importer;
  const aiScene* read = importer.ReadFile(file.path, 0);
  REQUIRE(read);
  std::map<std::string, const aiMesh*> meshes;
  for (unsigned i = 0; i < read->mNumMeshes; ++i) meshes[read->mMeshes[i]->mName.C_Str()] = read->mMeshes[i];
  REQUIRE(meshes.size() == 4);
  CHECK(meshes.at("link")->mNumFaces == 8);
  CHECK(meshes.at("balls")->mNumFaces == 16);
  CHECK(meshes.at("cloud")->mNumVertices == 2);
  CHECK(meshes.at("cloud")->mPrimitiveTypes == aiPrimitiveType_POINT);
  CHECK(meshes.at("cloud")->mColors[0] != nullptr);
  CHECK(meshes.at("witness")->mNumFaces == 12);
  const aiNode* link = read->mRootNode->FindNode("link");
  REQUIRE(link);
  CHECK(link->mTransformation.a4 == 1);
  CHECK(link->mTransformation.c4 == 3);
  aiVector3D up = read->mRootNode->mTransformation * aiVector3D(0, 0, 1);
  CHECK(up.y == Approx(1));
}

TEST_CASE("the faces of drawn balls and rods look outward") {
  for (const triangle_mesh& mesh : {io::octahedra({{{0, 0, 0}, 2}}), io::rod({0, 0.3, 0.4}), io::rod({0, 0, 0})}) {
    double six_volumes = 0;
    for (const auto& t : mesh.triangles) six_volumes += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
    CHECK(six_volumes > 0);
  }
}

TEST_CASE("a scene that cannot be written is refused") {
  io::scene world;
  CHECK(!refusal([&] { io::save_scene(world, "/tmp/x.glb"); }).empty());
  world.segments.push_back({.name = "witness", .from = {0, 0, 0}, .to = {0, 0, 1}});
  CHECK(refusal([&] { io::save_scene(world, "/nonexistent/folder/x.glb"); }).find("/nonexistent/folder/x.glb") == 0);
}

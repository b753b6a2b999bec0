// SPDX-License-Identifier: BSD-3-Clause
#include "io/scratch_file.hpp"
#include "support/catch.hpp"

#include <clearance/io/packing_scene.hpp>
#include <clearance/io/scene.hpp>

#include <assimp/Importer.hpp>

#include <map>

using namespace clearance;

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

  Assimp::Importer importer;
  const aiScene* read = importer.ReadFile(file.path, 0);
  REQUIRE(read);
  std::map<std::string, const aiMesh*> meshes;
  for (unsigned i = 0; i < read->mNumMeshes; ++i) meshes[read->mMeshes[i]->mName.C_Str()] = read->mMeshes[i];
  REQUIRE(meshes.size() == 4);
  CHECK(meshes.at("link")->mNumFaces == 20);
  CHECK(meshes.at("balls")->mNumFaces == 1280 + 320);
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

TEST_CASE("drawn balls are where they are, and look outward") {
  std::vector<ball> balls;
  for (int i = 0; i < 600; ++i) balls.push_back({{real(20 * i), 1, 2}, real(0.5 + i % 7)});
  const auto mesh = io::faces_of(balls);
  std::vector<int> corners(balls.size(), 0);
  for (unsigned v = 0; v < mesh->mNumVertices; ++v) {
    const aiVector3D& p = mesh->mVertices[v];
    const ball& b = balls[std::size_t(std::lround(p.x / 20))];
    ++corners[std::size_t(std::lround(p.x / 20))];
    const aiVector3D out = p - aiVector3D(b.center.x, b.center.y, b.center.z);
    if (!(std::abs(out.Length() - b.radius) < 5e-3) || !((out / b.radius - mesh->mNormals[v]).Length() < 1e-2)) FAIL("vertex " << v);
  }
  for (const int count : corners) CHECK(count >= 12);
  for (unsigned f = 0; f < mesh->mNumFaces; ++f) {
    const aiVector3D *v = mesh->mVertices, *n = mesh->mNormals;
    const unsigned* i = mesh->mFaces[f].mIndices;
    const aiVector3D e = v[i[1]] - v[i[0]], g = v[i[2]] - v[i[0]];
    if (!((e ^ g) * n[i[0]] > 0)) FAIL("face " << f);
  }
}

TEST_CASE("a packing is drawn as its mesh, its spheres by size, and a node for each level of its tree") {
  io::scene_packing part{.name = "arm", .mesh = io::icosphere(1), .spheres = {}};
  for (int i = 0; i < 200; ++i) part.spheres.spheres.push_back({{real(i % 20), real(i / 20), 0}, i % 2 ? 0.003f : 0.3f});
  part.pose = Eigen::Translation3d(1, 2, 3);
  const scratch_file file(".glb");
  io::save_scene(io::packing_scene({part}), file.path);
  Assimp::Importer importer;
  const aiScene* read = importer.ReadFile(file.path, 0);
  REQUIRE(read);
  const aiNode* group = read->mRootNode->FindNode("arm");
  REQUIRE(group);
  const auto tree = build<sphere>(part.spheres.spheres);
  CHECK(group->mNumChildren == 1 + 2 + tree.depth + 1);
  for (std::uint32_t level = 0; level <= tree.depth; ++level) CHECK(group->FindNode(("arm level " + std::to_string(level)).c_str()));
  const aiNode* mesh = group->FindNode("arm mesh");
  REQUIRE(mesh);
  CHECK(mesh->mTransformation.b4 == 2);
  aiString blend;
  CHECK(read->mMaterials[read->mMeshes[mesh->mMeshes[0]]->mMaterialIndex]->Get(AI_MATKEY_GLTF_ALPHAMODE, blend) == aiReturn_SUCCESS);
  CHECK(std::string(blend.C_Str()) == "BLEND");
  // Every node of the tree is drawn once, on its level.
  std::size_t drawn = 0;
  for (const auto& level : io::levels_of(tree.view())) drawn += level.size();
  CHECK(drawn == tree.nodes.size());
}

TEST_CASE("the faces of drawn balls and rods look outward") {
  for (const triangle_mesh& mesh : {io::icosphere(0), io::icosphere(2), io::rod({0, 0.3, 0.4}), io::rod({0, 0, 0})}) {
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

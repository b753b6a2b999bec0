// SPDX-License-Identifier: BSD-3-Clause
// Which axis of a robot's glTF meshes is up: as it is asked for, as other geometry shows, or as the format has it.
#include "io/gltf_files.hpp"
#include "io/robot_folder.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/io/robot.hpp>

#include <random>

namespace robot_gltf_test {

using namespace clearance;
using io::gltf_axis;
using io::robot_geometry;

namespace {

std::string mesh(const std::string& kind, const std::string& file) {
  return "<" + kind + "><origin xyz=\"0.1 0.2 0.3\" rpy=\"0.3 0.2 0.1\"/><geometry><mesh filename=\"" + file +
         "\" scale=\"0.5 0.5 0.5\"/></geometry></" + kind + ">";
}
std::string link(const std::string& name, const std::string& inside) {
  return "<link name=\"" + name + "\">" + inside + "</link>";
}
std::string robot(const std::vector<std::string>& links) {
  std::string text = "<robot name=\"r\">";
  for (const auto& each : links) text += each;
  for (std::size_t k = 1; k < links.size(); ++k)
    text += "<joint name=\"j" + std::to_string(k) + "\" type=\"fixed\"><parent link=\"l0\"/><child link=\"l" +
            std::to_string(k) + "\"/></joint>";
  return text + "</robot>";
}

/// The vertices of the OBJ file and of the glTF file are in one order.
double off(const io::robot_part& a, const io::robot_part& b) {
  double most = 0;
  REQUIRE(a.mesh.vertices.size() == b.mesh.vertices.size());
  for (std::size_t i = 0; i < a.mesh.vertices.size(); ++i)
    most = std::max(most, (a.mesh.vertices[i] - b.mesh.vertices[i]).norm());
  return most;
}

struct scene {
  robot_folder folder;

  io::robot load(const std::string& text, io::robot_options options = {}) const {
    return io::load_robot(folder.put("r.urdf", text), options);
  }
  io::robot seen(const std::string& text) const { return load(text, {.geometry = robot_geometry::visual}); }
};

std::string all(const io::robot& r) {
  std::string text;
  for (const auto& note : r.notes()) text += note + '\n';
  return text;
}

}  // namespace

TEST_CASE("A glTF beside other geometry of its link is read as it fits that, whichever of the two is asked about") {
  const scene here;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> side(0.1f, 2);
  int told = 0;
  for (int run = 0; run < 60; ++run) {
    const box_mesh box({side(random), side(random), side(random)});
    const bool y = run % 2 == 0, visual = run % 4 < 2;
    here.folder.put("m.obj", box.obj());
    here.folder.put("m.glb", glb_of(y ? box.y_up() : box));
    const std::string text = robot(
        {link("l0", mesh(visual ? "visual" : "collision", "m.glb") + mesh(visual ? "collision" : "visual", "m.obj"))});
    const io::robot obj = here.load(text, {.geometry = visual ? robot_geometry::collision : robot_geometry::visual});
    const io::robot glb = here.load(text, {.geometry = visual ? robot_geometry::visual : robot_geometry::collision});
    CHECK(obj.notes().empty());  // no glTF was read
    REQUIRE(glb.notes().size() == 1);
    INFO(glb.notes()[0]);
    CHECK(says(glb.notes()[0], "--gltf-up"));
    const bool tells = says(glb.notes()[0], "fit the link's other geometry");
    told += tells;
    if (tells) {
      CHECK(says(glb.notes()[0], y ? "with y up:" : "with z up:"));
      CHECK(off(glb.parts()[0], obj.parts()[0]) < 1e-6);
    } else {
      CHECK(says(glb.notes()[0], "the format has it so"));
    }
    // Who says which gets it, without a word.
    for (const gltf_axis up : {gltf_axis::y, gltf_axis::z}) {
      const io::robot asked =
          here.load(text, {.geometry = visual ? robot_geometry::visual : robot_geometry::collision, .gltf_up = up});
      CHECK(asked.notes().empty());
      CHECK((off(asked.parts()[0], obj.parts()[0]) < 1e-6) == ((up == gltf_axis::y) == y));
    }
  }
  CHECK(told > 50);  // a box that looks alike from two sides tells nothing
}

TEST_CASE("A glTF that nothing tells about is read with y up, as the format has it, with a note") {
  const scene here;
  const box_mesh box({0.2f, 0.2f, 1});
  box_mesh cube({1, 1, 1});
  for (auto& p : cube.corners) p.array() -= 0.5f;
  here.folder.put("m.glb", glb_of(box.y_up())), here.folder.put("c.glb", glb_of(cube)),
      here.folder.put("c.obj", cube.obj());
  here.folder.put("torn.obj", "v 0 0 x\n");
  here.folder.put("m.gltf", gltf_of(box.y_up(), data_uri(box.y_up())));
  here.folder.put("nameless", glb_of(box.y_up()));
  const auto tall = [](const io::robot& r) {  // without the origin's turn
    const Eigen::Isometry3d turn(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
    Eigen::AlignedBox3d all;
    for (const auto& v : r.parts()[0].mesh.vertices) all.extend(turn.inverse() * v);
    return all.sizes().z();
  };
  for (const std::string& inside :
       {mesh("collision", "m.glb"), mesh("visual", "m.glb"), mesh("collision", "m.gltf"), mesh("collision", "m.GLB"),
        mesh("collision", "m.glb") + mesh("visual", "m.glb"), mesh("collision", "m.glb") + mesh("visual", "gone.obj"),
        mesh("collision", "m.glb") + mesh("visual", "torn.obj"), mesh("collision", "nameless")}) {
    if (says(inside, "GLB")) std::filesystem::copy_file(here.folder.path / "m.glb", here.folder.path / "m.GLB");
    const io::robot r = here.load(robot({link("l0", inside)}));
    INFO(inside << '\n' << all(r));
    CHECK(tall(r) == Approx(0.5));
    CHECK(says(all(r), "y up"));
    CHECK(says(all(r), "--gltf-up"));
    CHECK_FALSE(sentence([&] { here.load(robot({link("l0", inside)}), {.strict = true}); }).empty());
    CHECK(tall(here.load(robot({link("l0", inside)}), {.gltf_up = gltf_axis::z})) == Approx(0.1));
  }
  const io::robot symmetric = here.seen(robot({link("l0", mesh("visual", "c.glb") + mesh("collision", "c.obj"))}));
  CHECK(says(all(symmetric), "the format has it so"));
}

TEST_CASE("Links that tell speak for those that cannot, and each for itself where they differ") {
  const scene here;
  const box_mesh box({0.2f, 0.5f, 1});
  here.folder.put("m.obj", box.obj()), here.folder.put("y.glb", glb_of(box.y_up())),
      here.folder.put("z.glb", glb_of(box));
  const auto pair = [](const std::string& name, const std::string& glb) {
    return link(name, mesh("visual", glb) + mesh("collision", "m.obj"));
  };
  const auto alone = [](const std::string& name, const std::string& glb) { return link(name, mesh("visual", glb)); };
  const io::robot agree = here.seen(robot({pair("l0", "z.glb"), alone("l1", "z.glb"), pair("l2", "z.glb")}));
  for (const auto& part : agree.parts()) CHECK(off(part, agree.parts()[0]) < 1e-12);
  CHECK(says(all(agree), "so those of other links fit"));
  const io::robot differ =
      here.seen(robot({pair("l0", "z.glb"), pair("l1", "y.glb"), alone("l2", "y.glb"), alone("l3", "z.glb")}));
  for (const std::size_t k : {1, 2}) CHECK(off(differ.parts()[k], differ.parts()[0]) < 1e-6);
  CHECK(off(differ.parts()[3], differ.parts()[0]) > 0.1);
  CHECK(says(all(differ), "\"l2\", link \"l3\": has glTF meshes, which are read with y up: the format has it so"));
}

TEST_CASE("A post that the format has upright stands upright", "[data]") {
  const std::string folder = testing::data("/field/01-glb-y-up");
  const io::robot r = io::load_robot(folder + "/post.urdf");
  Eigen::AlignedBox3d box;
  for (const auto& v : r.parts()[0].mesh.vertices) box.extend(v);
  CHECK(box.sizes().z() == Approx(1));
  CHECK(r.notes().size() == 1);
}

}  // namespace robot_gltf_test

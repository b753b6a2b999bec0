// SPDX-License-Identifier: BSD-3-Clause
// The paths and URIs by which descriptions name meshes.
#include "io/robot_folder.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/io/robot.hpp>

namespace mesh_paths_test {

using namespace clearance;

namespace {

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

struct scene {
  robot_folder folder;

  io::robot load(const std::string& urdf, const std::string& uri, const io::robot_options& options = {}) const {
    return io::load_robot(folder.put(urdf, "<robot name=\"r\"><link name=\"b\"><collision><geometry><mesh filename=\"" +
                                               uri + "\"/></geometry></collision></link></robot>"),
                          options);
  }
  std::string refusal(const std::string& urdf, const std::string& uri, const io::robot_options& options = {}) const {
    return sentence([&] { load(urdf, uri, options); });
  }
  std::string at(const std::string& inside) const { return (folder.path / inside).string(); }
};

}  // namespace

TEST_CASE("A mesh is found by every way to write its path: blanks, %20, backslashes, and file URIs of any kind") {
  const scene here;
  here.folder.put("ws/my robot/meshes/a mesh.obj", triangle);
  here.folder.put("ws/my robot/meshes/50%25.obj", triangle);
  const std::string plain = here.at("ws/my robot/meshes/a mesh.obj"),
                    coded = here.at("ws/my%20robot/meshes/a%20mesh.obj");
  for (const std::string& uri :
       {plain, coded, "file://" + plain, "file://" + coded, "file:" + plain, "file:" + coded,
        "file://localhost" + coded, std::string("../meshes/a mesh.obj"), std::string("../meshes/a%20mesh.obj"),
        std::string("..\\meshes\\a mesh.obj"), std::string("..\\meshes\\a%20mesh.obj"),
        std::string("file://../meshes/a mesh.obj"), std::string("package://my robot/meshes/a%20mesh.obj"),
        std::string("package://my robot\\meshes\\a mesh.obj"), std::string("model://my robot/meshes/a mesh.obj"),
        std::string("../meshes/50%25.obj"), std::string("../meshes/50%2525.obj")}) {
    INFO(uri);
    const io::robot r = here.load("ws/my robot/urdf/r.urdf", uri);
    CHECK(r.parts().size() == 1);
    CHECK(r.notes().empty());
  }
  for (const std::string uri : {"../meshes/a+mesh.obj", "../meshes/a%2.obj", "../meshes/a%00mesh.obj", "http://h/a.obj",
                                "$(find my_robot)/a.obj", "${meshes}/a.obj", "package://", "package:///", "file:"}) {
    INFO(uri);
    CHECK_FALSE(here.refusal("ws/my robot/urdf/r.urdf", uri).empty());
  }
  CHECK(says(here.refusal("ws/my robot/urdf/r.urdf", "$(find my_robot)/a.obj"), "expand it with xacro"));
}

TEST_CASE("A path of another machine is found in the package that it goes through, given or here") {
  const scene here;
  const std::string uri = "file:///home/builder/ws/install/arm_description/share/arm_description/meshes/base.obj";
  here.folder.put("lib/x/arm_description/meshes/base.obj", triangle);
  here.folder.put("else/where/meshes/base.obj", triangle);
  const io::robot_options given{.packages = {{"arm_description", here.folder.path / "else/where"}}};
  for (const std::string& path :
       {uri, std::string("/home/builder/ws/src/arm_description/meshes/base.obj"),
        std::string("C:\\ws\\arm_description\\meshes\\base.obj"),
        std::string("file:///opt/arm_description/share/other/arm_description/meshes/base.obj"),
        std::string("file:///home/a%20b/arm_description/meshes/base.obj")}) {
    INFO(path);
    CHECK(here.load("far/urdf/r.urdf", path, given).notes().empty());
    // Without being told, only the package above the description will do, and only for an install folder.
    const std::string refused = here.refusal("far/urdf/r.urdf", path);
    CHECK(says(refused, "there is no such file"));
  }
  const io::robot found = here.load("lib/x/arm_description/urdf/r.urdf", uri);
  REQUIRE(found.notes().size() == 1);
  CHECK(says(found.notes()[0], "--package arm_description=FOLDER"));
  CHECK(says(here.refusal("far/urdf/r.urdf", uri), "--package arm_description=FOLDER says where it is"));
  CHECK(says(here.refusal("lib/x/arm_description/urdf/r.urdf", "/home/x/src/other_name/meshes/base.obj"),
             "--package other_name=" + here.at("lib/x/arm_description") + " would do"));
  CHECK(says(here.refusal("far/urdf/r.urdf", "/home/builder/gone.obj", given), "/home/builder/gone.obj"));
  // A file that is here is the one that is meant.
  CHECK(here.load("far/urdf/r.urdf", here.at("lib/x/arm_description/meshes/base.obj"), given).parts().size() == 1);
}

TEST_CASE("A package that no mesh names, and a file in place of a package, are noted") {
  const scene here;
  here.folder.put("wheel.obj", triangle);
  const io::robot beside = here.load("r.urdf", "package://wheel.obj");
  REQUIRE(beside.notes().size() == 1);
  CHECK(says(beside.notes()[0], "names a file as its package"));
  CHECK(says(here.refusal("r.urdf", "package://gone.obj"), "names no file in a package"));
  const io::robot unused = here.load("r.urdf", "wheel.obj", {.packages = {{"arm", here.folder.path}, {"leg", "/"}}});
  REQUIRE(unused.notes().size() == 1);
  CHECK(says(unused.notes()[0], "package \"arm\", package \"leg\": was given, and no mesh that was read is in it"));
}

TEST_CASE("A description for another machine loads where its package is given or above it", "[data]") {
  const std::string data = testing::data("/field/56-path-of-another-machine/arm_description");
  const scene here;
  std::filesystem::copy(data, here.folder.path / "arm_description", std::filesystem::copy_options::recursive);
  std::filesystem::permissions(here.folder.path / "arm_description", std::filesystem::perms::owner_all);
  const std::string uri = "file:///home/builder/ws/install/arm_description/share/arm_description/meshes/base.stl";
  CHECK(here.load("arm_description/urdf/arm.urdf", uri).notes().size() == 1);
  CHECK(here.load("arm.urdf", uri, {.packages = {{"arm_description", data}}}).notes().empty());
}

}  // namespace mesh_paths_test

// SPDX-License-Identifier: BSD-3-Clause
#include "io/robot_folder.hpp"
#include "io/robot_link.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

#include <clearance/io/robot.hpp>
#include <clearance/io/robot_bodies.hpp>

#include <cstdlib>
#include <numbers>

namespace robot_test {

using namespace clearance;
using io::load_robot;

namespace {

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::string a_link(const std::string& name, const std::string& inside = "") {
  return "<link name=\"" + name + "\">" + inside + "</link>\n";
}
std::string collision(const std::string& geometry, const std::string& origin = "") {
  return "<collision>" + origin + "<geometry>" + geometry + "</geometry></collision>";
}
std::string visual(const std::string& geometry) { return "<visual><geometry>" + geometry + "</geometry></visual>"; }
std::string mesh(const std::string& uri, const std::string& more = "") {
  return "<mesh filename=\"" + uri + "\" " + more + "/>";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& inside = "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + inside + "</joint>\n";
}
std::string robot(const std::string& inside) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + inside + "</robot>\n";
}

std::string box = "<box size=\"1 2 3\"/>";

/// Six times the signed volume that a closed mesh facing out encloses.
double volume(const triangle_mesh& m) {
  double sum = 0;
  for (const auto& [a, b, c] : m.triangles) sum += m.vertices[a].dot(m.vertices[b].cross(m.vertices[c]));
  return sum / 6;
}

bool closed(const triangle_mesh& m) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : m.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || edges.count({edge.second, edge.first}) == 0) return false;
  return true;
}

}  // namespace

TEST_CASE("shapes become closed meshes that face out, and the error stated is the error there is") {
  for (const double r : {0.003, 0.05, 0.4, 2.0}) {
    const auto sphere = io::tessellate_sphere(r, 1e-4, 1u << 20);
    CHECK(closed(sphere.mesh));
    CHECK(sphere.error <= 1e-4);
    CHECK(volume(sphere.mesh) > 4.1 * std::pow(r - sphere.error, 3));
    CHECK(volume(sphere.mesh) < 4 * std::numbers::pi / 3 * r * r * r);
    double worst = 0;
    for (const auto& v : sphere.mesh.vertices) CHECK(std::abs(v.norm() - r) < 1e-15 * 10 * r);
    for (const auto& [a, b, c] : sphere.mesh.triangles) {
      const auto& m = sphere.mesh.vertices;
      worst = std::max(worst, r - ((m[a] + m[b] + m[c]) / 3).norm());
    }
    CHECK(worst <= sphere.error);
    CHECK(worst > 0.9 * sphere.error);

    const auto cylinder = io::tessellate_cylinder(r, 0.7);
    CHECK(closed(cylinder.mesh));
    CHECK(cylinder.error <= 1e-4);
    CHECK(volume(cylinder.mesh) < std::numbers::pi * r * r * 0.7);
    CHECK(volume(cylinder.mesh) > 0.95 * std::numbers::pi * r * r * 0.7);
    worst = 0;
    for (const auto& [a, b, c] : cylinder.mesh.triangles) {
      const auto& m = cylinder.mesh.vertices;
      if (a < 2) worst = std::max(worst, r - ((m[b] + m[c]) / 2).head<2>().norm());
      CHECK(std::abs(std::abs(m[b].z()) - 0.35) < 1e-15);
    }
    CHECK(worst <= cylinder.error);
    CHECK(worst > 0.99 * cylinder.error);

    const auto capsule = io::tessellate_capsule(r, 0.7, 1e-4, 1u << 20);
    CHECK(closed(capsule.mesh));
    CHECK(capsule.error <= 1e-4);
    const double whole = std::numbers::pi * r * r * (0.7 + 4 * r / 3);
    CHECK(volume(capsule.mesh) < whole);
    CHECK(volume(capsule.mesh) > 0.9 * whole);
    worst = 0;
    const auto depth = [&](const Eigen::Vector3d& p) {  // how far a point is inside the capsule
      return r - (p - Eigen::Vector3d(0, 0, std::clamp(p.z(), -0.35, 0.35))).norm();
    };
    for (const auto& v : capsule.mesh.vertices) CHECK(std::abs(depth(v)) < 1e-14);
    for (const auto& [a, b, c] : capsule.mesh.triangles) {
      const auto& m = capsule.mesh.vertices;
      for (const Eigen::Vector3d& p : {Eigen::Vector3d((m[a] + m[b]) / 2), Eigen::Vector3d((m[b] + m[c]) / 2),
                                       Eigen::Vector3d((m[c] + m[a]) / 2), Eigen::Vector3d((m[a] + m[b] + m[c]) / 3)})
        worst = std::max(worst, depth(p));
    }
    CHECK(worst <= capsule.error);
    CHECK(worst > 0.8 * capsule.error);
  }
  const auto cuboid = io::tessellate_box({1, 2, 3});
  CHECK(closed(cuboid.mesh));
  CHECK(volume(cuboid.mesh) == Approx(6));
  CHECK(cuboid.error == 0);
}

TEST_CASE("a shape of any size has a bounded number of triangles, and states the error that this costs") {
  for (const double r : {1e-9, 1e-3, 1.0, 1e6})
    for (const std::uint32_t most : {200u, io::most_triangles})
      for (const auto& made : {io::tessellate_sphere(r, 1e-4, most), io::tessellate_cylinder(r, 0.7 * r, 1e-4, most),
                               io::tessellate_capsule(r, 0.7 * r, 1e-4, most)}) {
        INFO(r << " m in at most " << most);
        CHECK(closed(made.mesh));
        CHECK(made.mesh.triangles.size() <= most);
        CHECK(made.error <= 0.15 * r);
        if (most == io::most_triangles) CHECK(made.error < std::max(1.1e-4, 1.5e-3 * r));
      }
  CHECK(io::tessellate_sphere(1).error > 5e-4);  // the bound on the triangles shows
  const robot_folder folder;
  std::string spheres;
  for (int i = 0; i < 300; ++i) spheres += collision("<sphere radius=\"1\"/>");
  const io::robot r = load_robot(folder.put("s.urdf", robot(a_link("a", spheres))));
  CHECK(r.parts()[0].mesh.triangles.size() <= 400'000);  // shared by all
  CHECK(r.parts()[0].tessellation_error == io::tessellate_sphere(1, 1e-4, 400'000 / 300).error);
  const io::robot few = load_robot(folder.put("f.urdf", robot(a_link("a", collision("<sphere radius=\"1\"/>")))));
  CHECK(few.parts()[0].tessellation_error == io::tessellate_sphere(1).error);
  io::robot_options fewer;
  fewer.limits.triangles = 100'000;
  CHECK(says(sentence([&] { load_robot(folder.path / "s.urdf", fewer); }),
             "link \"a\": with it the robot has more than 100000 triangles"));
}

TEST_CASE("a part is all shapes of one link, each at its origin, and links without geometry are none") {
  const robot_folder folder;
  folder.put("m/t.obj", triangle);
  const auto file = folder.put(
      "r.urdf",
      robot(a_link("base") +
            a_link("z_arm", collision(mesh("m/t.obj", "scale=\"2 3 -1\""),
                                      "<origin xyz=\"0 0 5\" rpy=\"0 0 1.5707963267948966\"/>") +
                                collision(box, "<origin xyz=\"10 0 0\"/>") + visual("<sphere radius=\"0.1\"/>")) +
            a_link("a_hand", visual("<cylinder radius=\"0.05\" length=\"0.2\"/>")) + a_link("frame") +
            joint("j", "revolute", "base", "z_arm") + joint("k", "fixed", "z_arm", "a_hand") +
            joint("l", "fixed", "a_hand", "frame")));
  const io::robot r = load_robot(file);
  REQUIRE(r.parts().size() == 2);
  CHECK(r.name() == "r");
  CHECK(r.parts()[0].name == "z_arm");  // the file's order, not the alphabet's
  CHECK(r.parts()[1].name == "a_hand");
  REQUIRE(r.notes().size() == 1);
  CHECK(says(r.notes()[0], "\"a_hand\": has no collision"));
  CHECK(r.parts()[1].used == io::robot_geometry::visual);
  CHECK(r.parts()[0].tessellation_error == 0);
  CHECK(r.parts()[1].tessellation_error > 0);
  CHECK(r.parts()[1].tessellation_error <= 1e-4);

  const triangle_mesh& m = r.parts()[0].mesh;
  REQUIRE(m.triangles.size() == 13);
  const Eigen::Vector3d a = m.vertices[m.triangles[0][0]], b = m.vertices[m.triangles[0][1]],
                        c = m.vertices[m.triangles[0][2]];
  CHECK((a - Eigen::Vector3d(0, 0, 5)).norm() < 1e-12);
  CHECK((b - Eigen::Vector3d(-3, 0, 5)).norm() < 1e-12);  // turned about, because the scale mirrors
  CHECK((c - Eigen::Vector3d(0, 2, 5)).norm() < 1e-12);
  CHECK(m.vertices.back().x() == Approx(10.5));

  io::robot_options visuals;
  visuals.geometry = io::robot_geometry::visual;
  CHECK(load_robot(file, visuals).parts()[0].tessellation_error > 0);
  CHECK(load_robot(file, visuals).notes().empty());
  const io::robot seen = load_robot(folder.put("c.urdf", robot(a_link("l", collision(box)))), visuals);
  CHECK(seen.parts()[0].used == io::robot_geometry::collision);
  REQUIRE(seen.notes().size() == 1);
  CHECK(says(seen.notes()[0], "\"l\": has no visual geometry, and its collision is used"));
  io::robot_options without;
  without.exclude_links = {"a_hand", "frame"};
  CHECK(load_robot(file, without).parts().size() == 1);
  without.exclude_links = {"nothing"};
  CHECK(says(sentence<std::invalid_argument>([&] { load_robot(file, without); }), "\"nothing\""));
  without.exclude_links = {"a_hand", "z_arm"};
  CHECK(says(sentence([&] { load_robot(file, without); }), "no link that is not excluded"));
  // Frames without geometry have poses too.
  CHECK(r.link_pose("frame", r.kinematics().rest()).isApprox(Eigen::Isometry3d::Identity()));
}

TEST_CASE("a description's text is the robot of its file, and its meshes are found beside a file that need not exist") {
  const robot_folder folder;
  folder.put("m/t.obj", triangle);
  const std::string text =
      robot(a_link("base") + a_link("arm", collision(mesh("m/t.obj"))) + joint("j", "revolute", "base", "arm"));
  const io::robot of_file = load_robot(folder.put("r.urdf", text));
  const io::robot of_text = io::load_robot_text(text, folder.path / "no_such_file");
  REQUIRE(of_text.parts().size() == 1);
  CHECK(of_text.name() == of_file.name());
  CHECK(of_text.parts()[0].mesh.vertices == of_file.parts()[0].mesh.vertices);
  CHECK(of_text.kinematics().movable(0).name == "j");
  CHECK(says(sentence([&] { io::load_robot_text("<robot", folder.path / "the text"); }), "the text"));
  CHECK(says(sentence([&] { io::load_robot_text(text, "elsewhere/r.urdf"); }), "t.obj"));
  io::robot_options short_text;
  short_text.limits.bytes = 20;
  CHECK(says(sentence([&] { io::load_robot_text(text, folder.path / "r", short_text); }), "limit of 20 bytes"));
}

TEST_CASE("joints keep the file's order, whatever else is called joint, and mimic and limits come from the file") {
  const robot_folder folder;
  const auto file = folder.put(
      "r.urdf",
      robot(a_link("b", collision(box)) + a_link("l1") + a_link("l2") + a_link("l3") + a_link("l4") + "<!-- " +
            joint("a", "revolute", "b", "l1") + " -->" + "<transmission name=\"t\"><joint name=\"c\"/></transmission>" +
            joint("z", "prismatic", "b", "l1",
                  "<axis xyz=\"0 2 0\"/><limit lower=\"0.5\" upper=\"1\" effort=\"1\" velocity=\"1\"/>") +
            joint("m", "revolute", "l1", "l2",
                  "<mimic joint=\"c\" multiplier=\"2\" offset=\"0.5\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" "
                  "velocity=\"1\"/>") +
            joint("c", "continuous", "l2", "l3", "<origin xyz=\"1 0 0\" rpy=\"0.1 0.2 0.3\"/>") +
            joint("a", "revolute", "l3", "l4")));
  const io::robot r = load_robot(file);
  REQUIRE(r.kinematics().size() == 3);
  CHECK(r.kinematics().movable(0).name == "z");
  CHECK(r.kinematics().movable(1).name == "c");
  CHECK(r.kinematics().movable(2).name == "a");
  CHECK(r.kinematics().rest() == std::vector<double>{0.5, 0, 0});
  const auto q = r.kinematics().configuration({{"c", 0.25}});
  CHECK(r.link_pose("l1", q).translation().isApprox(Eigen::Vector3d(0, 0.5, 0)));
  CHECK(r.link_pose("l2", q).linear().isApprox(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX()).toRotationMatrix()));
  // Fixed axes: roll about x first, then pitch about y, then yaw about z.
  const Eigen::Matrix3d rpy =
      (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  CHECK(r.kinematics().movable(1).origin.linear().isApprox(rpy, 1e-14));
  CHECK(says(sentence<std::invalid_argument>([&] { r.kinematics().configuration({{"m", 0}}); }), "follows \"c\""));
  CHECK(says(sentence<std::invalid_argument>([&] { r.poses(std::vector<double>{0, 0, 0}); }), "\"z\""));
  CHECK(r.poses(std::vector<double>{0, 0, 0}, {.ignore_limits = true}).size() == 1);
}

TEST_CASE("Who waits for spheres is told whose they are: a link by its name, or how many") {
  const triangle_mesh cube = io::tessellate_box({1, 1, 1}).mesh;
  const triangle_mesh bar = io::tessellate_box({1, 1, 3}).mesh;
  std::vector<io::body_source> sources{{"hand", &cube}, {"arm", &bar}};
  for (const auto& [links, what] : {std::pair{2, "2 links"}, std::pair{1, "hand"}}) {
    sources.resize(std::size_t(links));
    std::vector<std::string> said;
    io::body_options how;
    how.pack.count = 200;
    how.pack.threads = 1;  // one after another
    how.doing = [&](const std::string& now) { said.push_back(now); };
    io::body_account account;
    io::make_bodies(sources, how, account);
    CHECK(said.front() == std::string("closing ") + what);
    CHECK(std::ranges::any_of(
        said, [&](const std::string& s) { return s.starts_with(std::string("packing ") + what + ": "); }));
    if (links == 1) continue;
    const auto first =
        std::ranges::find_if(said, [](const auto& s) { return s.starts_with("packing 2 links: 1 done"); });
    REQUIRE(first != said.end());
    CHECK(*first == "packing 2 links: 1 done, 200/400 spheres");
  }
}

TEST_CASE("package names are looked up where given, then above the URDF, then in the environment") {
  const robot_folder folder;
  const auto urdf = [&](const std::string& where, const std::string& uri) {
    return folder.put(where, robot(a_link("b", collision(mesh(uri)))));
  };
  const auto corner = [&](const std::filesystem::path& file, const io::robot_options& options = {}) {
    return load_robot(file, options).parts().at(0).mesh.vertices.at(1).x();
  };
  const auto sized = [](int n) { return "v 0 0 0\nv " + std::to_string(n) + " 0 0\nv 0 1 0\nf 1 2 3\n"; };
  const auto file = urdf("ws/alpha/urdf/r.urdf", "package://alpha/meshes/t.obj");
  CHECK(says(sentence([&] { load_robot(file); }), "no such file"));  // the folder is there, the mesh is not
  folder.put("ws/alpha/meshes/t.obj", sized(1));
  folder.put("given/meshes/t.obj", sized(2));
  CHECK(corner(file) == 1);
  io::robot_options options;
  options.packages["alpha"] = folder.path / "given";
  CHECK(corner(file, options) == 2);

  folder.put("ws/other_name/package.xml", "<package format=\"2\">\n <name> beta </name></package>");
  folder.put("ws/other_name/t.obj", sized(3));
  CHECK(corner(urdf("ws/other_name/urdf/deep/r.urdf", "package://beta/t.obj")) == 3);

  folder.put("ws/beside/t.obj", sized(6));
  CHECK(corner(urdf("ws/alpha/urdf/beside.urdf", "package://beside/t.obj")) == 6);

  const auto gamma = urdf("x/r.urdf", "package://gamma/t.obj");
  CHECK(says(sentence([&] { load_robot(gamma); }), "--package gamma="));
  folder.put("prefix/share/gamma/t.obj", sized(5));
  ::setenv("AMENT_PREFIX_PATH", (std::string("/nowhere:") + (folder.path / "prefix").string()).c_str(), 1);
  CHECK(corner(gamma) == 5);
  folder.put("ros/gamma/t.obj", sized(4));
  ::setenv("ROS_PACKAGE_PATH", (folder.path / "ros").string().c_str(), 1);
  CHECK(corner(gamma) == 4);
  ::unsetenv("ROS_PACKAGE_PATH");
  ::unsetenv("AMENT_PREFIX_PATH");

  CHECK(corner(urdf("ws/alpha/urdf/r.urdf", "package:///alpha/meshes/t.obj")) == 1);
  CHECK(corner(urdf("ws/alpha/urdf/r.urdf", "model://alpha/meshes/t.obj")) == 1);
  CHECK(says(sentence([&] { load_robot(urdf("ws/tau/urdf/r.urdf", "package://tau_description/meshes/u.obj")); }),
             "--package tau_description=FOLDER"));
  folder.put("ws/tau/meshes/u.obj", triangle);
  CHECK(says(sentence([&] { load_robot(folder.path / "ws/tau/urdf/r.urdf"); }),
             "--package tau_description=" + (folder.path / "ws/tau").string() + " would do"));
  CHECK(corner(urdf("x/f.urdf", "file://" + (folder.path / "ros/gamma/t.obj").string())) == 4);
  CHECK(corner(urdf("x/g.urdf", "file://../ros/gamma/t.obj")) == 4);  // no URL, and still plain
  CHECK(corner(urdf("x/a.urdf", (folder.path / "ros/gamma/t.obj").string())) == 4);
  CHECK(corner(urdf("x/p.urdf", "../ros/gamma/t.obj")) == 4);
  CHECK(says(sentence([&] { load_robot(urdf("x/h.urdf", "http://example.org/t.obj")); }), "http://"));
  CHECK(says(sentence([&] { load_robot(urdf("x/e.urdf", "package://gamma")); }), "names no file"));
  CHECK_FALSE(sentence([&] { load_robot(urdf("x/n.urdf", "")); }).empty());
}

TEST_CASE("a bad robot file is refused in one sentence with its name") {
  const robot_folder folder;
  folder.put("t.obj", triangle);
  const auto refusal = [&](const std::string& text) {
    const auto file = folder.put("r.urdf", text);
    const std::string said = sentence([&] { load_robot(file); });
    INFO(said);
    CHECK(says(said, "r.urdf"));
    CHECK(said.find('\n') == said.npos);
    return said;
  };
  const std::string good = robot(a_link("a", collision(box)) + a_link("b") + joint("j", "revolute", "a", "b"));
  CHECK(load_robot(folder.put("g.urdf", good)).parts().size() == 1);
  CHECK(says(sentence([&] { load_robot(folder.path / "none.urdf"); }), "no such file"));
  CHECK(says(refusal(""), "0 bytes"));
  CHECK_FALSE(refusal("rubbish").empty());
  CHECK_FALSE(refusal("<a/>").empty());
  CHECK_FALSE(refusal(std::string("<robot name=\"r\">\0</robot>", 25)).empty());
  for (std::size_t cut = 30; cut + 12 < good.size(); cut += 7) CHECK_FALSE(refusal(good.substr(0, cut)).empty());
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  CHECK(says(refusal("<robot name=\"r\">" + deep), "elements inside one another"));
  CHECK(says(refusal(robot("")), "no link"));
  CHECK(says(refusal(robot(a_link("a"))), "no link has geometry"));
  CHECK(says(refusal(robot(a_link("a", collision(box)) + "<xacro:arm/>")), "expand it with xacro"));
  CHECK_FALSE(refusal(robot(a_link("a", collision(box)) + a_link("a"))).empty());
  CHECK_FALSE(refusal(robot(a_link("a", collision(box)) + a_link("b"))).empty());
  CHECK_FALSE(refusal(robot(a_link("a", collision(box)) + joint("j", "fixed", "a", "b"))).empty());
  CHECK(says(refusal(robot(a_link("a", collision(box)) + a_link("b") + a_link("c") + joint("j", "fixed", "b", "c") +
                           joint("k", "fixed", "c", "b"))),
             "ring"));
  CHECK_FALSE(refusal(robot(a_link("a", collision(box)) + a_link("b") + joint("j", "helical", "a", "b"))).empty());
  CHECK_FALSE(refusal(robot(a_link("a", collision(box)) + a_link("b") + joint("j", "revolute", "a", "b", ""))).empty());
  CHECK_FALSE(refusal(robot(a_link("a", collision(box)) + a_link("b") +
                            joint("j", "fixed", "a", "b", "<origin xyz=\"nan 0 0\"/>")))
                  .empty());
  CHECK_FALSE(refusal(robot(a_link("a", collision(box, "<origin xyz=\"0 1e999 0\"/>")))).empty());
  CHECK_FALSE(refusal(robot(a_link("a", collision(box, "<origin xyz=\"0 0\"/>")))).empty());
  CHECK_FALSE(refusal(robot(a_link("a", "<collision/>"))).empty());
  CHECK(says(refusal(robot(a_link("a", collision("<box size=\"1 -1 1\"/>")))), "side below 0"));
  CHECK(says(refusal(robot(a_link("a", collision("<sphere radius=\"-1\"/>")))), "radius below 0"));
  CHECK(says(refusal(robot(a_link("a", collision("<cylinder radius=\"1\" length=\"-1e-9\"/>")))), "length below 0"));
  CHECK(says(refusal(robot(a_link("a", collision(mesh("t.obj", "scale=\"1 0 1\""))))), "scale"));
  CHECK(says(sentence([&] { load_robot(folder.put("r.urdf", robot(a_link("a", collision(mesh("gone.stl")))))); }),
             "gone.stl"));
}

TEST_CASE("real robots have the parts, triangles and height that their source states", "[data]") {
  const std::filesystem::path folder = testing::data("/robots");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  struct expected {
    const char* file;
    std::size_t parts, joints, collision, visual;
    double height;
  };
  for (const auto& e :
       {expected{"kuka_lwr_kresse/kuka.urdf", 8, 7, 668, 8942, 1.178},
        expected{"kuka_lwr4plus_cad/kuka_lwr4plus.urdf", 8, 7, 2769, 23104, 1.179},
        expected{"ur5e/ur5e.urdf", 7, 6, 7558, 7558, 0}, expected{"jvrc1/jvrc1.urdf", 35, 44, 4164, 8759, 1.711}}) {
    INFO(e.file);
    for (const auto geometry : {io::robot_geometry::collision, io::robot_geometry::visual}) {
      io::robot_options options;
      options.geometry = geometry;
      const io::robot r = load_robot(folder / e.file, options);
      CHECK(r.parts().size() == e.parts);
      CHECK(r.kinematics().size() == e.joints);
      CHECK(r.notes().empty());
      std::size_t triangles = 0;
      double low = 1e9, high = -1e9;
      const auto poses = r.poses(r.kinematics().rest());
      for (std::size_t i = 0; i < r.parts().size(); ++i) {
        triangles += r.parts()[i].mesh.triangles.size();
        for (const auto& v : r.parts()[i].mesh.vertices) {
          low = std::min(low, (poses[i] * v).z());
          high = std::max(high, (poses[i] * v).z());
        }
      }
      CHECK(triangles == (geometry == io::robot_geometry::visual ? e.visual : e.collision));
      if (e.height > 0 && geometry == io::robot_geometry::visual) CHECK(high - low == Approx(e.height).margin(6e-4));
    }
  }
}

TEST_CASE("the UR5e's hand is where its maker's Denavit-Hartenberg table puts it", "[data]") {
  const std::filesystem::path file = testing::data("/robots/ur5e/ur5e.urdf");
  if (!std::filesystem::exists(file)) {
    WARN("SKIPPED: no file " << file);
    return;
  }
  const io::robot r = load_robot(file);
  const double half = std::numbers::pi / 2;
  const double a[6] = {0, -0.425, -0.3922, 0, 0, 0}, d[6] = {0.1625, 0, 0, 0.1333, 0.0997, 0.0996},
               alpha[6] = {half, 0, 0, half, -half, 0};
  for (const double scale : {0.0, 0.3, -1.1}) {
    const std::vector<double> q{scale, 2 * scale, -scale, 0.5 * scale, 1.5 * scale, -2 * scale};
    // The maker's base frame is turned by half a turn against the description's.
    Eigen::Isometry3d hand(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
    for (std::size_t i = 0; i < 6; ++i) {
      Eigen::Matrix4d m;
      m << std::cos(q[i]), -std::sin(q[i]) * std::cos(alpha[i]), std::sin(q[i]) * std::sin(alpha[i]),
          a[i] * std::cos(q[i]), std::sin(q[i]), std::cos(q[i]) * std::cos(alpha[i]),
          -std::cos(q[i]) * std::sin(alpha[i]), a[i] * std::sin(q[i]), 0, std::sin(alpha[i]), std::cos(alpha[i]), d[i],
          0, 0, 0, 1;
      hand.matrix() *= m;
    }
    CHECK((r.link_pose("wrist_3_link", q).matrix() - hand.matrix()).cwiseAbs().maxCoeff() < 1e-8);
  }
}

}  // namespace robot_test

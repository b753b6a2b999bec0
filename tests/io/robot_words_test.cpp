// SPDX-License-Identifier: BSD-3-Clause
#include "io/damage.hpp"

#include <clearance/io/robot.hpp>

#include <sstream>

namespace robot_words_test {

using namespace clearance;

namespace {

const std::string box = "<geometry><box size=\"1 1 1\"/></geometry>";

struct words_robot {
  robot_folder folder;

  io::robot load(const std::string& text, bool strict = false) const {
    io::robot_options options;
    options.strict = strict;
    return io::load_robot(folder.put("r.urdf", text), options);
  }
  std::string refusal(const std::string& text, bool strict = false) const {
    return sentence([&] { load(text, strict); });
  }
};

/// A whole robot with a hole in each kind of element: `at` says in which to put `what`, which is an element or `
/// an="attribute"`.
std::string with(const std::string& at, const std::string& what) {
  const bool child = what.starts_with("<") || !what.starts_with(" ");
  const auto open = [&](const std::string& name, const std::string& attributes, const std::string& inside) {
    const bool here = name == at;
    return "<" + name + attributes + (here && !child ? what : "") + ">" + inside + (here && child ? what : "") + "</" +
           name + ">";
  };
  const std::string shape =
      open("origin", " xyz=\"0.1 0 0\" rpy=\"0 0.1 0\"", "") + open("geometry", "", open("box", " size=\"1 2 3\"", ""));
  return open(
      "robot", " name=\"r\"",
      open("link", " name=\"a\"", open("collision", "", shape) + (at == "visual" ? open("visual", "", shape) : "")) +
          "<link name=\"b\"><collision><geometry>" + open("sphere", " radius=\"0.1\"", "") +
          "</geometry></collision></link>" +
          open("joint", " name=\"j\" type=\"revolute\"",
               open("parent", " link=\"a\"", "") + open("child", " link=\"b\"", "") +
                   open("axis", " xyz=\"0 1 0\"", "") + open("limit", " lower=\"-1\" upper=\"1\"", "")));
}

std::string all_of(const io::robot& r) {
  std::ostringstream out;
  for (const auto& part : r.parts()) {
    out << part.name << ' ' << part.tessellation_error;
    for (const auto& v : part.mesh.vertices) out << ' ' << v.transpose();
  }
  for (const auto& pose : r.poses(std::vector<double>(r.kinematics().size(), 0.5))) out << pose.matrix();
  return out.str();
}

const std::vector<std::string> places = {"robot",  "link",  "visual", "collision", "geometry", "box",  "sphere",
                                         "origin", "joint", "parent", "child",     "axis",     "limit"};

}  // namespace

TEST_CASE(
    "what URDF does not define and cannot change the answer is passed over with a note, and --strict refuses it") {
  const words_robot read;
  for (const std::string& at : places) {
    const std::string plain = all_of(read.load(with(at, "")));
    for (const std::string what :
         {"<controller_gains p=\"1\"/>", "<traits><x y=\"2\"/></traits>", "<gravity>0</gravity>", "<kinematic/>",
          "<anchor x=\"1\"/>", "<u:thing/>", " command_effort=\"1\"", " dont_collapse=\"true\"", " u:power_on=\"1\""}) {
      INFO(what << " in " << at);
      const io::robot made = read.load(with(at, what));
      CHECK(all_of(made) == plain);
      REQUIRE(made.notes().size() == 1);
      CHECK(says(made.notes()[0], "passed over"));
      check_sentence(read.refusal(with(at, what), true), (read.folder.path / "r.urdf").string());
    }
    CHECK(read.load(with(at, ""), true).notes().empty());
  }
  for (const auto& [at, what] : std::vector<std::pair<std::string, std::string>>{
           {"link", "<self_filter/>"},
           {"link", "<collision_checking/>"},
           {"link", "<self_collision_checking><origin/>" + box + "</self_collision_checking>"},
           {"link", "<origin xyz=\"1 2 3\"/>"},
           {"axis", " rpy=\"0 0 0\""},
           {"joint", "a remark"},
           {"link", "# z = 5 > 4"},
           {"link", "<collision_margin value=\"1\"/>"},
           {"robot", "<thing><joint name=\"j\"/></thing>"},
           {"robot", "<frame link=\"a\" xyz=\"1 2 3\"/>"},
           {"geometry", "<material/>"},
           {"collision", "<surface><friction/></surface>"},
           {"link", "<self_filter><collision_sphere radius=\"1\"/></self_filter>"}}) {
    INFO(what << " in " << at);
    const io::robot made = read.load(with(at, what));
    CHECK(all_of(made) == all_of(read.load(with(at, ""))));
    CHECK(made.notes().size() == 1);
    CHECK_FALSE(read.refusal(with(at, what), true).empty());
  }
}

TEST_CASE("geometry in an element that URDF does not define is noted as not used") {
  const words_robot read;
  for (const std::string at : {"robot", "link", "collision", "joint"})
    for (const std::string& inside :
         {"<collision>" + box + "</collision>", box, std::string("<u:mesh filename=\"x.stl\"/>")}) {
      INFO(inside << " in " << at);
      const io::robot made = read.load(with(at, "<foo><bar>" + inside + "</bar></foo>"));
      CHECK(all_of(made) == all_of(read.load(with(at, ""))));
      REQUIRE(made.notes().size() == 1);
      CHECK(says(made.notes()[0], "the geometry in it is not used"));
    }
}

TEST_CASE("what may be a misspelt word that matters is refused, wherever it stands") {
  const words_robot read;
  const auto refused = [&](const std::string& at, const std::string& what) {
    const std::string said = read.refusal(with(at, what));
    INFO(what << " in " << at << ": " << said);
    CHECK_FALSE(said.empty());
    check_sentence(said, (read.folder.path / "r.urdf").string());
  };
  for (const std::string name :
       {"colision", "Collision", "COLLISION", "collisions", "collison", "visul", "Visual", "visuals", "geometery",
        "Geometry", "u:collision", "u:visual", "undeclared:geometry", "col:lision"})
    for (const std::string at : {"link", "collision", "robot", "joint"})
      for (const std::string& inside : {box, std::string()}) refused(at, "<" + name + ">" + inside + "</" + name + ">");
  for (const std::string name : {"my_collision", "collision_1", "visual_geometry", "VisualMesh", "extra.geometry"})
    for (const std::string at : {"link", "robot"}) refused(at, "<" + name + ">" + box + "</" + name + ">");
  for (const std::string what : {" xzy=\"1 0 0\"", " rpi=\"1 0 0\"", " XYZ=\"1 0 0\"", " xyz_mm=\"1 0 0\"",
                                 " quat_xyzw=\"0 0 0 1\"", " u:xyz=\"1 2 3\"", " x=\"1\"", "<xyz>1 2 3</xyz>", "1 2 3"})
    refused("origin", what);
  refused("box", " sise=\"2 2 2\""), refused("box", " Size=\"2 2 2\""), refused("sphere", " raduis=\"2\""),
      refused("sphere", "<radius>2</radius>");
  refused("limit", " uper=\"2\""), refused("axis", " xzy=\"0 0 1\""), refused("axis", "0 0 1");
  refused("joint", "<orign xyz=\"1 0 0\"/>"), refused("joint", "<mimick joint=\"x\"/>"), refused("joint", "<pose/>"),
      refused("collision", "<transform/>");
  refused("geometry", "<origin xyz=\"1 0 0\"/>"), refused("geometry", "<Sphere radius=\"1\"/>");
  refused("robot", "<lnk name=\"c\"/>"), refused("robot", "<u:joint name=\"c\"/>"),
      refused("robot", "<include filename=\"x.urdf\"/>"), refused("robot", "<xi:include href=\"x\"/>");
  refused("robot", "<group><link name=\"c\"/></group>");
  refused("collision", "origin xyz=\"1 0 0\"/>"), refused("link", "!-- <collision/> --");
  for (const std::string known : {"inertial", "contact", "sensor", "self_filter", "self_collision_checking"})
    refused("link", "<" + known + "><collision>" + box + "</collision></" + known + ">");
}

TEST_CASE("a word of sizes is refused wherever it stands, as attribute and as element") {
  const words_robot read;
  for (const std::string& at : places)
    for (const std::string word : {"scale", "Scale", "scaling", "unit", "units", "offset", "u:scale"}) {
      INFO(word << " in " << at);
      check_sentence(read.refusal(with(at, " " + word + "=\"0.001\"")), (read.folder.path / "r.urdf").string());
      CHECK_FALSE(read.refusal(with(at, "<" + word + " value=\"2\"/>")).empty());
    }
}

TEST_CASE("xacro is known by its namespace, whatever the prefix") {
  const words_robot read;
  const std::string link = "<link name=\"a\"><collision>" + box + "</collision></link>";
  for (const std::string uri :
       {"http://www.ros.org/wiki/xacro", "http://wiki.ros.org/xacro", "http://ros.org/wiki/xacro#interface"}) {
    CHECK(says(read.refusal("<robot name=\"r\" xmlns:x=\"" + uri + "\">" + link + "<x:arm/></robot>"),
               "expand it with xacro"));
    CHECK(says(read.refusal("<robot name=\"r\">" + link + "<gazebo><x:arm xmlns:x=\"" + uri + "\"/></gazebo></robot>"),
               "expand it with xacro"));
    CHECK(read.refusal("<robot name=\"r\" xmlns:x=\"" + uri + "\">" + link + "</robot>").empty());
  }
  CHECK(says(read.refusal("<robot name=\"r\">" + link + "<xacro:arm/></robot>"), "expand it with xacro"));
}

TEST_CASE("notes are one sentence a kind, with a count, however many links there are") {
  const words_robot read;
  std::string links, joints;
  for (int i = 0; i < 200; ++i) {
    const std::string name = "l" + std::to_string(i);
    links += "<link name=\"" + name + "\"><visual>" + box + "</visual><controller_gains/></link>";
    if (i > 0)
      joints += "<joint name=\"j" + name + "\" type=\"fixed\" dont_collapse=\"1\"><parent link=\"l0\"/><child link=\"" +
                name + "\"/></joint>";
  }
  const auto notes = read.load("<robot name=\"r\">" + links + joints + "</robot>").notes();
  REQUIRE(notes.size() == 3);
  CHECK(says(notes[0], "(200 times)"));
  CHECK(says(notes[0], "\"l0\", link \"l1\", link \"l2\", ..."));
  CHECK(says(notes[1], "(199 times)"));
  CHECK(says(notes[2], "has no collision geometry, and its visual is used (200 times)"));
  std::string kinds;
  for (int i = 0; i < 10'000; ++i) kinds += "<k" + std::to_string(i) + "/>";
  const auto many =
      read.load("<robot name=\"r\"><link name=\"a\"><visual>" + box + "</visual></link>" + kinds + "</robot>").notes();
  CHECK(many.size() == 51);
  CHECK(says(many.back(), "9951 more"));
  for (const auto& note : many) CHECK(note.size() <= 400);
}

TEST_CASE(
    "a shape without volume is a point, a segment or a plate: a solid that contains it and states how much larger it "
    "is") {
  const words_robot read;
  const auto part = [&](const std::string& shape) {
    const io::robot made = read.load("<robot name=\"r\"><link name=\"a\"><collision><geometry>" + shape +
                                     "</geometry></collision></link></robot>");
    CHECK(made.notes().size() == 1);
    CHECK(says(made.notes()[0], "without volume"));
    return made.parts().at(0);
  };
  struct expected {
    std::string shape;
    Eigen::Vector3d reach;  // from the origin, along the axes
  };
  for (const auto& e :
       {expected{"<box size=\"0 0 0\"/>", {0, 0, 0}}, expected{"<box size=\"0 0 0.5\"/>", {0, 0, 0.25}},
        expected{"<box size=\"0.5 0 2\"/>", {0.25, 0, 1}}, expected{"<sphere radius=\"0\"/>", {0, 0, 0}},
        expected{"<cylinder radius=\"0\" length=\"1\"/>", {0, 0, 0.5}},
        expected{"<cylinder radius=\"0.5\" length=\"0\"/>", {0.5, 0.5, 0}},
        expected{"<cylinder radius=\"0\" length=\"0\"/>", {0, 0, 0}},
        expected{"<capsule radius=\"0\" length=\"1\"/>", {0, 0, 0.5}}}) {
    INFO(e.shape);
    const io::robot_part made = part(e.shape);
    const bool round = e.shape.find("0.5\" length") != e.shape.npos;
    CHECK(made.tessellation_error > 0);
    CHECK(made.tessellation_error < (round ? 1.1e-4 : 2e-6));
    Eigen::Vector3d most = Eigen::Vector3d::Zero();
    for (const auto& v : made.mesh.vertices) most = most.cwiseMax(v.cwiseAbs());
    for (int k = 0; k < 3; ++k) {
      CHECK(most[k] <= e.reach[k] + made.tessellation_error);
      CHECK(most[k] >= e.reach[k] - made.tessellation_error);
    }
  }
  CHECK(read.load("<robot name=\"r\"><link name=\"a\"><collision><geometry><capsule radius=\"0.1\" "
                  "length=\"0\"/></geometry></collision></link></robot>")
            .notes()
            .empty());
  for (const char* bad : {"<box size=\"0 -1 0\"/>", "<sphere radius=\"-0.1\"/>",
                          "<cylinder radius=\"0\" length=\"-1\"/>", "<capsule radius=\"-1\" length=\"0\"/>"})
    CHECK(says(read.refusal("<robot name=\"r\"><link name=\"a\"><collision><geometry>" + std::string(bad) +
                            "</geometry></collision></link></robot>"),
               "below 0"));
}

TEST_CASE(
    "a joint that follows one of another file moves by itself, with a note; a misspelt name of one here is refused") {
  const words_robot read;
  const auto text = [](const std::string& leader) {
    return "<robot name=\"r\"><link name=\"a\"><collision>" + box +
           "</collision></link><link name=\"b\"/><link name=\"c\"/>"
           "<joint name=\"turn\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint>"
           "<joint name=\"follow\" type=\"continuous\"><parent link=\"b\"/><child link=\"c\"/><mimic joint=\"" +
           leader + "\"/></joint></robot>";
  };
  CHECK(read.load(text("turn")).kinematics().size() == 1);
  CHECK(read.load(text("turn")).notes().empty());
  const io::robot made = read.load(text("index_q1"));
  CHECK(made.kinematics().size() == 2);
  REQUIRE(made.notes().size() == 1);
  CHECK(says(made.notes()[0], "joint \"follow\": follows a joint that is not in this file"));
  CHECK(says(read.refusal(text("turm")), "\"turn\"?"));
  CHECK(says(read.refusal(text("index_q1"), true), "\"follow\""));
}

TEST_CASE("what is there twice is refused, or noted if it is the same both times") {
  const words_robot read;
  for (const auto& [at, first, second] : {std::tuple{"joint", "<origin xyz=\"1 0 0\"/>", "<origin xyz=\"1 0 0.1\"/>"},
                                          {"joint", "<mimic joint=\"x\"/>", "<mimic joint=\"y\"/>"}}) {
    CHECK(says(read.refusal(with(at, first + std::string(second))), "is there twice"));
    const io::robot made = read.load(with(at, first + std::string(first)));
    CHECK(all_of(made) == all_of(read.load(with(at, first))));
    CHECK(says(made.notes()[0], "is there twice, the same both times"));
  }
  CHECK(says(read.refusal(with("joint", "<axis xyz=\"0 0 1\"/>")), "is there twice"));
  CHECK(says(read.refusal(with("joint", "<limit lower=\"-1\" upper=\"2\"/>")), "is there twice"));
}

TEST_CASE("ways that cancel are refused where double loses more of them than a bracket covers") {
  const words_robot read;
  const auto chain = [&](const std::string& there, const std::string& back, const std::string& kind = "fixed") {
    return read.load("<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"><collision>" + box +
                     "</collision></link>"
                     "<joint name=\"there\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/><origin xyz=\"" +
                     there +
                     "\"/></joint>"
                     "<joint name=\"back\" type=\"" +
                     kind + "\"><parent link=\"b\"/><child link=\"c\"/><origin xyz=\"" + back +
                     "\"/>"
                     "<limit lower=\"-1e300\" upper=\"1e300\"/></joint></robot>");
  };
  CHECK(says(sentence<std::invalid_argument>([&] { chain("1e13 0 0", "-1e13 0 0").poses({}); }),
             "joint \"back\" puts its link there by ways that cancel"));
  CHECK(says(sentence<std::invalid_argument>([&] { chain("0 1e9 0", "0 -1e9 0").poses({}); }), "ways that cancel"));
  const io::robot slides = chain("1e12 0 0", "0 0 0", "prismatic");
  CHECK(slides.poses(std::vector<double>{1}).size() == 1);
  CHECK(says(sentence<std::invalid_argument>([&] { slides.poses(std::vector<double>{-1e12}); }), "ways that cancel"));
  for (const char* real : {"100 0 0", "5e6 4e6 0", "1e13 0 0"}) CHECK(chain(real, "0.3 0 1").poses({}).size() == 1);
  CHECK(chain("1000 0 0", "-1000 0 0").poses({}).size() == 1);
  const Eigen::Isometry3d far(Eigen::Translation3d(1e13, 0, 0)), back(Eigen::Translation3d(-1e13, 0, 0));
  CHECK(says(sentence<std::invalid_argument>([&] { io::carried(far, back, "link \"a\""); }), "link \"a\""));
  CHECK(io::carried(far, Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0)), "x").translation().x() == 1e13 + 1);
}

}  // namespace robot_words_test

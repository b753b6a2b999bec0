// SPDX-License-Identifier: BSD-3-Clause
// Joints of several degrees of freedom, the link "world", and joints that follow others too far.
#include "io/robot_folder.hpp"
#include "support/catch.hpp"

#include <clearance/io/joint_chain.hpp>
#include <clearance/io/robot.hpp>

#include <random>

namespace free_joints_test {

using namespace clearance;

namespace {

const std::string box = "<collision><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision>";

std::string link(const std::string& name, const std::string& inside = box) {
  return "<link name=\"" + name + "\">" + inside + "</link>\n";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type +
         "\"><origin xyz=\"0.1 0.2 0.3\" rpy=\"0.1 0.2 0.3\"/><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + more + "</joint>\n";
}

struct scene {
  robot_folder folder;
  io::robot load(const std::string& inside) const {
    return io::load_robot(folder.put("r.urdf", "<robot name=\"r\">\n" + inside + "</robot>"));
  }
  std::string refusal(const std::string& inside) const {
    return sentence([&] { load(inside); });
  }
};

std::string all(const io::robot& r) {
  std::string text;
  for (const auto& note : r.notes()) text += note + '\n';
  return text;
}

/// The origin of every joint here.
Eigen::Isometry3d origin() {
  Eigen::Isometry3d made = Eigen::Isometry3d::Identity();
  made.translate(Eigen::Vector3d(0.1, 0.2, 0.3));
  made.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
  return made;
}

}  // namespace

TEST_CASE("A floating or planar joint that carries the whole robot is the base pose, with a note") {
  const scene here;
  for (const std::string type : {"floating", "planar"})
    for (const std::string& world : {link("world", ""), std::string()}) {
      const io::robot r = here.load(world + link("a") + link("b") + joint("root", type, "world", "a") +
                                    joint("j", "continuous", "a", "b"));
      INFO(all(r));
      CHECK(r.kinematics().size() == 1);
      CHECK(r.parts().size() == 2);
      CHECK(r.link_pose("a", std::vector<double>{0}).isApprox(origin(), 1e-15));
      CHECK(says(all(r), "joint \"root\": is " + type + " and carries the whole robot"));
      CHECK(says(all(r), "--base-pose"));
      CHECK(says(all(r), "link \"world\": is the parent of a joint and not in this file") == world.empty());
    }
}

TEST_CASE("A floating joint elsewhere moves by six joints, which turn as rpy does, and says so") {
  const scene here;
  const std::string floats = joint("f", "floating", "a", "b");
  for (const std::string& text :
       {link("a") + link("b") + floats,                                                  // its parent has a shape
        link("a", "") + link("b") + link("c") + floats + joint("k", "fixed", "a", "c"),  // ... or other children
        link("base", "") + link("a", "") + link("b") + joint("k", "fixed", "base", "a") + floats}) {  // ... or a parent
    const io::robot r = here.load(text);
    INFO(all(r));
    CHECK(says(all(r),
               "joint \"f\": is floating, and moves by the joints NAME/x, NAME/y, NAME/z (m), NAME/yaw, NAME/pitch, "
               "NAME/roll (rad), which are at 0 unless given"));
    const auto& tree = r.kinematics();
    REQUIRE(tree.size() == 6);
    const Eigen::Isometry3d above = r.link_pose("a", tree.rest());
    CHECK(r.link_pose("b", tree.rest()).isApprox(above * origin(), 1e-12));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-3, 3);
    for (int run = 0; run < 50; ++run) {
      const double x = any(random), y = any(random), z = any(random), roll = any(random), pitch = any(random),
                   yaw = any(random);
      Eigen::Isometry3d wanted = above * origin();
      wanted.translate(Eigen::Vector3d(x, y, z));
      wanted.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
      const auto q = tree.configuration(
          {{"f/x", x}, {"f/y", y}, {"f/z", z}, {"f/roll", roll}, {"f/pitch", pitch}, {"f/yaw", yaw}});
      CHECK(r.link_pose("b", q).isApprox(wanted, 1e-12));
      const auto chained = io::joint_chain_of(r).poses(q);
      for (std::size_t k = 0; k < r.parts().size(); ++k) CHECK(chained[k].isApprox(r.poses(q)[k], 1e-12));
    }
    for (const auto& part : r.parts()) CHECK(!says(part.name, "/"));
    CHECK(sentence<std::invalid_argument>([&] { tree.configuration({{"f", 1}}); }) ==
          "joint \"f\" has several values: \"f/pitch\", \"f/roll\", \"f/x\", \"f/y\", \"f/yaw\", \"f/z\"");
  }
}

TEST_CASE("A planar joint elsewhere slides across its axis and turns about it, and an oblique one says what to do") {
  const scene here;
  const std::pair<std::string, std::string> axes[] = {{"<axis xyz=\"0 0 1\"/>", "xy"},
                                                      {"<axis xyz=\"0 0 -2\"/>", "xy"},
                                                      {"<axis xyz=\"0 1 0\"/>", "xz"},
                                                      {"<axis xyz=\"1 0 0\"/>", "yz"},
                                                      {"", "yz"}};
  for (const auto& [axis, across] : axes) {
    const io::robot r = here.load(link("a") + link("b") + joint("p", "planar", "a", "b", axis));
    INFO(axis << all(r));
    REQUIRE(r.kinematics().size() == 3);
    const std::string one = "p/" + across.substr(0, 1), two = "p/" + across.substr(1);
    CHECK(says(all(r), "NAME/" + across.substr(0, 1) + ", NAME/" + across.substr(1) + " (m), NAME/theta (rad)"));
    const auto pose = r.link_pose("b", r.kinematics().configuration({{one, 0.5}, {two, -0.25}, {"p/theta", 0.3}}));
    Eigen::Vector3d shift = Eigen::Vector3d::Zero(), normal(axis.empty(), 0, 0);
    shift[across[0] - 'x'] = 0.5, shift[across[1] - 'x'] = -0.25;
    for (int k = 0; k < 3; ++k)
      if (across.find(char('x' + k)) == across.npos) normal[k] = says(axis, "-2") ? -1 : 1;
    Eigen::Isometry3d wanted = origin();
    wanted.translate(shift);
    wanted.rotate(Eigen::AngleAxisd(0.3, normal));
    CHECK(pose.isApprox(wanted, 1e-12));
  }
  const std::string oblique =
      here.refusal(link("a") + link("b") + joint("p", "planar", "a", "b", "<axis xyz=\"0 1 1\"/>"));
  CHECK(says(oblique, "turn its <origin> instead"));
  CHECK(says(oblique, "r.urdf:4"));
}

TEST_CASE("What several values cannot do is refused, and a fixed joint's <mimic> is noted") {
  const scene here;
  const std::string mimic = "<mimic joint=\"j\"/>";
  CHECK(says(here.refusal(link("a") + link("b") + joint("f", "floating", "a", "b", mimic)), "joints of one value"));
  CHECK(says(here.refusal(link("a") + link("b") + link("c") + joint("j", "floating", "a", "b") +
                          joint("k", "continuous", "a", "c", mimic)),
             "follows \"j\", which has several values"));
  CHECK(says(here.refusal(link("a") + link("f/x") + link("b") + joint("f", "floating", "a", "b") +
                          joint("k", "fixed", "a", "f/x")),
             "f/x"));
  CHECK(says(here.refusal(link("a") + link("b") + joint("j", "fixed", "base", "b")),
             "joint \"j\": names the link \"base\""));
  CHECK(says(here.refusal(link("a") + joint("j", "fixed", "a", "world")), "names the link \"world\""));
  const io::robot r = here.load(link("a") + link("b") + link("c") + joint("j", "continuous", "a", "b") +
                                joint("k", "fixed", "a", "c", mimic));
  CHECK(all(r) == "joint \"k\": is fixed, and its <mimic> is passed over\n");
}

TEST_CASE("A joint that follows others too far to be known is refused, by the tree and by the chain alike") {
  const scene here;
  const auto robot = [&](const std::string& kind, double multiplier, double offset) {
    std::ostringstream follow;
    follow.precision(17);
    follow << "<mimic joint=\"j\" multiplier=\"" << multiplier << "\" offset=\"" << offset
           << "\"/><limit lower=\"-1\" upper=\"1\"/>";
    return here.load(link("a") + link("b") + link("c") + link("d") + joint("j", "continuous", "a", "b") +
                     joint("k", kind, "a", "c", follow.str()) + joint("m", "fixed", "c", "d"));
  };
  const auto agree = [&](const std::string& kind, double multiplier, double offset, double value, bool fine) {
    const io::robot r = robot(kind, multiplier, offset);
    const std::vector<double> q{value};
    const std::string tree = sentence<std::invalid_argument>([&] { r.poses(q); });
    const std::string chain = sentence<std::invalid_argument>([&] { io::joint_chain_of(r).poses(q); });
    INFO(kind << ' ' << multiplier << ' ' << offset << ' ' << value << ": " << tree << " | " << chain);
    CHECK(tree.empty() == fine);
    CHECK(chain.empty() == fine);
  };
  agree("continuous", 1, 0, 0x1p30, true), agree("continuous", 1, 0, 0x1p31, false);
  agree("continuous", 1, 0, 1e16, false);
  agree("continuous", 2, 0.5, 1000, true), agree("continuous", -3, 0.5, 1e16, false);
  agree("continuous", 3, 1, 0x1p21, false);
  agree("continuous", 1e16, -1e16, 1, false);  // the sum is small, and so are its right digits
  agree("continuous", 0, 1e16, 1, false);
  agree("prismatic", 2, 0.5, 10, true), agree("prismatic", 1e16, -1e16, 1, false);
  agree("prismatic", 1e9, -1e9, 1, false);
}

}  // namespace free_joints_test

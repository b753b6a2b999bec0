// SPDX-License-Identifier: BSD-3-Clause
#include "io/damage.hpp"
#include "io/urdf.hpp"
#include "io/xml.hpp"
#include "support/places.hpp"

#include <clearance/io/error.hpp>
#include <clearance/io/robot.hpp>

#include <algorithm>
#include <sstream>

namespace robot_damage_test {

using namespace clearance;

namespace {

const std::string seed = R"(<?xml version="1.0"?>
<robot name="r" version="1.0">
<material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
<link name="base">
 <inertial><origin xyz="0 0 0.5" rpy="0 0 0"/><mass value="1.5"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
 <visual><origin xyz="0.1 0 0" rpy="0 0.1 0"/><geometry><box size="0.2 0.3 0.4"/></geometry><material name="grey"/></visual>
 <collision name="c"><origin xyz="0.1 0.2 0.3" rpy="0.1 0.2 0.3"/><geometry><box size="0.2 0.3 0.5"/></geometry></collision>
 <collision><origin xyz="0.4 0.5 0.6" rpy="0.4 0.5 0.6"/><geometry><capsule radius="0.1" length="0.2"/></geometry></collision>
</link>
<link name="arm">
 <visual><geometry><sphere radius="0.25"/></geometry></visual>
 <collision><geometry><cylinder radius="0.07" length="0.35"/></geometry></collision>
 <collision><geometry><mesh filename="t.obj" scale="2 3 -1"/></geometry></collision>
</link>
<link name="hand"><visual><geometry><sphere radius="0.03"/></geometry></visual></link>
<joint name="turn" type="revolute"><origin xyz="0 0 0.7" rpy="0.7 0.8 0.9"/><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-2" upper="1.5" effort="30" velocity="2"/><dynamics damping="0.1"/></joint>
<joint name="slide" type="prismatic"><origin xyz="0.2 0 0.6"/><parent link="arm"/><child link="hand"/><axis xyz="1 0 0"/><limit lower="-3" upper="4" effort="30" velocity="2"/><mimic joint="turn" multiplier="0.5" offset="0.1"/></joint>
<transmission name="t"><joint name="turn"/></transmission>
</robot>)";

/// Everything that a robot says, at three configurations; what its notes say changes nothing of it.
std::string all_of(const io::robot& r) {
  std::ostringstream out;
  out.precision(12);
  for (std::size_t j = 0; j < r.kinematics().size(); ++j)
    out << r.kinematics().movable(j).name << ' ' << r.kinematics().movable(j).lower << ' '
        << r.kinematics().movable(j).upper << ';';
  for (const auto& part : r.parts()) {
    out << part.name << ' ' << part.tessellation_error << ' ' << part.mesh.triangles.size();
    for (const auto& t : part.mesh.triangles) out << ' ' << t[0] << ' ' << t[1] << ' ' << t[2];
    for (const auto& v : part.mesh.vertices) out << ' ' << v.transpose();
    out << ';';
  }
  for (const double q : {0.0, 0.4, -1.0})
    for (const auto& pose : r.poses(std::vector<double>(r.kinematics().size(), q), {.ignore_limits = true}))
      out << pose.matrix() << ';';
  return out.str();
}

struct robot_file {
  robot_folder folder;
  std::string file = (folder.path / "r.urdf").string();

  robot_file() { folder.put("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"); }
  outcome operator()(const std::string& text) const {
    folder.put("r.urdf", text);
    try {
      io::robot_options coarse;
      coarse.tessellation = 0.02;
      return {all_of(io::load_robot(file, coarse)), ""};
    } catch (const std::exception& error) {
      return {"", error.what()};
    }
  }
};

}  // namespace

TEST_CASE("a damaged number of a URDF is refused in its link or joint, or it was of no use") {
  const robot_file read;
  std::vector<damaged> all;
  io::xml_element root = io::read_xml(seed, "seed");
  each_element(root, "", [&](io::xml_element& e, const std::string& owner) {
    if (owner.empty()) return;
    for (auto& [key, value] : e.attributes) {
      if (one_of(key, {"name", "link", "joint", "type", "filename"})) continue;
      const std::string kept = value;
      for (const auto& text : words_damaged(
               kept, {"", "0,2", "nan", "-nan", "inf", "1e999", "0x10", "1.2.3", "--1", "1 1", "x", "1e", "."})) {
        value = text;
        all.push_back({e.name + "." + key + "=" + text, xml_text(root), owner, false});
      }
      for (const auto& text : words_damaged(kept, {"7", "-7", "0", "1e-300", "1e300", "+0.5"})) {
        value = text;
        all.push_back({e.name + "." + key + "=" + text, xml_text(root), "", true});
      }
      value = kept;
    }
  });
  CHECK(all.size() > 900);
  check_damages(all, seed, read.file, std::cref(read));
}

TEST_CASE("what is left out of a URDF, renamed or there twice does not change the answer without a word") {
  const robot_file read;
  check_damages(structure_damages(seed, {"origin", "axis", "mimic", "visual", "collision"}, {"visual", "collision"},
                                  {"xyz", "rpy", "scale", "lower", "upper", "multiplier", "offset"}),
                seed, read.file, std::cref(read));
}

TEST_CASE("a shape that got into another element is refused, whichever that is") {
  const robot_file read;
  // Every element by its number, so that it is found again in a fresh tree.
  const auto tree = [] { return io::read_xml(seed, "seed"); };
  const auto find = [](io::xml_element& root, std::size_t which) {
    std::size_t at = 0;
    io::xml_element* found = nullptr;
    each_element(root, "", [&](io::xml_element& e, const std::string&) {
      if (at++ == which) found = &e;
    });
    return found;
  };
  io::xml_element whole = tree();
  std::size_t count = 0, tried = 0, shapes = 0;
  each_element(whole, "", [&](io::xml_element&, const std::string&) { ++count; });
  for (std::size_t which = 0; which < count; ++which) {
    const std::string kind = find(whole, which)->name;
    if (kind != "visual" && kind != "collision") continue;
    ++shapes;
    for (std::size_t into = 0; into < count; ++into) {
      io::xml_element root = tree();
      const io::xml_element shape = *find(root, which);
      io::xml_element* target = find(root, into);
      if (target->name == "robot" || target->name == "link") continue;
      const std::string name = target->name;
      target->children.push_back(shape);
      const outcome made = read(xml_text(root));
      INFO(kind << " in " << name << ": " << made.refusal);
      CHECK_FALSE(made.refusal.empty());
      check_sentence(made.refusal, read.file);
      ++tried;
    }
  }
  CHECK(shapes == 7);
  CHECK(tried > 250);
  for (const char* around : {"sensor", "contact", "self_collision_checking", "inertial"}) {
    const std::string link =
        "<robot name=\"r\"><link name=\"a\"><visual><geometry><box size=\"1 1 1\"/></geometry></visual><" +
        std::string(around) + ">";
    const std::string end = "</" + std::string(around) + "></link></robot>";
    CHECK(read(link + end).refusal.empty());
    CHECK(says(read(link + "<collision><geometry><box size=\"1 1 1\"/></geometry></collision>" + end).refusal,
               "link \"a\""));
  }
}

TEST_CASE("one byte changed, left out or put in does not lose a link's geometry") {
  const robot_file read;
  const outcome whole = read(seed);
  std::uint32_t random = 12345;
  const auto next = [&](std::size_t below) {
    random = random * 1664525u + 1013904223u;
    return std::size_t((std::uint64_t(random) * below) >> 32);
  };
  const auto shapes = [](const std::string& text) {
    std::size_t count = 0;
    for (std::size_t at = text.find("<geometry>"); at != text.npos; at = text.find("<geometry>", at + 1)) ++count;
    return count;
  };
  int refused = 0, answered = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    std::string text = seed;
    const std::size_t at = next(text.size());
    const char byte = trial % 2 ? "<>&\"/:=-+ .,e0x\n!"[next(17)] : char(next(256));
    if (trial % 3 == 0)
      text[at] = byte;
    else if (trial % 3 == 1)
      text.erase(at, 1);
    else
      text.insert(at, 1, byte);
    const outcome made = read(text);
    INFO(trial << ": " << int(byte) << " at " << at << ": " << made.refusal);
    if (!made.refusal.empty()) {
      ++refused;
      check_sentence(made.refusal, read.file);
      continue;
    }
    ++answered;
    if (shapes(text) != shapes(seed)) FAIL("a shape is lost");
    // Names, numbers and texts that are not used may change; how much there is may not.
    if (std::ranges::count(made.answer, ';') != std::ranges::count(whole.answer, ';')) FAIL("another robot");
  }
  CHECK(refused > 500);
  CHECK(answered > 100);
}

TEST_CASE("XML that is not well-formed, has a document type, or names that cannot be shown is refused") {
  const robot_file read;
  const std::string shape = "<collision><geometry><box size=\"1 1 1\"/></geometry></collision>";
  const auto with = [&](const std::string& inside) { return "<robot name=\"r\">" + inside + "</robot>"; };
  const std::string good = with("<link name=\"a\">" + shape + "</link>");
  REQUIRE(read(good).refusal.empty());
  const std::string laughs = "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]>" +
                             with("<link name=\"&b;\"/>");
  for (const std::string& text :
       std::vector<std::string>{good + "<robot name=\"s\"/>",
                                good + "more",
                                "more" + good,
                                "x<?xml version=\"1.0\"?>" + good,
                                laughs,
                                "<!DOCTYPE robot>" + good,
                                "<?xml version=\"1.0\" encoding=\"none\"?>" + good,
                                with("<link name=\"a\" name=\"b\">" + shape + "</link>"),
                                with("<link name=\"&unknown;\">" + shape + "</link>"),
                                with("<link name=\"a&#27;[2J\">" + shape + "</link>"),
                                with("<link name=\"a&#10;b\">" + shape + "</link>"),
                                with("<link name=\"a\x7f\">" + shape + "</link>"),
                                with("<link name=\"a&#x9b;\">" + shape + "</link>"),
                                with("<link name=\"a\xff\">" + shape + "</link>"),
                                with("<link name=\"a\xc0\xaf\">" + shape + "</link>"),
                                with("<link name=\"" + std::string(2'000'000, 'n') + "\">" + shape + "</link>"),
                                with("<link name=\"\">" + shape + "</link>"),
                                with("<link name=a>" + shape + "</link>"),
                                with("<link name=\"a\">" + shape + "</lnk>"),
                                with("<link name=\"a\">" + shape + "</link>link name=\"b\"/>"),
                                with("<x:link name=\"a\">" + shape + "</x:link>"),
                                with("<lnk name=\"a\">" + shape + "</lnk>"),
                                with("<link name=\"a\">" + shape + "</link><model><link name=\"b\"/></model>"),
                                with("<link name=\"a\">" + shape + std::string("\0", 1) + "</link>")}) {
    const outcome made = read(text);
    INFO(text.substr(0, 200));
    CHECK_FALSE(made.refusal.empty());
    check_sentence(made.refusal, read.file);
  }
  CHECK(read("\n<?xml version=\"1.0\"?>" + good).refusal.empty());
  CHECK(read(with("<link name=\"a\">" + shape + "</link>text")).refusal.empty());
  // Other vocabularies, if they say so, and elements that have nothing of a robot in them.
  CHECK(
      read(with("<link name=\"a\">" + shape + "</link><gazebo reference=\"a\"><visual/></gazebo><mujoco><a/></mujoco>"))
          .refusal.empty());
  CHECK(
      read("<robot name=\"r\" xmlns:x=\"urn:x\"><link name=\"a\">" + shape + "<x:y/></link></robot>").refusal.empty());
  CHECK(read("\xEF\xBB\xBF" + good).refusal.empty());
}

TEST_CASE("joints keep the file's order, however their names are written") {
  const robot_folder folder;
  const auto order = [&](const std::string& first) {
    std::string text =
        "<robot name=\"r\"><link name=\"a\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>";
    for (const std::string& name : {std::string("z"), first, std::string("m")})
      text += "<link name=\"to " + name + "\"/><joint name=\"" + name +
              "\" type=\"continuous\"><parent link=\"a\"/><child link=\"to " + name + "\"/></joint>";
    const io::robot r = io::load_robot(folder.put("r.urdf", text + "</robot>"));
    REQUIRE(r.kinematics().size() == 3);
    return r.kinematics().movable(1).name;
  };
  CHECK(order("plain") == "plain");
  CHECK(order("arm&amp;1") == "arm&1");
  CHECK(order("&lt;&gt;&quot;&apos;") == "<>\"'");
  CHECK(order("&#97;&#x62;") == "ab");
  CHECK(order("a>b") == "a>b");
  CHECK(order("gr\xc3\xbc\xc3\x9f") == "gr\xc3\xbc\xc3\x9f");
}

TEST_CASE("a value that no number can hold is refused with the joint that has it") {
  const robot_folder folder;
  const auto chain = [&](const std::string& mimic, const std::string& origin) {
    return io::load_robot(folder.put(
        "r.urdf",
        "<robot name=\"r\"><link name=\"a\"><collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>"
        "<link name=\"b\"/><link name=\"c\"/><joint name=\"one\" type=\"prismatic\"><parent link=\"a\"/><child "
        "link=\"b\"/>" +
            origin +
            "<limit lower=\"-3\" upper=\"3\"/></joint><joint name=\"two\" type=\"prismatic\"><parent link=\"b\"/>"
            "<child link=\"c\"/>" +
            origin + "<limit lower=\"-3\" upper=\"3\"/>" + mimic + "</joint></robot>"));
  };
  const io::robot follows = chain("<mimic joint=\"one\" multiplier=\"1e308\"/>", "");
  CHECK(follows.poses(std::vector<double>{1}).size() == 1);
  CHECK(says(sentence<std::invalid_argument>([&] { follows.poses(std::vector<double>{3}); }), "\"two\""));
  const io::robot far = chain("<mimic joint=\"one\"/>", "<origin xyz=\"1e308 0 0\"/>");
  CHECK(says(sentence<std::invalid_argument>([&] { far.poses(std::vector<double>{0}); }), "\"two\""));
}

TEST_CASE("only regular files are meshes, and what a robot reads has limits") {
  const robot_folder folder;
  folder.put("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto with = [&](const std::string& uri, const io::robot_options& options = {}) {
    return sentence([&] {
      io::load_robot(folder.put("r.urdf", "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"" +
                                              uri + "\"/></geometry></collision></link></robot>"),
                     options);
    });
  };
  CHECK(with("t.obj").empty());
  for (const char* uri : {"file:///dev/zero", "/dev/zero", "/dev/null", "file:///dev/urandom"}) {
    CHECK(says(with(uri), "link \"a\""));
    CHECK(says(with(uri), "no regular file"));
  }
  io::robot_options small;
  small.limits.bytes = 20;
  CHECK(says(with("t.obj", small), "mesh_limits::bytes"));
  small = {};
  small.limits.values = 5;
  CHECK(says(with("t.obj", small), "mesh_limits::values"));
  small = {};
  small.limits.depth = 3;
  CHECK(says(with("t.obj", small), "mesh_limits::depth"));
  CHECK(says(sentence([&] { io::load_robot("/dev/zero"); }), "is a device"));
}

TEST_CASE("the robots that were made to attack are refused, or answered in full", "[data]") {
  const std::filesystem::path folder = testing::data("/attack");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  const auto load = [&](const std::string& name) { return sentence([&] { io::load_robot(folder / name); }); };
  for (const char* bad :
       {"link-box-comma.urdf", "dae-no-vcount.urdf", "dae-no-p.urdf", "dae-selfnode-entity.urdf",
        "dae-instance-lost.urdf", "dae-index-wraps.urdf", "glb-child-lost.urdf", "glb-chain20000.urdf", "esc.urdf"}) {
    INFO(bad);
    CHECK_FALSE(load(bad).empty());
    check_sentence(load(bad), (folder / bad).string().substr(0, 20));
  }
  for (const char* good :
       {"link-ref.urdf", "dae-instance-ok.urdf", "glb-ok.urdf", "order-plain.urdf", "order-entity.urdf"})
    CHECK(load(good) == "");
  CHECK(io::load_robot(folder / "link-capsule.urdf").parts().size() == 2);
  const auto both = io::load_robot(folder / "link-second-lost.urdf").parts().at(1);
  CHECK(both.mesh.triangles.size() > 12);  // the box and the capsule
  CHECK(io::load_robot(folder / "order-entity.urdf").kinematics().movable(0).name == "arm&1");
}

TEST_CASE("every single damaged number of the real robots is refused, or was of no use", "[data]") {
  const std::filesystem::path folder = testing::data("/robots");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  for (const char* name : {"kuka_lwr_kresse/kuka.urdf", "ur5e/ur5e.urdf", "jvrc1/jvrc1.urdf"}) {
    const robot_folder scratch;
    const std::string file = (scratch.path / "r.urdf").string();
    // The description alone: links, shapes and joints as they were read, without the meshes.
    const auto read = [&](const std::string& text) -> outcome {
      scratch.put("r.urdf", text);
      try {
        const io::urdf_file made = io::read_urdf(file);
        std::ostringstream out;
        for (const auto& link : made.links) {
          out << link.name << ';';
          for (const auto* shapes : {&link.collision, &link.visual})
            for (const auto& s : *shapes) {
              out << s.geometry.index() << s.origin.matrix();
              if (const auto* mesh = std::get_if<io::urdf_mesh>(&s.geometry))
                out << mesh->uri << mesh->scale.transpose();
            }
        }
        for (const auto& j : made.tree.joints())
          out << j.name << j.origin.matrix() << j.axis.transpose() << j.lower << j.upper;
        return {out.str(), ""};
      } catch (const std::exception& error) {
        return {"", error.what()};
      }
    };
    const std::string whole = io::read_bytes((folder / name).string());
    std::vector<damaged> all;
    io::xml_element root = io::read_xml(whole, name);
    int number = 0;
    each_element(root, "", [&](io::xml_element& e, const std::string& owner) {
      if (owner.empty()) return;
      for (auto& [key, value] : e.attributes) {
        if (one_of(key, {"name", "link", "joint", "type", "filename"})) continue;
        const std::string kept = value;
        for (const auto& text :
             words_damaged(kept, {std::vector<std::string>{"0,1", "nan", "", "1e999"}[std::size_t(++number % 4)]})) {
          value = text;
          all.push_back({e.name + "." + key + "=" + text, xml_text(root), owner, false});
        }
        value = kept;
      }
    });
    INFO(name);
    check_damages(all, whole, file, read);
  }
}

}  // namespace robot_damage_test

// SPDX-License-Identifier: BSD-3-Clause
// Which parts of a described robot can meet, by its joints and by its SRDF file.
#include "io/robot_folder.hpp"
#include "support/catch.hpp"

#include <clearance/io/srdf.hpp>

#include <set>

namespace srdf_test {

using namespace clearance;

namespace {

using pair_names = std::set<std::pair<std::string, std::string>>;

std::string link(const std::string& name, bool geometry = true) {
  return "<link name=\"" + name + "\">" +
         (geometry ? "<collision><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision>" : "") + "</link>\n";
}
std::string joint(const std::string& type, const std::string& parent, const std::string& child) {
  return "<joint name=\"to_" + child + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" +
         child + "\"/><limit lower=\"-1\" upper=\"1\"/></joint>\n";
}
io::robot described(const std::string& inside, const io::robot_options& options = {}) {
  return io::load_robot_text("<robot name=\"r\">" + inside + "</robot>", "r.urdf", options);
}

/// The pairs that are there, each with the robot's earlier part first.
pair_names there(const io::robot& r, const part_pairs& pairs) {
  pair_names made;
  for (std::size_t a = 0; a < pairs.parts(); ++a)
    for (const auto b : pairs.above(a)) made.emplace(r.parts()[a].name, r.parts()[b].name);
  return made;
}
pair_names left(const io::robot& r) { return there(r, io::pairs_without_neighbours(r)); }

/// base, two links and a hand with two fingers; the wrist has no geometry.
io::robot arm(const io::robot_options& options = {}) {
  return described(link("base") + link("upper") + link("fore") + link("wrist", false) + link("hand") + link("left") +
                       link("right") + joint("revolute", "base", "upper") + joint("continuous", "upper", "fore") +
                       joint("revolute", "fore", "wrist") + joint("revolute", "wrist", "hand") +
                       joint("prismatic", "hand", "left") + joint("prismatic", "hand", "right"),
                   options);
}
io::srdf_pairs srdf(const std::string& inside, const io::robot& r = arm()) {
  return io::load_srdf_text("<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + inside + "</robot>", "r.srdf", r);
}
std::string off(const std::string& a, const std::string& b) {
  return "<disable_collisions link1=\"" + a + "\" link2=\"" + b + "\" reason=\"Never\"/>\n";
}
std::string on(const std::string& a, const std::string& b) {
  return "<enable_collisions link1=\"" + a + "\" link2=\"" + b + "\"/>\n";
}
std::string notes(const io::srdf_pairs& read) {
  std::string all;
  for (const auto& note : read.notes) all += note + '\n';
  return all;
}

}  // namespace

TEST_CASE("A part and the nearest one above it are neighbours, also past links without geometry") {
  CHECK(left(arm()) == pair_names{{"base", "fore"},
                                  {"base", "hand"},
                                  {"base", "left"},
                                  {"base", "right"},
                                  {"upper", "hand"},
                                  {"upper", "left"},
                                  {"upper", "right"},
                                  {"fore", "left"},
                                  {"fore", "right"},
                                  {"left", "right"}});
  CHECK(left(arm({.exclude_links = {"hand", "base"}})) ==
        pair_names{{"upper", "left"}, {"upper", "right"}, {"left", "right"}});
}

TEST_CASE("Parts that fixed joints hold together are neighbours, however many lie between") {
  const std::string links = link("table") + link("stand") + link("base") + link("upper") + link("camera") +
                            joint("fixed", "table", "stand") + joint("fixed", "stand", "base") +
                            joint("fixed", "table", "camera");
  CHECK(left(described(links + joint("revolute", "base", "upper"))) ==
        pair_names{{"table", "upper"}, {"stand", "upper"}, {"upper", "camera"}});
  // A body without geometry of its own holds its parts together, too.
  CHECK(left(described(link("frame", false) + link("a") + link("b") + joint("fixed", "frame", "a") +
                       joint("fixed", "frame", "b"))) == pair_names{});
  CHECK(left(described(link("frame", false) + link("a") + link("b") + joint("fixed", "frame", "a") +
                       joint("revolute", "frame", "b"))) == pair_names{{"a", "b"}});
}

TEST_CASE("What moves freely over another part is not its neighbour") {
  const std::string parts = link("floor") + link("cart") + link("mast");
  const std::string mast = joint("revolute", "cart", "mast");
  for (const std::string type : {"planar", "floating"})
    CHECK(left(described(parts + mast + "<joint name=\"j\" type=\"" + type +
                         "\"><parent link=\"floor\"/><child link=\"cart\"/><axis xyz=\"0 0 1\"/></joint>")) ==
          pair_names{{"floor", "cart"}, {"floor", "mast"}});
  CHECK(left(described(parts + mast + joint("prismatic", "floor", "cart"))) == pair_names{{"floor", "mast"}});
  CHECK(left(described(parts + link("x", false) + mast + joint("prismatic", "floor", "x") +
                       joint("prismatic", "x", "cart"))) == pair_names{{"floor", "cart"}, {"floor", "mast"}});
}

TEST_CASE("An SRDF file alone says which pairs are left") {
  const auto r = arm();
  const auto read = srdf(off("base", "upper") + off("fore", "upper") + off(" hand ", "wrist") +
                         "<group name=\"arm\"><chain base_link=\"base\" tip_link=\"hand\"/></group>\n"
                         "<virtual_joint name=\"v\" type=\"fixed\" parent_frame=\"world\" child_link=\"base\"/>\n");
  CHECK(notes(read).empty());
  CHECK(read.pairs.size() == 15 - 2);
  CHECK_FALSE((read.pairs.has(0, 1) || read.pairs.has(2, 1)));
  CHECK(read.pairs.has(2, 3));  // fore and hand, although they are neighbours
}

TEST_CASE("Rules of an SRDF file apply in MoveIt's order, wherever they stand") {
  const auto r = arm();
  const std::string by_default = "<disable_default_collisions link=\"left\"/>\n";
  for (const std::string& text : {off("left", "hand") + on("left", "base") + on("left", "hand") + by_default,
                                  by_default + on("left", "hand") + off("hand", "left") + on("base", "left")}) {
    const auto read = srdf(text, r);
    CHECK(notes(read).empty());
    pair_names with_left;
    for (const auto& each : there(r, read.pairs))
      if (each.first == "left" || each.second == "left") with_left.insert(each);
    CHECK(with_left == pair_names{{"base", "left"}});
    CHECK(read.pairs.size() == 10 + 1);
  }
}

TEST_CASE("What an SRDF file has too much is noted") {
  CHECK(says(notes(srdf("")), "disables no pair of parts, so neighbours are asked about, too"));
  CHECK(
      says(notes(srdf(off("base", "uper"))), "link \"uper\": is named in the SRDF file, and is no link of the robot"));
  CHECK(says(notes(srdf(off("base", "upper") + off("hand", "hand"))), "link \"hand\": is named with itself"));
  CHECK(says(notes(srdf(off("base", "upper") + "<capability/>")), "<capability>: is not known in SRDF, and is passed"));
  for (const std::string text : {"<disable_default_collisions/>", "<disable_collisions link1=\"\" link2=\"base\"/>"}) {
    const auto nothing = srdf(text);
    CHECK(says(notes(nothing), "does not say which link is its link"));
    CHECK(nothing.pairs.size() == 15);
  }
  const auto other = io::load_srdf_text("<robot name=\"q\">" + off("base", "upper") + "</robot>", "q.srdf", arm());
  CHECK(says(notes(other), "is that of another robot, \"q\", not of \"r\""));
  CHECK(other.pairs.size() == 14);
  CHECK(notes(srdf(off("base", "upper"), arm({.exclude_links = {"upper"}}))) ==
        notes(srdf("", arm({.exclude_links = {"upper"}}))));  // not noted as an unknown link
}

TEST_CASE("An SRDF file that may mean something else is refused") {
  const auto why = [](const std::string& inside) { return sentence([&] { srdf(inside); }); };
  CHECK(says(why("<enable_colisions link1=\"base\" link2=\"hand\"/>"),
             "r.srdf:3: <enable_colisions> is not known (enable_collisions?)"));
  CHECK(says(why("<enable_collisions link1=\"base\"/>"), "does not say which link is its link2"));
  CHECK(says(why("<enable_collisions link1=\" \" link2=\"hand\"/>"), "does not say which link is its link1"));
  CHECK(says(why("<xacro:arm/>"), "is xacro: expand it"));
  CHECK(says(why("<link name=\"base\"/>"), "is a URDF file, not its SRDF"));
  CHECK(says(why("<group>"), "is no well-formed XML"));
  CHECK(says(why("off"), "has text in it"));
  CHECK(says(sentence([] { io::load_srdf_text("<sdf/>", "r.srdf", arm()); }), "is not an SRDF file"));
  CHECK(says(sentence([] { io::load_srdf_text(std::string(100, ' '), "r.srdf", arm(), {.bytes = 10}); }),
             "mesh_limits::bytes"));
  CHECK(says(sentence([] { io::load_srdf("missing.srdf", arm()); }), "missing.srdf"));
}

TEST_CASE("An SRDF file is read from where it lies") {
  const robot_folder folder;
  const auto file =
      folder.put("r.srdf", "\n<?xml version=\"1.0\"?><robot name=\"r\">" + off("base", "upper") + "</robot>");
  CHECK(io::load_srdf(file, arm()).pairs.size() == 14);
}

}  // namespace srdf_test

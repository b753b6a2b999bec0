// SPDX-License-Identifier: BSD-3-Clause
#include "io/scratch_file.hpp"
#include "solid/shapes.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"

#include <clearance/io/certify.hpp>
#include <clearance/io/robot_bodies.hpp>
#include <clearance/io/spheres_file.hpp>
#include <clearance/packing/pack.hpp>

#include <bit>

namespace spheres_test {

using namespace clearance;

namespace {

std::vector<inner_sphere> awkward_spheres() {
  std::vector<inner_sphere> all = {
      {{0.1f, -0.2f, 0.3f}, 1.0f / 3}, {{1e-42f, -0.0f, 3e17f}, 1e-45f}, {{16777216, 0.7f, -5e-7f}, 1e18f}};
  std::mt19937 random(7);
  while (all.size() < 2000) {
    const auto any = [&] { return std::bit_cast<float>(std::uint32_t(random())); };
    const inner_sphere s{{any(), any(), any()}, std::abs(any())};
    if (is_finite(s.center) && s.radius > 0 && is_finite(s.radius)) all.push_back(s);
  }
  return all;
}

bool same(const std::vector<inner_sphere>& a, const std::vector<inner_sphere>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (const auto& [p, q] : {std::pair{a[i].center.x, b[i].center.x},
                               {a[i].center.y, b[i].center.y},
                               {a[i].center.z, b[i].center.z},
                               {a[i].radius, b[i].radius}})
      if (std::bit_cast<std::uint32_t>(p) != std::bit_cast<std::uint32_t>(q)) return false;
  return true;
}

std::string csv_refusal(const std::string& text) {
  const scratch_file file(".csv", text);
  const std::string why = refusal([&] { io::load_spheres_csv(file.path); });
  return why.starts_with(file.path) ? why.substr(file.path.size()) : why;
}

std::string yaml_refusal(const std::string& text) {
  const scratch_file file(".yml", text);
  const std::string why = refusal([&] { io::load_spheres_yaml(file.path); });
  return why.starts_with(file.path) ? why.substr(file.path.size()) : why;
}

bool begins(const std::string& text, const std::string& with) {
  INFO(text);
  CHECK(text.substr(0, with.size()) == with);
  return true;
}

}  // namespace

TEST_CASE("spheres come back from CSV to the bit, in their order, without a certificate") {
  const auto spheres = awkward_spheres();
  const scratch_file file(".csv");
  io::save_spheres_csv(spheres, file.path);
  const packing loaded = io::load_spheres_csv(file.path);
  CHECK(same(loaded.spheres, spheres));
  CHECK(loaded.gap == std::numeric_limits<double>::infinity());
  CHECK(loaded.gap_p95 == std::numeric_limits<double>::infinity());
  CHECK(loaded.radius_min == spheres[1].radius);
}

TEST_CASE("CSV as others write it is read, and what is no sphere is refused with its line") {
  const scratch_file other(".csv", "\xEF\xBB\xBFx; y; z; radius\r\n1; 2; 3; 0.5 # a comment\r\n\r\n4 5 6 +7e-1");
  CHECK(same(io::load_spheres_csv(other.path).spheres, {{{1, 2, 3}, 0.5f}, {{4, 5, 6}, 0.7f}}));
  const scratch_file plain(".csv", "1,2,3,4\n");
  CHECK(same(io::load_spheres_csv(plain.path).spheres, {{{1, 2, 3}, 4}}));
  CHECK(csv_refusal("") == ": is empty (0 bytes)");
  CHECK(csv_refusal("x,y,z,r\n") == ": has no sphere");
  CHECK(csv_refusal("a,b,c\n1,2,3\n") == ":1: the header is not x,y,z,r");
  CHECK(csv_refusal("r,x,y,z\n1,2,3,4\n") == ":1: the header is not x,y,z,r");
  CHECK(csv_refusal("x,y,z,r\n1,2,3\n") == ":2: a sphere needs four numbers, x,y,z,r; here are 3");
  CHECK(csv_refusal("x,y,z,r\n1,2,3,4,5\n") == ":2: a sphere needs four numbers, x,y,z,r; here are 5");
  CHECK(csv_refusal("1,2,3,4\nx,y,z,r\n") == ":2: \"x\" is not a number");
  CHECK(csv_refusal("1,2,3,4x\n") == ":1: \"4x\" is not a number");
  CHECK(csv_refusal("1,2,3,nan\n").starts_with(":1: the sphere has a radius of nan"));
  CHECK(csv_refusal("1,2,3,0\n").starts_with(":1: the sphere has a radius of 0"));
  CHECK(csv_refusal("1,2,3,-1\n").starts_with(":1: the sphere has a radius of -1"));
  CHECK(csv_refusal("1,2,3,1e-60\n").starts_with(":1: the sphere has a radius of 0"));
  CHECK(csv_refusal("1,2,3,1e60\n") == ":1: \"1e60\" is not a number");
  CHECK(csv_refusal("1,inf,3,1\n") == ":1: the sphere has a centre that is not finite");
  CHECK(csv_refusal(std::string(100000, ',')) == ": has no sphere");
  CHECK(refusal([] { io::save_spheres_csv({}, "/nonexistent/x.csv"); }) ==
        "/nonexistent/x.csv: cannot be written: a new file beside it cannot be made (No such file or directory)");
}

TEST_CASE("spheres come back from YAML to the bit, link by link") {
  std::vector<io::packed_part> parts;
  for (const std::string name : {"panda_link0", "true", "12", "a: b # c", "\"quoted\" \xc3\xbc"})
    parts.push_back({.name = name, .spheres = io::uncertified(awkward_spheres()), .solid = {}, .recipe = {}});
  parts[1].spheres.spheres.resize(1);
  const scratch_file file(".yml");
  io::save_spheres_yaml(parts, file.path);
  const auto loaded = io::load_spheres_yaml(file.path);
  REQUIRE(loaded.size() == parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    CHECK(loaded[i].name == parts[i].name);
    CHECK(same(loaded[i].spheres.spheres, parts[i].spheres.spheres));
    CHECK(loaded[i].spheres.gap == std::numeric_limits<double>::infinity());
    CHECK(!loaded[i].solid);
  }
}

TEST_CASE("YAML refuses to keep a name that it would change") {
  for (const std::string name : {"\xff", "a\x80", "\xc3", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    const scratch_file file(".yml");
    std::vector<io::packed_part> parts(1);
    parts[0].name = name;
    parts[0].spheres = io::uncertified({{{0, 0, 0}, 1}});
    const std::string why = refusal([&] { io::save_spheres_yaml(parts, file.path); });
    CHECK(why.ends_with("is not UTF-8, and YAML cannot hold it"));
    CHECK(std::filesystem::file_size(file.path) == 0);  // nothing is written
  }
}

TEST_CASE("cuRobo's files are read as its users have them") {
  const std::string list =
      "\n    link_a:\n      - \"center\": [0.0, 0.1, -0.2] # first\n        \"radius\": 0.03\n      - center: [1, 2, "
      "3]\n        radius: 5e-2\n";
  const scratch_file plain(".yml", "# spheres\ncollision_spheres:" + list);
  const auto check = [](const std::string& path) {
    const auto parts = io::load_spheres_yaml(path);
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].name == "link_a");
    CHECK(same(parts[0].spheres.spheres, {{{0, 0.1f, -0.2f}, 0.03f}, {{1, 2, 3}, 0.05f}}));
  };
  check(plain.path);
  const scratch_file nested(".yml",
                            "robot_cfg:\n  kinematics:\n    base_link: x\n    collision_spheres:\n      link_a: "
                            "[{center: [0, 0.1, -0.2], radius: 0.03}, {center: [1,2,3], radius: 0.05}]\n");
  check(nested.path);
}

TEST_CASE("a word of YAML that may change the spheres is refused with its line, any other noted, and a buffer added") {
  const auto text = [](const std::string& top, const std::string& beside, const std::string& within) {
    return top + "robot_cfg:\n  kinematics:\n" + (beside.empty() ? "" : "    " + beside + "\n") +
           "    collision_spheres:\n      a:\n        - center: [1, 2, 3]\n          radius: 0.5\n" +
           (within.empty() ? "" : "          " + within + "\n");
  };
  const auto load = [&](const std::string& yaml, std::vector<std::string>& notes) {
    const scratch_file file(".yml", yaml);
    return io::load_spheres(file.path, {}, &notes);
  };
  std::vector<std::string> notes;
  const auto plain = load(text("", "", ""), notes);
  CHECK(notes.empty());
  for (const std::string word : {"offset: 0.1", "scale: 0.001", "units: mm", "unit: m", "radius_scale: 2",
                                 "padding: 0.1", "pose: [0, 0, 0]", "Transform: x", "sphere_offset: 1",
                                 "collision_sphere_bufer: 0.1", "centre: [0, 0, 0]", "radii: 3", "frame: world"}) {
    INFO(word);
    const bool of_sphere = word.starts_with("centre") || word.starts_with("radii");
    if (!of_sphere) {
      begins(yaml_refusal(text(word + "\n", "", "")), ":1: has the key");
      begins(yaml_refusal(text("", word, "")), ":3: has the key");
    }
    if (!word.starts_with("collision"))
      begins(yaml_refusal(text("", "", word)), ":7: sphere 0 of link \"a\" has the key");
  }
  for (const std::string word : {"colour: red", "author: me", "name: a"}) {
    INFO(word);
    for (const std::string& yaml : {text(word + "\n", "", ""), text("", word, ""), text("", "", word)}) {
      notes.clear();
      CHECK(same(load(yaml, notes)[0].spheres.spheres, plain[0].spheres.spheres));
      REQUIRE(notes.size() == 1);
      CHECK(notes[0].ends_with("which is not known, and is passed over"));
    }
  }
  notes.clear();
  CHECK(load(text("", "self_collision_buffer: {a: 1}\n    collision_sphere_buffer: 0.0", ""), notes)[0]
            .spheres.spheres[0]
            .radius == 0.5f);
  CHECK(notes.empty());
  for (const std::string buffer : {"0.25", "{a: 0.25, b: 1}"}) {
    notes.clear();
    CHECK(load(text("", "collision_sphere_buffer: " + buffer, ""), notes)[0].spheres.spheres[0].radius == 0.75f);
    REQUIRE(notes.size() == 1);
    CHECK(notes[0] == "has a collision_sphere_buffer, which is added to the radii");
  }
  CHECK_FALSE(yaml_refusal(text("", "collision_sphere_buffer: -0.5", "")).empty());
  CHECK_FALSE(yaml_refusal(text("", "collision_sphere_buffer: thick", "")).empty());
  CHECK_FALSE(yaml_refusal(text("", "collision_sphere_buffer: {a: [1]}", "")).empty());
}

TEST_CASE("YAML that holds no spheres is refused with its line") {
  CHECK(yaml_refusal("") == ": is empty (0 bytes)");
  begins(yaml_refusal("a: [1, 2"), ":");
  CHECK(yaml_refusal("a: [1, 2").find("is no YAML") != std::string::npos);
  CHECK(yaml_refusal("just a word") == ": has no collision_spheres");
  CHECK(yaml_refusal("- 1\n- 2\n") == ": has no collision_spheres");
  CHECK(yaml_refusal("robot_cfg: 3\n") == ": has no collision_spheres");
  CHECK(yaml_refusal("collision_spheres: spheres/franka.yml\n") ==
        ": its spheres are in another file, \"spheres/franka.yml\": give that one");
  CHECK(yaml_refusal("collision_spheres:\n") == ": its collision_spheres name no link");
  CHECK(yaml_refusal("collision_spheres: {}\n") == ": its collision_spheres name no link");
  begins(yaml_refusal("collision_spheres:\n  a: 3\n"), ":2: the spheres of link \"a\" are no list");
  begins(yaml_refusal("collision_spheres:\n  a: []\n"), ":2: the spheres of link \"a\" are no list");
  begins(yaml_refusal("collision_spheres:\n  a:\n  b: [{center: [0,0,0], radius: 1}]\n"),
         ":2: the spheres of link \"a\" are no list");
  const auto one = [](const std::string& sphere) {
    return yaml_refusal("collision_spheres:\n  a:\n    - " + sphere + "\n");
  };
  begins(one("3"), ":3: sphere 0 of link \"a\" has no center and radius");
  begins(one("{radius: 1}"), ":3: sphere 0 of link \"a\" has no center of three numbers");
  begins(one("{center: [0, 0], radius: 1}"), ":3: sphere 0 of link \"a\" has no center of three numbers");
  begins(one("{center: [0, 0, 0]}"), ":3: sphere 0 of link \"a\" has no radius");
  begins(one("{center: [0, 0, zero], radius: 1}"),
         ":3: the center of sphere 0 of link \"a\" is \"zero\", not a number");
  begins(one("{center: [0, 0, [1]], radius: 1}"), ":3: the center of sphere 0 of link \"a\" is not a number");
  begins(one("{center: [0, 0, .inf], radius: 1}"), ":3: the center of sphere 0 of link \"a\" is \".inf\"");
  begins(one("{center: [0, 0, inf], radius: 1}"), ":3: sphere 0 of link \"a\" has a centre that is not finite");
  for (const std::string radius : {"0", "-10.0", "nan"})
    begins(one("{center: [0, 0, 0], radius: " + radius + "}"), ":3: sphere 0 of link \"a\" has a radius of");
  const std::string a = "  a: [{center: [0,0,0], radius: 1}]\n";
  CHECK(yaml_refusal("collision_spheres:\n" + a + a) == ":3: has the key \"a\" twice");
  CHECK(!yaml_refusal(std::string(200000, '[')).empty());
  CHECK(!yaml_refusal("collision_spheres: &x {a: *x}\n").empty());
  CHECK(!yaml_refusal(std::string("\0\xff\xfe\x80 a: 1", 9)).empty());
}

TEST_CASE("a key that a YAML file has twice is refused at every level, and so is what it unfolds to or hides") {
  const std::string keys[] = {"robot_cfg", "kinematics", "collision_spheres", "link", "center", "radius"};
  for (const std::string& twice : keys) {
    const auto entry = [&](const std::string& key, const std::string& value) {
      return key + ": " + value + (key == twice ? ", " + key + ": " + value : "");
    };
    const std::string sphere = "{" + entry("center", "[0, 0, 0]") + ", " + entry("radius", "1") + "}";
    std::string text = "[" + sphere + "]";
    for (const char* key : {"link", "collision_spheres", "kinematics", "robot_cfg"})
      text = "{" + entry(key, text) + "}";
    CHECK(yaml_refusal(text + "\n") == ":1: has the key \"" + twice + "\" twice");
  }
  const std::string good = "collision_spheres:\n  a: &x [{center: [0,0,0], radius: 1}]\n";
  CHECK(yaml_refusal(good).empty());
  CHECK(yaml_refusal(good + "---\n" + good) == ":3: has more than one YAML document");
  std::string many = good;
  for (int i = 0; i < 3; ++i) many += "  b" + std::to_string(i) + ": *x\n";
  CHECK(yaml_refusal(many).empty());
  std::string list = "collision_spheres:\n  a: &x\n";
  for (int i = 0; i < 1000; ++i) list += "    - {center: [0,0,0], radius: 1}\n";
  for (int i = 0; i < 1000; ++i) list += "  b" + std::to_string(i) + ": *x\n";
  CHECK(yaml_refusal(list).find("by aliases") != std::string::npos);
}

TEST_CASE(
    "spheres from elsewhere are proven against the mesh: the gap covers what they miss, the excess what sticks out") {
  const mesh_solid box(shapes::box({-0.1, -0.2, -0.05}, {0.1, 0.2, 0.05}));
  // One inside, one that sticks out of the top by 0.03, one outside at a distance of 0.01.
  const std::vector<inner_sphere> spheres = {
      {{0, -0.1f, 0}, 0.04f}, {{0, 0, 0.03f}, 0.05f}, {{0.135f, 0.1f, 0}, 0.025f}};
  const io::certified_spheres proven = io::certify(box, io::uncertified(spheres));
  CHECK(same(proven.spheres.spheres, spheres));
  CHECK(proven.excess == Approx(0.06).epsilon(1e-6));
  CHECK(proven.spheres.gap > 0.1);
  CHECK(proven.spheres.gap < 0.3);
  CHECK(proven.spheres.gap_mean > 0);
  CHECK(io::excess(box, std::span(spheres).first(1)) < 1e-9);
  CHECK(io::excess(box, std::span(spheres).first(2)) == Approx(0.03).epsilon(1e-6));

  // The law, with points everywhere: distance - gap <= distance to the box <= distance + excess.
  const Eigen::Vector3d half(0.1, 0.2, 0.05);
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    Eigen::Vector3d p;
    for (int k = 0; k < 3; ++k) p[k] = std::uniform_real_distribution<double>(-0.4, 0.4)(random);
    const double exact = (p.cwiseAbs() - half).cwiseMax(0).norm();
    double d = 1e9;
    for (const auto& s : spheres)
      d = std::min(d, (p - Eigen::Vector3d(s.center.x, s.center.y, s.center.z)).norm() - double(s.radius));
    if (!(d - proven.spheres.gap <= exact) || !(exact <= std::max(0.0, d + proven.excess)))
      FAIL("not so at " << p.transpose());
  }

  // What pack made is certified as it says.
  const packing packed = pack(box, {.count = 200});
  const io::certified_spheres again = io::certify(box, io::uncertified(packed.spheres));
  CHECK(again.excess < 1e-9);
  CHECK(again.spheres.gap == Approx(packed.gap).epsilon(0.02));
  CHECK(again.spheres.fill == Approx(packed.fill).epsilon(1e-9));
  CHECK(again.part_gap() == Approx(again.spheres.gap));
}

}  // namespace spheres_test

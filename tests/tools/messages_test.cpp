// SPDX-License-Identifier: BSD-3-Clause
// Whatever names and words a file contains, a message is one short, printable line that names the file, and answers are
// UTF-8.
#include "io/robot_folder.hpp"
#include "io/scratch_file.hpp"
#include "tools/run_command.hpp"

#include <clearance/io/sentence.hpp>

#include <cstdint>
#include <cstring>

namespace messages_test {

using namespace clearance;

namespace {

/// Every character is valid UTF-8 that controls nothing, or the end of a line.
bool harmless(std::string_view text) {
  while (!text.empty()) {
    std::uint32_t code = 0;
    const std::size_t size = io::utf8_character(text, code);
    if (size == 0 || (code != '\n' && io::controls(code))) return false;
    text.remove_prefix(size);
  }
  return true;
}

std::size_t longest_line(const std::string& text) {
  std::size_t longest = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    longest = std::max(longest, end - at);
    at = end + 1;
  }
  return longest;
}

outcome checked(const std::string& arguments) {
  const outcome o = run_command(arguments);
  INFO(arguments.substr(0, 300) << " said: " << o.err.substr(0, 2000));
  CHECK(harmless(o.err));
  CHECK(harmless(o.out));
  CHECK(longest_line(o.err) <= 400);
  return o;
}

/// An error about this file, which holds whatever it holds.
void names_it(const std::string& arguments, const std::string& file) {
  const outcome o = checked(arguments);
  INFO(arguments.substr(0, 300) << " said: " << o.err);
  CHECK(o.code == 1);
  CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
  CHECK(o.err.find(file) != std::string::npos);
}

/// Names that a URDF may hold, spelt for XML; and names that are refused: control characters, and very long ones.
const std::vector<std::string>& xml_names() {
  static const std::vector<std::string> names = {"plain", "turned &#x202E;eerf",
                                                 "gr\xc3\xb6\xc3\x9f"
                                                 "e \xe2\x82\xac \xf0\x9f\xa4\x96",
                                                 std::string(100, 'n'), "mark&#xFEFF;"};
  return names;
}
const std::vector<std::string>& refused_names() {
  static const std::vector<std::string> names = {
      "a&#27;[2J&#10;state     free", "tab&#9;", "bell&#7;", "del&#127;", "csi&#155;2J", "", std::string(101, 'n'),
      std::string(2000000, 'm')};
  return names;
}

std::string robot(const std::string& link, const std::string& joint = "j", const std::string& box = "1 1 1") {
  return "<robot name=\"r\"><link name=\"" + link + "\"><visual><geometry><box size=\"" + box +
         "\"/></geometry></visual></link><link name=\"b\"/>" + "<joint name=\"" + joint +
         "\" type=\"revolute\"><parent link=\"" + link +
         "\"/><child link=\"b\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>";
}

}  // namespace

TEST_CASE("printable text is valid UTF-8 that controls nothing, and a short text is kept as it is") {
  std::string all;
  for (int round = 0; round < 4000; ++round) {
    std::string text;
    for (int i = 0; i < 20; ++i) text += char((round * 7919 + i * 104729 + (round >> 3) * i) % 256);
    const std::string shown = io::printable(text);
    CHECK(harmless(shown));
    for (const std::size_t most : {8u, 9u, 10u, 11u, 12u, 25u}) {
      CHECK(io::shortened(shown, most).size() <= most);
      CHECK(harmless(io::shortened(shown, most)));
    }
    all += text;
  }
  CHECK(io::sentence(all).size() <= 400);
  for (const std::string text : {"", "plain",
                                 "gr\xc3\xb6\xc3\x9f"
                                 "e",
                                 "\xf0\x9f\xa4\x96"})
    CHECK(io::printable(text) == text);
  CHECK(io::printable(std::string_view("a\0b\n\x1b", 5)) == "a\\x00b\\x0a\\x1b");
  for (const char* bad : {"\xc0\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82", "\x80", "\xff"})
    CHECK(io::printable(bad).starts_with("\\x"));
  const std::string about = io::sentence_about(std::string(5000, 'f'), std::string(5000, 'w') + " end");
  CHECK(about.size() <= 380);
  CHECK(about.starts_with("fff"));
  CHECK(about.ends_with(" end"));
}

TEST_CASE("names of links and joints reach terminal, JSON and scene in a form that harms none") {
  const scratch_file cloud(".xyz", "3 0.1 0.1\n"), scene(".glb"), spheres(".ist"), yaml(".yaml");
  for (const std::string& name : xml_names()) {
    const scratch_file urdf(".urdf", robot(name));
    const std::string ask = "query --model triangles --backend host --robot " + urdf.path + " --cloud " + cloud.path;
    const outcome text = checked(ask);
    INFO(name.substr(0, 100) << ": " << text.err);
    CHECK(text.code == 0);
    CHECK(text.err.find("has no collision geometry") != std::string::npos);
    const outcome o = checked(ask + " --json --scene " + scene.path);
    CHECK(o.code == 0);
    CHECK_FALSE(parsed(o).at("part").get<std::string>().empty());
    std::ifstream in(scene.path, std::ios::binary);
    const std::string glb(std::istreambuf_iterator<char>(in), {});
    REQUIRE(glb.size() > 20);
    std::uint32_t size = 0;
    std::memcpy(&size, glb.data() + 12, 4);
    CHECK(harmless(std::string_view(glb).substr(20, size)));
    CHECK(nlohmann::json::accept(glb.substr(20, size)));
    const scratch_file csv(".csv", "j\n0\n");
    CHECK(checked("plan --csv --model triangles --backend host --robot " + urdf.path + " --cloud " + cloud.path +
                  " --configurations " + csv.path)
              .code == 0);
    if (name.size() > 100000) continue;
    checked("pack " + urdf.path + " --spheres 20 --out " + spheres.path + " --out " + yaml.path);
    CHECK(checked("info " + spheres.path).code == 0);
    CHECK(checked("info --json " + spheres.path).code == 0);
    CHECK(checked("info " + yaml.path).code == 0);
    CHECK(checked("query --backend host --robot " + urdf.path + " --cloud " + cloud.path + " --packing " +
                  spheres.path + " --json")
              .code == 0);
  }
}

TEST_CASE("names that would steer a terminal, and names longer than a line, are refused of links and joints") {
  const scratch_file cloud(".xyz", "3 0.1 0.1\n");
  for (const std::string& name : refused_names())
    for (const std::string& text : {robot(name), robot("a", name)}) {
      const scratch_file urdf(".urdf", text);
      names_it("query --model triangles --backend host --joints 0 --cloud " + cloud.path + " --robot " + urdf.path,
               urdf.path);
    }
}

TEST_CASE("a refusal is one short printable line that names its file, whatever is in it") {
  const scratch_file good(".urdf", robot("a")), cloud(".xyz", "3 0.1 0.1\n");
  const std::string with_cloud = "query --model triangles --backend host --robot " + good.path + " --cloud ";
  std::vector<std::string> words = {std::string("x\0y", 3),
                                    "x\x1b[2J",
                                    "\xff\xfe",
                                    std::string(80000, 'w'),
                                    std::string(2000000, '9') + "x",
                                    "\xc3\xb6",
                                    std::string(300, '\xf0')};
  for (const std::string& word : words) {
    const std::string point = "0 0 " + word + '\n';
    const std::pair<std::string, std::string> clouds[] = {
        {".xyz", point},
        {".xyz", word + '\n'},
        {".ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n" +
             point},
        {".ply", "ply\nformat ascii 1.0\n" + word + "\nend_header\n"},
        {".ply", "ply\nformat ascii 1.0\nelement " + word + " 5\nproperty " + word + " x\nend_header\n"},
        {".ply", "ply\nformat ascii 1.0\nelement " + word + " 5\nproperty int x\nelement vertex 0\nend_header\n"},
        {".pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n" + point},
        {".pcd", word + " 1\n"},
        {".pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH " + word + "\nHEIGHT 1\nDATA ascii\n"},
        {".pcd", "FIELDS " + word + " y z\nSIZE 4 4 1\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 1 1\n"}};
    for (const auto& [ending, bytes] : clouds) {
      const scratch_file file(ending, bytes);
      names_it(with_cloud + file.path, file.path);
    }
    const std::pair<std::string, std::string> spheres[] = {
        {".csv", "1,2,3," + word + "x\n"},
        {".csv", word + ",1\n"},
        {".yaml", "collision_spheres:\n  \"" + word + "\": 3\n"},
        {".yaml", "collision_spheres: " + word + '\n'},
        {".yaml", "a: 1\n\"" + word + "\": 1\n\"" + word + "\": 2\n"}};
    for (const auto& [ending, bytes] : spheres) {
      const scratch_file file(ending, bytes);
      names_it("info " + file.path, file.path);
      names_it("query --robot " + good.path + " --cloud " + cloud.path + " --packing " + file.path, file.path);
    }
    const scratch_file rows(".csv", "j\n" + word + "x\n"), head(".csv", word + "\n0\n");
    for (const auto* csv : {&rows, &head}) {
      names_it("run --model triangles --backend host --robot " + good.path + " --frames " + cloud.path +
                   " --trajectory " + csv->path,
               csv->path);
      names_it("plan --model triangles --backend host --robot " + good.path + " --cloud " + cloud.path +
                   " --configurations " + csv->path,
               csv->path);
    }
  }
  // A NUL that YAML can spell ends no sentence.
  const scratch_file nul(".yaml", "collision_spheres:\n  \"a\\0b\": 3\n");
  const outcome o = run_command("info " + nul.path);
  CHECK(o.err.find("\\x00b") != std::string::npos);
  CHECK(o.err.find("no list of spheres") != std::string::npos);
}

TEST_CASE("what is wrong with a robot is said of its file and its link or joint") {
  const scratch_file cloud(".xyz", "3 0.1 0.1\n");
  for (const std::string& name : xml_names()) {
    const scratch_file urdf(".urdf", robot("a", name)), flat(".urdf", robot(name, "j", "1 1 -1"));
    const std::string ask = "query --model triangles --backend host --cloud " + cloud.path + " --robot ";
    names_it(ask + urdf.path + " --joints 3", urdf.path);
    names_it(ask + urdf.path + " --joint nothing=1", urdf.path);
    names_it(ask + urdf.path + " --joints 1,2", "--joints");
    names_it(ask + urdf.path + " --exclude-link nothing", urdf.path);
    names_it(ask + urdf.path + " --camera-link nothing", urdf.path);
    names_it(ask + flat.path, flat.path);
  }
  const scratch_file two(
      ".urdf",
      R"(<robot name="r"><link name="near"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
    <link name="gone"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
    <joint name="j" type="fixed"><parent link="near"/><child link="gone"/><origin xyz="1e300 0 0"/></joint></robot>)");
  const std::string ask = " --model triangles --backend host --robot " + two.path;
  refuses("query --cloud " + cloud.path + ask, "link \"gone\"");
  const scratch_file list(".txt", cloud.path + '\n');
  refuses("run --frames " + list.path + ask, "link \"gone\"");
  names_it("query --cloud " + cloud.path + ask, two.path);
  const std::string far_camera = " --camera-pose 1e300,0,0,0,0,0,1";
  refuses("query --cloud " + cloud.path + " --exclude-link gone" + ask + far_camera, cloud.path);
}

TEST_CASE("where memory ends, the sentence names the file that was read") {
#if defined(CLEARANCE_SANITIZED)
  WARN("SKIPPED: the address sanitizer itself takes more addresses than this test gives");
  return;
#endif
  const scratch_file good(".urdf", robot("a")), big(".xyz", "1 2 3\n");
  std::error_code failed;
  std::filesystem::resize_file(big.path, std::uintmax_t(1) << 34, failed);  // sparse: it takes no room
  if (failed) {
    WARN("SKIPPED: no sparse file here");
    return;
  }
  const outcome o = run_command("query --model triangles --backend host --robot " + good.path + " --cloud " + big.path,
                                {}, "ulimit -v 8000000; ");
  INFO(o.err);
  CHECK(o.code == 1);
  CHECK(o.err.find(big.path + ": there is not enough memory to read it") != std::string::npos);
  for (const char* device : {"/dev/zero", "/dev/full"}) {
    const std::string link = good.path + ".xyz";
    std::filesystem::create_symlink(device, link);
    refuses("query --model triangles --backend host --robot " + good.path + " --cloud " + link, "is a device");
    std::filesystem::remove(link);
  }
}

TEST_CASE(
    "sheets that enclose nothing are noted, though together they look closed, and a closed body lies beside them") {
  const robot_folder folder;
  const std::string faces[] = {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"};
  const auto cube = [](double half) {
    std::string text;
    for (int k = 0; k < 8; ++k)
      for (const int bit : {1, 2, 4})
        text += (bit == 1 ? "v " : " ") + std::to_string(k & bit ? half : -half) + (bit == 4 ? "\n" : "");
    return text;
  };
  std::string small = cube(0.01);
  for (int k = 0; k < 6; ++k) {  // a file for each panel of a housing
    folder.put("panel" + std::to_string(k) + ".obj", cube(0.1) + "f " + faces[k] + "\n");
    small += "f " + faces[k] + "\n";
  }
  folder.put("small.obj", small);
  folder.put("c.xyz", "0 0 0.05\n");
  const auto notes = [&](const std::vector<std::string>& meshes) {
    std::string robot = "<robot name=\"r\"><link name=\"a\">";
    for (const std::string& mesh : meshes)
      robot += "<collision><geometry><mesh filename=\"" + mesh + ".obj\"/></geometry></collision>";
    folder.put("r.urdf", robot + "</link></robot>");
    const std::string at = folder.path.string();
    return parsed(run_command("query --json --model triangles --robot " + at + "/r.urdf --cloud " + at + "/c.xyz"))
        .at("notes")
        .dump();
  };
  std::vector<std::string> panels;
  for (int k = 0; k < 6; ++k) panels.push_back("panel" + std::to_string(k));
  std::vector<std::string> both = panels;
  both.push_back("small");
  CHECK(notes({"small"}) == "[]");
  CHECK(says(notes(panels), "enclose"));
  CHECK(says(notes(both), "has surfaces that enclose nothing, so no point is inside them"));
}

}  // namespace messages_test

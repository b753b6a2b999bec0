// SPDX-License-Identifier: BSD-3-Clause
// Packings in files and in the cache, as a user of the command sees them.
#include "io/robot_folder.hpp"
#include "io/scratch_file.hpp"
#include "support/places.hpp"
#include "tools/run_command.hpp"

#include <clearance/io/error.hpp>
#include <clearance/io/ist.hpp>
#include <clearance/io/spheres_file.hpp>

namespace packing_test {

using namespace clearance;

namespace {

const char* const robot_text = R"(<robot name="two">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tool"><collision><geometry><cylinder radius="0.1" length="0.3"/></geometry></collision></link>
  <link name="eye"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="tool"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-0.1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="tool"/><child link="eye"/><origin xyz="0 0 0.1"/></joint>
</robot>
)";

struct scene {
  robot_folder folder;
  std::string urdf = folder.put("two.urdf", robot_text).string(),
              cloud = folder.put("c.xyz", "5 5 5\n0.4 0.1 0.5\n0 0 1.2\n").string();
  std::string ask = "query --backend host --json --robot " + urdf + " --cloud " + cloud;
  std::string path(const std::string& name) const { return (folder.path / name).string(); }
};

/// An answer without what differs from run to run.
nlohmann::json reply_to(const std::string& arguments, const std::string& cache = {}) {
  auto j = parsed(run_command(arguments, cache));
  j.erase("seconds"), j.erase("notes");
  return j;
}

}  // namespace

TEST_CASE("clearance pack fills the links of a robot, and a query takes them from the file") {
  const scene s;
  const std::string pack = "pack " + s.urdf + " --spheres 300 --out " + s.path("r.ist") + " --out " + s.path("r.yaml") +
                           " --out " + s.path("r.glb");
  const auto j = parsed(run_command(pack + " --json"));
  REQUIRE(j.at("parts").size() == 2);
  CHECK(j.at("parts").at(0).at("name") == "base");
  CHECK(j.at("parts").at(1).at("spheres") == 300);
  CHECK(j.at("parts").at(1).at("cached") == false);
  CHECK(j.at("parts").at(1).at("gap_p95").get<double>() > j.at("parts").at(1).at("gap_mean").get<double>());
  CHECK(run_command(pack).out.find("tool") != std::string::npos);
  CHECK(io::read_bytes(s.path("r.glb")).starts_with("glTF"));

  // The file's packing gives what packing on the spot gives, all of it.
  const outcome from_file = run_command(s.ask + " --packing " + s.path("r.ist"));
  CHECK(from_file.err.empty());
  const auto direct = reply_to(s.ask + " --spheres 300");
  CHECK(reply_to(s.ask + " --packing " + s.path("r.ist")) == direct);
  CHECK(direct.at("lower").get<double>() > 0);
  // So does YAML, but for the certificate, which is made anew and is as good.
  const outcome from_yaml = run_command(s.ask + " --packing " + s.path("r.yaml"));
  const auto y = parsed(from_yaml);
  CHECK(from_yaml.err.find("have no certificate for these meshes, and were measured") != std::string::npos);
  CHECK(y.at("distance") == direct.at("distance"));
  CHECK(y.at("primitive") == direct.at("primitive"));
  CHECK(y.at("lower").get<double>() == Approx(direct.at("lower").get<double>()).margin(1e-3));
  CHECK(y.at("upper").get<double>() == Approx(direct.at("upper").get<double>()).margin(1e-6));
  refuses(s.ask + " --spheres 50 --packing " + s.path("r.ist"),
          "--spheres: is for links that are packed, and " + s.path("r.ist") + " has");
  // Without a file's link it is packed; of another mesh it is proven anew.
  CHECK(run_command(s.ask + " --spheres 50 --packing " +
                    s.folder.put("one.yml", "collision_spheres: {tool: [{center: [0,0,0], radius: 0.09}]}").string())
            .err.find("has no spheres for 1 links, which were packed") != std::string::npos);
  const std::string smaller =
      s.folder
          .put("smaller.urdf",
               std::string(robot_text).replace(std::string(robot_text).find("0.2 0.2 0.2"), 11, "0.2 0.2 0.1"))
          .string();
  const outcome other = run_command("query --backend host --json --robot " + smaller + " --cloud " + s.cloud +
                                    " --packing " + s.path("r.ist"));
  CHECK(other.err.find("the spheres of 1 links have no certificate for these meshes") != std::string::npos);
  CHECK(other.code == 0);
}

TEST_CASE("spheres that stick out, as planners use them, give a bracket that contains the distance to the mesh") {
  const scene s;
  const std::string file = s.folder
                               .put("around.yml",
                                    "collision_spheres:\n  base:\n    - {center: [0, 0, 0], radius: 0.18}\n  tool:\n"
                                    "    - {center: [0, 0, -0.09], radius: 0.12}\n    - {center: [0, 0, 0], radius: "
                                    "0.12}\n    - {center: [0, 0, 0.09], radius: 0.12}\n")
                               .string();
  for (const std::string point : {"0.4 0.1 0.5", "0 0 1.2", "0.11 0 0.5", "0.119 0 0.5", "0 0 0.15", "0.16 0 0"}) {
    const std::string cloud = s.folder.put("p.xyz", point + "\n").string();
    const std::string ask = "query --backend host --json --robot " + s.urdf + " --cloud " + cloud;
    const auto around = parsed(run_command(ask + " --packing " + file)),
               exact = parsed(run_command(ask + " --model triangles"));
    INFO(point);
    CHECK(around.at("lower").get<double>() <= exact.at("upper").get<double>());
    CHECK(around.at("upper").get<double>() >= exact.at("lower").get<double>());
    CHECK(around.at("distance").get<double>() < exact.at("distance").get<double>());
    if (exact.at("state") == "free") CHECK(around.at("state") != "collision");
  }
}

TEST_CASE("a robot is packed once, and a damaged cache is packed anew") {
  const scene s;
  const robot_folder cache;
  const std::string pack = "pack " + s.urdf + " --spheres 100 --json", where = cache.path.string();
  const auto cached = [&](const std::string& arguments, const std::string& environment) {
    const outcome o = run_command(arguments, environment);
    CHECK(o.err.empty());
    std::string which;
    const auto j = parsed(o);
    for (const auto& part : j.at("parts")) which += part.at("cached").get<bool>() ? '1' : '0';
    return which;
  };
  CHECK(cached(pack, where) == "00");
  CHECK(cached(pack, where) == "11");
  CHECK(cached(pack + " --no-cache", where) == "00");
  CHECK(cached(pack, "") == "00");
  CHECK(cached(pack + " --cache " + where, "") == "11");
  CHECK(cached("pack " + s.urdf + " --spheres 101 --json", where) == "00");
  const auto fresh = reply_to(s.ask + " --spheres 100"), kept = reply_to(s.ask + " --spheres 100", where);
  CHECK(fresh == kept);
  CHECK(run_command("demo --spheres 20", where).out.find("from those that were kept") == std::string::npos);
  CHECK(run_command("demo --spheres 20", where).out.find("from those that were kept") != std::string::npos);
  CHECK(run_command("demo --spheres 20 --no-cache", where).out.find("from those that were kept") == std::string::npos);

  int damaged = 0;
  for (const auto& entry : std::filesystem::directory_iterator(cache.path)) {
    std::string bytes = io::read_bytes(entry.path().string());
    bytes[bytes.size() - 9 - std::size_t(damaged)] ^= 0x20;
    std::ofstream(entry.path(), std::ios::binary) << (damaged % 2 ? bytes : bytes.substr(0, bytes.size() / 2));
    ++damaged;
  }
  CHECK(damaged >= 4);
  CHECK(reply_to(s.ask + " --spheres 100", where) == fresh);
  CHECK(cached(pack, where) == "11");  // repaired by the query
}

TEST_CASE("a cache that can keep nothing says so: one that is named is refused, the usual one is a note") {
  const scene s;
  const robot_folder place;
  const std::string file = place.put("file", "no folder").string(), fresh = (place.path / "a/b").string();
  const std::string pack = "pack " + s.urdf + " --spheres 20", query = s.ask + " --spheres 20";
  for (const std::string& ask : {pack, query, std::string("demo --spheres 3")}) {
    refuses(ask + " --cache " + file, "--cache: " + file + " is no folder, and none can be made");
    refuses(ask + " --cache " + file + "/in", "is no folder, and none can be made");
    const outcome usual = run_command(ask, file);
    INFO(usual.err);
    CHECK(usual.code == 0);
    CHECK(usual.err.starts_with("note: " + file + ": cannot be written to, so nothing new is kept"));
    CHECK(run_command(ask + " --no-cache", file).err.empty());
  }
  CHECK(parsed(run_command(query, file)).at("notes").size() == 1);
  CHECK(run_command(pack + " --cache " + fresh).err.empty());  // it is made
  CHECK(std::distance(std::filesystem::directory_iterator(fresh), std::filesystem::directory_iterator()) == 2);
  CHECK(run_command(s.ask + " --model triangles", file).err.empty());  // nothing is packed
}

TEST_CASE("commands at the same time share a cache") {
  const scene s;
  const robot_folder cache;
  std::vector<FILE*> running;
  for (int i = 0; i < 6; ++i)
    running.push_back(::popen(
        ("CLEARANCE_CACHE='" + cache.path.string() + "' \"" + testing::command() + "\" " + s.ask + " --spheres 80 2>&1")
            .c_str(),
        "r"));
  std::vector<nlohmann::json> answers;
  for (FILE* pipe : running) {
    REQUIRE(pipe);
    std::string out;
    char piece[4096];
    for (std::size_t n; (n = std::fread(piece, 1, sizeof piece, pipe)) > 0;) out.append(piece, n);
    CHECK(::pclose(pipe) == 0);
    answers.push_back(nlohmann::json::parse(out));
    answers.back().erase("seconds");
    CHECK(answers.back() == answers.front());
  }
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(cache.path)) {
    CHECK_NOTHROW(io::load_ist(entry.path().string()));
    ++files;
  }
  CHECK(files == 2);
}

TEST_CASE("clearance info says what is in a file of spheres") {
  const scene s;
  run_command("pack " + s.urdf + " --spheres 30 --out " + s.path("r.ist") + " --out " + s.path("r.yml"));
  const auto j = parsed(run_command("info --json " + s.path("r.ist")));
  REQUIRE(j.at("parts").size() == 2);
  CHECK(j.at("parts").at(1).at("name") == "tool");
  CHECK(j.at("parts").at(1).at("spheres") == 30);
  CHECK(j.at("parts").at(1).at("certified") == true);
  CHECK(j.at("parts").at(1).at("gap").get<double>() > 0);
  CHECK(j.at("parts").at(1).at("tolerance").get<double>() == Approx(1e-4).epsilon(0.5));
  const auto y = parsed(run_command("info --json " + s.path("r.yml")));
  CHECK(y.at("parts").at(0).at("certified") == false);
  CHECK(y.at("parts").at(0).at("gap").is_null());
  CHECK(run_command("info " + s.path("r.yml")).out.find("no certificate") != std::string::npos);
  CHECK(run_command("info " + s.path("r.ist")).out.find("30 spheres") != std::string::npos);
}

TEST_CASE("files of spheres that are damaged, foreign or of something else are one sentence and exit code 1") {
  const scene s;
  run_command("pack " + s.urdf + " --spheres 30 --out " + s.path("r.ist"));
  const std::string good = io::read_bytes(s.path("r.ist"));
  std::string bad = good;
  bad[200] ^= 4;
  const auto put = [&](const std::string& name, const std::string& bytes) {
    return s.folder.put(name, bytes).string();
  };
  struct wrong {
    std::string file, sentence;
  };
  const std::vector<wrong> cases = {
      {put("flipped.ist", bad), "is damaged (the checksum does not match)"},
      {put("cut.ist", good.substr(0, 100)), "is cut short"},
      {put("long.ist", good + "\n"), "has bytes after its end"},
      {put("empty.ist", ""), "is empty (0 bytes)"},
      {put("text.ist", "solid x\n"), "is not an .ist file"},
      {put("zip.ist", "PK\3\4"), "is not an .ist file"},
      {s.path("none.ist"), "there is no such file"},
      {put("word.csv", "x,y,z,r\n1,2,3,big\n"), "word.csv:2: \"big\" is not a number"},
      {put("radius.csv", "x,y,z,r\n1,2,3,-4\n"), "radius.csv:2: the sphere has a radius of -4"},
      {put("nothing.csv", "x,y,z,r\n"), "has no sphere"},
      {put("no.yml", "a: {b: [}"), "is no YAML"},
      {put("other.yml", "a: 1\n"), "has no collision_spheres"},
      {put("list.yml", "collision_spheres: {tool: [{center: [0, 0], radius: 1}]}"), "has no center of three numbers"},
  };
  for (const auto& each : cases) {
    refuses("info " + each.file, each.sentence);
    refuses(s.ask + " --packing " + each.file, each.sentence);
  }
  refuses("info " + s.cloud, "meshes are read from ");
  refuses(s.ask + " --packing " + s.cloud, "spheres are read from .ist, .csv, .yaml and .yml files");
  refuses("info " + s.folder.path.string(), "is a folder, not a file");
  std::filesystem::create_directories(s.path("folder.ist"));
  refuses("info " + s.path("folder.ist"), "is a folder, not a file");
  const std::string stranger = put("stranger.yml", "collision_spheres: {eye: [{center: [0, 0, 0], radius: 1}]}");
  refuses(s.ask + " --packing " + stranger,
          "has spheres for \"eye\", which is no link with geometry (--exclude-link leaves a link out)");
  CHECK(run_command(s.ask + " --exclude-link eye --spheres 20 --packing " + stranger).code == 0);
  refuses(s.ask + " --model triangles --packing " + s.path("r.ist"), "--packing: is for --model spheres");
  refuses(s.ask + " --no-cache --cache /tmp", "--no-cache: cannot be mixed with --cache");
  const std::string pack = "pack " + s.urdf + " --spheres 5 ";
  refuses(pack + "--out x.stl", "--out: x.stl is none of .ist, .csv, .yaml, .yml and .glb by its name");
  refuses(pack + "--out " + s.path("two.csv"), "a CSV file holds the spheres of one part, here are 2");
  refuses(pack + "--out /nonexistent/x.ist", "/nonexistent/x.ist: cannot be written");
  refuses(pack + "--gap -1", "--gap: must be above 0");
  refuses(pack + "--joints 1,2", "the robot has 1 movable joints, here are 2 values");
  refuses(pack + "--exclude-link nobody", "nobody");
  refuses("pack " + put("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n") + " --spheres 5 --geometry visual",
          "--geometry: is for robots");
}

TEST_CASE("packing stops where it is told to") {
  const scene s;
  const auto first = [&](const std::string& more) {
    return parsed(run_command("pack " + s.urdf + " --json " + more)).at("parts").at(0);
  };
  const auto gap = first("--spheres 5000 --gap 0.02");
  CHECK(gap.at("stopped_by") == "gap");
  CHECK(gap.at("gap").get<double>() <= 0.02);
  const auto radius = first("--spheres 5000 --smallest-radius 0.02");
  CHECK(radius.at("stopped_by") == "smallest_radius");
  CHECK(radius.at("radius_min").get<double>() >= 0.02);
  CHECK(first("--spheres 40 --seed 3").at("spheres") == 40);
}

TEST_CASE("real robots answer from their files as they do when they are packed", "[data]") {
  const std::string data = testing::data();
  if (!std::filesystem::exists(data)) {
    WARN("SKIPPED: no folder " << data);
    return;
  }
  const robot_folder folder;
  const std::string file = (folder.path / "robot.ist").string(), yaml = (folder.path / "robot.yaml").string();
  const std::string frame = data + "/clouds/kinect_seq/frame_20121214T142255.814212.pcd";
  for (const std::string robot : {"kuka_lwr_kresse/kuka.urdf", "ur5e/ur5e.urdf", "jvrc1/jvrc1.urdf"}) {
    INFO(robot);
    const std::string urdf = data + "/robots/" + robot, ask = "query --backend host --json --robot " + urdf +
                                                              " --cloud " + frame +
                                                              " --camera-pose -0.8,0.6,1.5,0,0.92388,0,0.38268";
    CHECK(run_command("pack " + urdf + " --spheres 100 --out " + file + " --out " + yaml).code == 0);
    const auto direct = reply_to(ask + " --spheres 100"), loaded = reply_to(ask + " --packing " + file),
               measured = reply_to(ask + " --packing " + yaml);
    CHECK(loaded == direct);
    CHECK(measured.at("distance") == direct.at("distance"));
    CHECK(measured.at("lower").get<double>() == Approx(direct.at("lower").get<double>()).margin(2e-3));
    const auto inside = parsed(run_command("info --json " + file));
    for (const auto& part : inside.at("parts")) CHECK(part.at("certified") == true);
  }
}

}  // namespace packing_test

// SPDX-License-Identifier: BSD-3-Clause
// Every option of every subcommand, as its --help lists them: if given, it has a value or is refused.
#include "io/scratch_file.hpp"
#include "support/places.hpp"
#include "tools/run_command.hpp"

#include <sstream>

namespace options_test {

namespace {

struct listed_option {
  std::string name;
  bool takes_value;
};

std::vector<listed_option> options_of(const std::string& subcommand) {
  const outcome help = run_command(subcommand + " --help");
  REQUIRE(help.code == 0);
  std::vector<listed_option> found;
  std::istringstream in(help.out);
  for (std::string line; std::getline(in, line);) {
    std::istringstream text(line);
    std::string name, type;
    text >> name >> type;
    if (line.starts_with("  ") && name.starts_with("--")) found.push_back({name, type == "TEXT"});
  }
  return found;
}

std::string quoted_shell(const std::string& word) { return '\'' + word + '\''; }

}  // namespace

TEST_CASE(
    "an option without a value is refused by its name, whichever it is and however it is left out, and a flag with "
    "one") {
  const scratch_file urdf(
      ".urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>)");
  const scratch_file cloud(".xyz", "0.1 0.1 0.1\n"),
      obj(".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const scratch_file csv(".csv", "\n");
  const std::pair<std::string, std::string> asked[] = {
      {"query", "--robot " + urdf.path + " --cloud " + cloud.path + " --model triangles --backend host"},
      {"run", "--robot " + urdf.path + " --frames " + cloud.path + " --model triangles --backend host"},
      {"plan", "--robot " + urdf.path + " --cloud " + cloud.path + " --configurations " + csv.path +
                   " --model triangles --backend host"},
      {"self", "--robot " + urdf.path},
      {"pack", obj.path + " --spheres 5"},
      {"demo", ""},
      {"info", ""}};
  std::size_t with_value = 0, flags = 0;
  for (const auto& [subcommand, rest] : asked)
    for (const auto& [name, takes_value] : options_of(subcommand)) {
      if (!takes_value) {
        ++flags;
        for (const std::string value : {"", "true", "false", "3", "0.02"})
          refuses(subcommand + ' ' + rest + ' ' + name + '=' + value, name + ": takes no value");
        continue;
      }
      ++with_value;
      for (const std::string& without :
           {name + " ''", name + "=", name + "=' '", name + " '\t'", name + " --json", name}) {
        const bool left_out = without == name || without.ends_with(" --json");
        if ((name == "--unseen" || name == "--fields") && left_out) continue;  // whose values may be left out
        const std::string line = subcommand + ' ' + rest + ' ' + without;
        const outcome o = run_command(line);
        INFO(line << " said: " << o.err);
        CHECK(o.code == 1);
        CHECK(o.out.empty());
        CHECK(o.err.find(name) != std::string::npos);
        CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
      }
    }
  CHECK(with_value >= 72);
  CHECK(flags >= 15);
  refuses("--version=3", "--version: takes no value");
  for (const std::string line : {"info ''", "pack '' --spheres 5", "query ''", "'' query", "pack ' ' --spheres 5"})
    refuses(line, "is empty");
}

TEST_CASE("an option takes one word each time, and a word in brackets is that word") {
  const scratch_file urdf(
      ".urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>)");
  const scratch_file cloud(".xyz", "3 0.1 0.1\n"), other(".xyz", "4 0 0\n");
  const std::string ask = "query --model triangles --backend host --json --robot " + urdf.path;
  const auto both = parsed(run_command(ask + " --cloud " + cloud.path + " --cloud " + other.path));
  CHECK(both.at("clouds").size() == 2);
  refuses(ask + " --cloud " + cloud.path + ' ' + other.path, other.path);
  refuses(ask + " --cloud " + quoted_shell("[" + cloud.path + "," + other.path + "]"), "[");
  refuses(ask + " --cloud " + cloud.path + " --exclude-link '[]'", "[]");
  CHECK(run_command(ask + " --cloud " + cloud.path + " --camera-pose -.5,0,0,0,0,0,1").code == 0);
  CHECK(run_command(ask + " --cloud " + cloud.path + " --check=-0").code == 0);
  refuses(ask + " --cloud " + cloud.path + " --check -.5", "--check: must not be negative (metres)");
  refuses(ask + " --cloud " + cloud.path + " --check=-1e-3", "--check: must not be negative (metres)");
  // A number that is too small for a double is 0, however it is spelt; one that is too large is refused.
  CHECK(run_command(ask + " --cloud " + cloud.path + " --check 0." + std::string(330, '0') + "1").code == 0);
  refuses(ask + " --cloud " + cloud.path + " --check 1" + std::string(330, '0'), "--check");
}

TEST_CASE("every limit of a mesh that a refusal names is set by that name") {
  const scratch_file dae(".dae",
                         R"(<COLLADA version="1.4.1"><asset/><library_geometries><geometry id="g"><mesh><source id="s">
    <float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor source="#a" count="4" stride="3">
    <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#s"/></vertices><triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
    <p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="w"><node id="n">
    <node id="m"><instance_geometry url="#g"/></node></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>)");
  const scratch_file urdf(".urdf", "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"file://" +
                                       dae.path + "\"/></geometry></collision></link></robot>");
  const scratch_file cloud(".xyz", "3 0.1 0.1\n"), frames(".txt", cloud.path + '\n'), csv(".csv", "\n");
  const std::string ask = " --model triangles --backend host --robot " + urdf.path;
  for (const std::string& line :
       {"query --cloud " + cloud.path + ask, "run --frames " + frames.path + ask,
        "plan --configurations " + csv.path + " --cloud " + cloud.path + ask,
        "pack " + urdf.path + " --spheres 5 --no-cache", "pack " + dae.path + " --spheres 5 --no-cache"}) {
    for (const std::string name : {"bytes", "triangles", "values", "nodes", "depth"}) {
      refuses(line + " --mesh-limit " + name + "=1", "(mesh_limits::" + name + ")");
      CHECK(run_command(line + " --mesh-limit " + name + (name == "bytes" ? "=5000" : "=1000 --mesh-limit bytes=5000"))
                .code == 0);
      CHECK(run_command(line.substr(0, line.find(' ')) + " --help").out.find(name + "=") != std::string::npos);
      for (const std::string value : {"0", "-1", "1.5", "x", "1 2", "18446744073709551616"})
        refuses(line + " --mesh-limit '" + name + '=' + value + "'", "--mesh-limit");
      refuses(line + " --mesh-limit " + name + "=1000 --mesh-limit " + name + "=1000", "twice");
    }
    refuses(line + " --mesh-limit depth=1001", "from 1 to 1000");
    refuses(line + " --mesh-limit vertices=5", "\"vertices\" is not bytes, triangles");
    refuses(line + " --mesh-limit 5", "name=value");
  }
}

TEST_CASE("the attack's empty --check is refused", "[data]") {
  const std::string folder = testing::data("/attack/");
  if (!std::filesystem::exists(folder)) {
    WARN("SKIPPED: no folder " << folder);
    return;
  }
  const std::string ask = "query --model triangles --robot " + folder + "box.urdf --cloud " + folder + "in.xyz";
  refuses(ask + " --check ''", "--check");
  CHECK(run_command(ask + " --check 0").code == 2);
}

TEST_CASE(
    "--threads is taken by all that computes, changes no answer, and is refused where it is no number of threads") {
  const scratch_file urdf(
      ".urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>)");
  const scratch_file cloud(".xyz", "1 1 1\n2 0 0\n"), csv(".csv", "\n");
  const std::string robot = " --backend host --no-cache --spheres 20 --robot " + urdf.path;
  const auto answer = [&](const std::string& more) {
    auto j = parsed(run_command("query --json" + robot + " --cloud " + cloud.path + more));
    j.erase("seconds");
    return j;
  };
  CHECK(answer(" --threads 1") == answer(""));
  CHECK(answer(" --threads 3") == answer(""));
  CHECK(run_command("plan --threads 1 --configurations " + csv.path + robot + " --cloud " + cloud.path).code == 0);
  CHECK(run_command("run --threads 1 --frames " + cloud.path + robot).code == 0);
  CHECK(run_command("pack --threads 1 --spheres 5 --no-cache " + urdf.path).code == 0);
  for (const std::string bad : {"0", "-1", "1025", "many", "1.5", "1e3"})
    refuses("query" + robot + " --cloud " + cloud.path + " --threads " + bad,
            "--threads: \"" + bad + "\" is not a whole number from 1 to 1024");
  CHECK(run_command("info --threads 1 " + cloud.path).code == 1);
}

}  // namespace options_test

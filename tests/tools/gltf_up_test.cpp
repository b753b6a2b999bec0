// SPDX-License-Identifier: BSD-3-Clause
// --gltf-up in every subcommand that reads a robot or a mesh, and the notes without it.
#include "io/gltf_files.hpp"
#include "io/robot_folder.hpp"
#include "tools/run_command.hpp"

namespace gltf_up_test {

namespace {

/// A post that is 1 m along its y, as a robot, as a mesh and beside a box that holds it; and a point above its middle.
struct scene {
  robot_folder folder;
  std::string path = folder.path.string() + "/";

  scene() {
    box_mesh post({0.2f, 1, 0.2f});
    for (auto& p : post.corners) p -= Eigen::Vector3f(0.1f, 0.5f, 0.1f);
    folder.put("post.glb", glb_of(post));
    folder.put("post.gltf", gltf_of(post, data_uri(post)));
    const auto robot = [](const std::string& shape) {
      return "<robot name=\"r\"><link name=\"a\"><collision><geometry>" + shape + "</geometry></collision></link>" +
             "<link name=\"b\"/><joint name=\"j\" type=\"prismatic\"><parent link=\"a\"/><child link=\"b\"/>"
             "<limit lower=\"-1\" upper=\"1\"/></joint></robot>";
    };
    folder.put("post.urdf", robot("<mesh filename=\"post.glb\"/>"));
    folder.put("text.urdf", robot("<mesh filename=\"post.gltf\"/>"));
    folder.put("small.urdf", robot("<box size=\"0.01 0.01 0.01\"/>"));
    folder.put("plan.csv", "j\n0\n");
    folder.put("above.xyz", "0 0 0.8\n");
    folder.put("frames/1.xyz", "0 0 0.8\n");
  }

  void checks(const std::string& words, const std::string& what) const {
    INFO(words);
    for (const auto& [up, distance] : {std::pair{" --gltf-up y", 0.3}, {" --gltf-up z", 0.7}, {"", 0.3}}) {
      const outcome o = run_command(words + up);
      INFO(o.err << o.out);
      REQUIRE(o.code == 0);
      CHECK(nlohmann::json::parse(o.out.substr(0, o.out.find("\n{")))["distance"].get<double>() == Approx(distance));
      CHECK(says(o.out + o.err, "--gltf-up") == std::string(up).empty());
    }
    refuses(words + " --gltf-up x", "--gltf-up: \"x\" is not y or z");
    CHECK(says(run_command(what + " --help").out, "--gltf-up"));
  }
};

}  // namespace

TEST_CASE("query, run and plan read glTF meshes as --gltf-up says, and say how without it") {
  const scene here;
  for (const std::string robot : {"post.urdf", "text.urdf"}) {
    const std::string with = " --model triangles --backend host --robot " + here.path + robot;
    here.checks("query" + with + " --json --cloud " + here.path + "above.xyz", "query");
    here.checks("run" + with + " --joint j=0 --frames " + here.path + "frames", "run");
    here.checks("plan" + with + " --cloud " + here.path + "above.xyz --configurations " + here.path + "plan.csv",
                "plan");
  }
  here.checks("query --model triangles --backend host --robot " + here.path + "small.urdf --attach a=" + here.path +
                  "post.glb --json --cloud " + here.path + "above.xyz",
              "query");
}

TEST_CASE("info and pack take --gltf-up for robots and meshes, and say how they read without it") {
  const scene here;
  for (const std::string file : {"post.urdf", "post.glb", "post.gltf"}) {
    const outcome silent = run_command("info " + here.path + file + " --gltf-up z"),
                  asked = run_command("info " + here.path + file);
    INFO(asked.err);
    CHECK(silent.code == 0);
    CHECK(asked.code == 0);
    CHECK_FALSE(says(silent.err, "--gltf-up"));
    CHECK(says(asked.err, "--gltf-up"));
    refuses("info " + here.path + file + " --gltf-up up", "is not y or z");
    for (const std::string up : {"y", "z", ""}) {
      const std::string out = here.path + "o.csv";
      const outcome o = run_command("pack " + here.path + file + " --spheres 20 --no-cache --out " + out +
                                    (up.empty() ? "" : " --gltf-up " + up));
      INFO(o.err);
      REQUIRE(o.code == 0);
      CHECK(says(o.err, "--gltf-up") == up.empty());
      std::ifstream in(out);
      double x = 0, y = 0, z = 0, r = 0, high = 0, far = 0;
      char comma;
      std::string head;
      for (std::getline(in, head); in >> x >> comma >> y >> comma >> z >> comma >> r;)
        high = std::max(high, std::abs(z) + r), far = std::max(far, std::abs(y) + r);
      CHECK((high > far) == (up != "z"));
    }
  }
  here.folder.put("s.csv", "0,0,0,1\n");
  refuses("info " + here.path + "s.csv --gltf-up z", "--gltf-up: is for meshes");
}

}  // namespace gltf_up_test

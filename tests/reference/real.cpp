// SPDX-License-Identifier: BSD-3-Clause
// real FOLDER POINTS SEED SHARE OF SECONDS: asks about so many points of all robots and meshes of a folder, of which
// this process takes every OF-th from SHARE on; after SECONDS it begins no more. tests/reference/reference builds it
// and adds up what it prints: a line for each object (its group, points, parts, how many of them are clean solids) and
// for each question.
#include "reference/objects.hpp"

#include <clearance/io/mesh.hpp>
#include <clearance/io/robot.hpp>

#include <chrono>
#include <filesystem>
#include <memory>

namespace {

using namespace reference;
namespace fs = std::filesystem;

struct source {
  bool robot;  ///< These take longest, so they come first.
  std::string group;
  fs::path file;
};

std::vector<source> all_sources(const fs::path& folder) {
  std::vector<source> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder / "robots"))
    if (entry.path().extension() == ".urdf")
      all.push_back({true, "robot " + entry.path().stem().string(), entry.path()});
  for (const auto& set : fs::directory_iterator(folder / "meshes"))
    if (set.is_directory())
      for (const auto& entry : fs::recursive_directory_iterator(set)) {
        const std::string kind = entry.path().extension().string();
        for (const char* known : {".obj", ".off", ".ply", ".stl", ".STL", ".dae", ".glb"})
          if (kind == known) all.push_back({false, "meshes " + set.path().filename().string(), entry.path()});
      }
  std::sort(all.begin(), all.end(),
            [](const source& a, const source& b) { return std::tie(b.robot, a.file) < std::tie(a.robot, b.file); });
  return all;
}

object load(const source& from) {
  object it{from.file.filename().string(), {}};
  if (from.file.extension() != ".urdf") {
    it.meshes.push_back(clearance::io::load_mesh(from.file));
    return it;
  }
  auto robot = std::make_shared<clearance::io::robot>(
      clearance::io::load_robot(from.file, {.geometry = clearance::io::robot_geometry::collision}));
  for (const auto& part : robot->parts()) it.meshes.push_back(part.mesh);
  it.poses = [robot](testing::dice& d) {
    auto values = robot->kinematics().rest();
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto& joint = robot->kinematics().movable(k);
      values[k] = std::clamp(values[k] + d.uniform(-1, 1), joint.lower, joint.upper);
    }
    return robot->poses(values);
  };
  return it;
}

}  // namespace

int main(int count, char** words) {
  if (count != 7) return std::fprintf(stderr, "usage: real FOLDER POINTS SEED SHARE OF SECONDS\n"), 2;
  const auto number = [&](int k) { return std::strtoull(words[k], nullptr, 10); };
  const std::uint64_t points = number(2), share = number(4), of = number(5);
  const auto start = std::chrono::steady_clock::now();
  const auto spent = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const auto all = all_sources(words[1]);
  tally t;
  for (std::size_t k = share; k < all.size(); k += of) {
    if (spent() > double(number(6))) {
      std::printf("left\t%s\t1\n", all[k].group.c_str());
      continue;
    }
    try {
      const object it = load(all[k]);
      objects_judge judge(it, unsigned(number(3) + k), t);
      judge.ask(std::max<std::uint64_t>(1, points / all.size()));
      const census& c = judge.counts();
      std::printf("object\t%s\t%llu\t%zu\t%zu\n", all[k].group.c_str(), (unsigned long long)c.points, c.parts, c.clean);
    } catch (const std::exception& e) {
      std::printf("refused\t%s\t1\t%s\n", all[k].group.c_str(), e.what());
    }
    std::fflush(stdout);
  }
  for (const auto& [question, its] : t.counts())
    std::printf("question\t%s\t%llu\t%llu\n", question.c_str(), (unsigned long long)its.first,
                (unsigned long long)its.second);
  std::fputs(t.first().c_str(), stderr);
  return t.wrong() != 0;
}

// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Something to ask about: parts with their meshes, asked as triangles and as inner spheres, in random places.

#include "reference/judge.hpp"
#include "support/random.hpp"

#include <clearance/packing/pack.hpp>
#include <clearance/usual_models.hpp>

#include <functional>
#include <optional>

namespace reference {

struct object {
  std::string name;
  std::vector<clearance::triangle_mesh> meshes;
  /// A pose for each part, in the object's frame; without it there is one part, which is the object.
  std::function<std::vector<Eigen::Isometry3d>(testing::dice&)> poses = {};
  std::size_t spheres = 100;
};

/// What was asked: points, each about both models, and how many of the parts are clean solids.
struct census {
  std::uint64_t points = 0, inside = 0;
  std::size_t parts = 0, clean = 0;
};

class objects_judge {
 public:
  static constexpr std::size_t points_of_scene = 1000;

  objects_judge(const object& it, unsigned seed, tally& t) : it_(it), dice_(seed), t_(t) {
    std::vector<clearance::closed_mesh> closed;
    for (const auto& mesh : it.meshes) {
      std::vector<solid::corners> faces;
      for (const auto& f : mesh.triangles) {
        const auto corner = [&](std::uint32_t i) {
          return place{wide(mesh.vertices[i].x()), wide(mesh.vertices[i].y()), wide(mesh.vertices[i].z())};
        };
        faces.push_back({corner(f[0]), corner(f[1]), corner(f[2])});
      }
      solids_.emplace_back(std::move(faces), mesh.shapes);
      closed.push_back(clearance::close_mesh(mesh));
    }
    triangles_.emplace(clearance::make_model<clearance::obb>(closed));
    try {
      const auto packed = clearance::pack(closed, {.count = it.spheres, .threads = 1});
      spheres_.emplace(clearance::make_model<clearance::sphere>(packed));
      for (std::size_t k = 0; k < packed.size(); ++k) balls_.push_back({&solids_[k], packed[k].spheres});
    } catch (const std::invalid_argument&) {
      // Something encloses nothing, so no spheres are in it.
    }
    for (const solid& s : solids_) bare_.push_back({&s, {}}), all_.parts += 1, all_.clean += s.clean();
  }

  /// Asks about so many points, or a few more.
  void ask(std::uint64_t points) {
    for (std::uint64_t scene = 0; all_.points < points; ++scene) one(scene);
  }
  const census& counts() const { return all_; }

 private:
  void one(std::uint64_t number) {
    t_.about = it_.name + ", scene " + std::to_string(number);
    const Eigen::Isometry3d base = dice_.pose(2);
    std::vector<Eigen::Isometry3d> poses(solids_.size(), Eigen::Isometry3d::Identity());
    if (it_.poses) poses = it_.poses(dice_);
    for (auto& pose : poses) pose = base * pose;
    const Eigen::Isometry3d cloud = dice_.pose(number % 8 == 7 ? 300 : 2);
    std::vector<clearance::vec3> points;
    while (points.size() < points_of_scene) {
      const std::size_t k = dice_.below(unsigned(solids_.size()));
      const place q = draw(k, number);
      const Eigen::Vector3d at = cloud.inverse() * (poses[k] * Eigen::Vector3d(double(q.x), double(q.y), double(q.z)));
      points.push_back({float(at.x()), float(at.y()), float(at.z())});
    }
    judge<clearance::triangle_model<>>({*triangles_, bare_, poses}, points, cloud, t_);
    all_.points += points.size();
    if (spheres_) {
      judge<clearance::sphere_model<>>({*spheres_, balls_, poses}, points, cloud, t_);
      all_.points += points.size();
    }
    ways(poses, number);
  }
  /// In one scene of three outside alone, where a state may be free: farther from the surface than any corner.
  place draw(std::size_t k, std::uint64_t number) {
    const auto& faces = solids_[k].faces();
    const auto& f = faces[dice_.below(unsigned(faces.size()))];
    const wide s = dice_.uniform(0, 1), t = dice_.uniform(0, 1) * (1 - double(s)), size = solids_[k].size() + 1e-6L;
    const auto way = wider<wide>(dice_.direction());
    const place on = f[0] + s * (f[1] - f[0]) + t * (f[2] - f[0]);
    if (number % 3 == 1) return (size * wide(dice_.uniform(1.5, 6))) * way;
    const wide off = size * wide(std::pow(10.0, dice_.uniform(-6, 0)));
    return dice_.below(3) == 0 ? wide(dice_.uniform(0, 1)) * on + off * way : on + off * way;
  }
  void ways(const std::vector<Eigen::Isometry3d>& poses, std::uint64_t number) {
    if (number % 4 != 0) return;
    wide size = 0;
    for (std::size_t k = 0; k < solids_.size(); ++k)
      size = std::max(size, solids_[k].size() + wide((poses[k].translation() - poses[0].translation()).norm()));
    const double away = double(size) * dice_.uniform(1.2, 4);
    Eigen::Isometry3d camera = dice_.pose(1);
    camera.translation() = poses[0].translation() - away * camera.linear().col(2);
    std::vector<float> depths(12 * 9);
    for (float& z : depths) z = float(away * dice_.uniform(0.2, 3));
    const auto farthest = float(away * 4);
    judge_ways<clearance::triangle_model<>>({*triangles_, bare_, poses}, depths, 12, camera, farthest, t_);
    if (spheres_) judge_ways<clearance::sphere_model<>>({*spheres_, balls_, poses}, depths, 12, camera, farthest, t_);
  }

  const object& it_;
  testing::dice dice_;
  tally& t_;
  census all_;
  std::vector<solid> solids_;
  std::vector<body> bare_, balls_;
  std::optional<clearance::triangle_model<>> triangles_;
  std::optional<clearance::sphere_model<>> spheres_;
};

}  // namespace reference

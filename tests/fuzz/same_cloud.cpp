// SPDX-License-Identifier: BSD-3-Clause
// One cloud in every encoding must be the same points, or be refused in every one.

#include "fuzz/given.hpp"

#include <clearance/io/cloud_file.hpp>

#include <liblzf/lzf.h>

#include <optional>

namespace same_cloud_target {

namespace {

using points = std::vector<Eigen::Vector3d>;

std::string number(double value, bool doubles, bool highest_first = false) {
  return doubles ? fuzz::raw(value, highest_first) : fuzz::raw(float(value), highest_first);
}

std::string lines(const points& cloud) {
  std::string made;
  for (const auto& p : cloud)
    made += fuzz::digits(p.x()) + ' ' + fuzz::digits(p.y()) + ' ' + fuzz::digits(p.z()) + '\n';
  return made;
}

std::string records(const points& cloud, bool doubles, bool highest_first = false) {
  std::string made;
  for (const auto& p : cloud)
    for (const double c : p) made += number(c, doubles, highest_first);
  return made;
}

std::string packed_axes(const points& cloud, bool doubles) {
  std::string flat;
  for (int axis = 0; axis < 3; ++axis)
    for (const auto& p : cloud) flat += number(p[axis], doubles);
  std::string packed(2 * flat.size() + 64, '\0');
  packed.resize(lzf_compress(flat.data(), unsigned(flat.size()), packed.data(), unsigned(packed.size())));
  return fuzz::raw(std::uint32_t(packed.size())) + fuzz::raw(std::uint32_t(flat.size())) + packed;
}

void read(std::string_view input) {
  fuzz::given from(input);
  const bool doubles = from.byte() % 2;
  const std::size_t count = 1 + from.byte() % 40;
  points cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = from.coordinate(doubles), y = from.coordinate(doubles), z = from.coordinate(doubles);
    cloud.emplace_back(x, y, z);
  }
  const auto pcd = [&](const std::string& data) {
    const std::string size = doubles ? "8" : "4", n = std::to_string(count);
    return "VERSION .7\nFIELDS x y z\nSIZE " + size + ' ' + size + ' ' + size + "\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
           n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + data;
  };
  const auto ply = [&](const std::string& format) {
    const std::string kind = doubles ? "double " : "float ";
    return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(count) + "\nproperty " + kind +
           "x\nproperty " + kind + "y\nproperty " + kind + "z\nend_header\n";
  };
  const std::pair<const char*, std::string> files[] = {
      {"m.xyz", lines(cloud)},
      {"m.pcd", pcd("ascii\n") + lines(cloud)},
      {"m.pcd", pcd("binary\n") + records(cloud, doubles)},
      {"m.pcd", pcd("binary_compressed\n") + packed_axes(cloud, doubles)},
      {"m.ply", ply("ascii") + lines(cloud)},
      {"m.ply", ply("binary_little_endian") + records(cloud, doubles)},
      {"m.ply", ply("binary_big_endian") + records(cloud, doubles, true)},
  };
  for (const auto& [name, content] : files) {
    fuzz::put(name, content);
    points found;
    if (!fuzz::reads(name, [&, file = name] { found = clearance::io::load_cloud(file).points; }))
      fuzz::finding("an undamaged cloud is refused: " + content);
    if (!fuzz::same(found, cloud)) fuzz::finding("another cloud: " + content);
  }
}

const fuzz::target same_cloud("same_cloud", read);

}  // namespace

}  // namespace same_cloud_target

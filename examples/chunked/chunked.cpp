// SPDX-License-Identifier: BSD-3-Clause
// A cloud in a file that may be larger than memory: example_chunked [POINTS] [FOLDER] writes one there (12 bytes a
// point), asks about it as the arm moves past, and deletes it. With `write` or `ask` for a third argument it does only
// that, and the file stays: what was just written is in memory still.
#include <clearance/chunked_query.hpp>
#include <clearance/io/mapped_cloud.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace {

/// A street of 200 m as a scanner that drives along it sees it: its left side, as far as the scanner has come.
void write_street(const std::string& file, std::size_t points) {
  std::ofstream out(file, std::ios::binary);
  std::vector<clearance::vec3> some;
  for (std::size_t i = 0; i < points; ++i) {
    some.push_back(
        {float(200 * double(i) / double(points) - 100), 1.5f + 0.01f * float(i % 7), 0.01f * float(i * 37 % 300)});
    if (some.size() == 65536 || i + 1 == points) {
      out.write(reinterpret_cast<const char*>(some.data()), std::streamsize(some.size() * sizeof(clearance::vec3)));
      some.clear();
    }
  }
  if (!out.flush()) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace

int main(int count, char** arguments) {
  const std::size_t points = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 1000000;
  const std::string_view only = count > 3 ? arguments[3] : "";
  const std::string file =
      std::string(count > 2 ? arguments[2] : std::filesystem::temp_directory_path().string()) + "/clearance_street.raw";
  int wrong = 0;
  try {
    if (only != "ask") write_street(file, points);
    if (only == "write") return 0;
    std::vector<clearance::inner_sphere> row;
    for (int k = 0; k < 64; ++k) row.push_back({{0.01f * float(k), 0, 1}, 0.05f});
    const auto arm = clearance::make_model<clearance::sphere>(std::vector<std::vector<clearance::inner_sphere>>{row});
    // [ask]
    clearance::chunked street(clearance::io::map_points(file));  // x, y, z in floats; map_pcd takes a PCD file
    clearance::chunked_query ask(clearance::host{}, arm, clearance::min_distance{});
    for (const double along : {-80.0, -79.0, 0.0, 0.1}) {
      const std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d(Eigen::Translation3d(along, 0, 0))};
      const auto start = std::chrono::steady_clock::now();
      const clearance::min_distance_result r = ask(poses, street);
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      std::printf("at %5.1f m: %.3f m to point %u; of %llu points %llu were read, in %.4f s\n", along,
                  double(r.distance), r.point, static_cast<unsigned long long>(r.seen),
                  static_cast<unsigned long long>(ask.loaded()), seconds);
      // [ask]
      wrong +=
          points <= 10000000 &&
          r.point !=
              clearance::ask(clearance::host{}, arm, poses, street.cloud().source, clearance::min_distance{}).point;
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    wrong = 1;
  }
  if (only.empty()) std::filesystem::remove(file);
  return wrong;
}

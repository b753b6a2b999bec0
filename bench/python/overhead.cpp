// SPDX-License-Identifier: BSD-3-Clause
// The library's own time for the calls that bench/python/overhead.py makes, on the same robot and the same points.
#include <clearance/backends/host.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/query/query.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <vector>

template <class T>
std::vector<T> read(std::ifstream& file) {
  std::uint64_t count = 0;
  file.read(reinterpret_cast<char*>(&count), sizeof count);
  std::vector<T> all(count);
  file.read(reinterpret_cast<char*>(all.data()), std::streamsize(count * sizeof(T)));
  return all;
}

/// Microseconds per call: the least of several medians.
template <class F>
double time_of(F call) {
  using clock = std::chrono::steady_clock;
  double least = 1e9;
  for (int round = 0; round < 5; ++round) {
    std::vector<double> each;
    for (int i = 0; i < 1000; ++i) {
      const auto begin = clock::now();
      call();
      each.push_back(std::chrono::duration<double, std::micro>(clock::now() - begin).count());
    }
    std::nth_element(each.begin(), each.begin() + 500, each.end());
    least = std::min(least, each[500]);
  }
  return least;
}

int main(int, char** arguments) {
  std::ifstream file(arguments[1], std::ios::binary);
  const auto spheres = read<clearance::inner_sphere>(file);
  const auto matrices = read<double>(file);  // row after row
  const auto points = read<clearance::vec3>(file);
  std::vector<Eigen::Isometry3d> poses(matrices.size() / 16);
  for (std::size_t k = 0; k < poses.size(); ++k)
    poses[k].matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrices.data() + 16 * k);
  const std::size_t each = spheres.size() / poses.size();
  std::vector<std::vector<clearance::inner_sphere>> links;
  for (std::size_t k = 0; k < poses.size(); ++k)
    links.emplace_back(spheres.begin() + std::ptrdiff_t(k * each), spheres.begin() + std::ptrdiff_t((k + 1) * each));
  const auto robot = clearance::make_model<clearance::sphere>(links);
  const clearance::host cpu;
  clearance::query least(cpu, robot, clearance::min_distance{});
  clearance::query all(cpu, robot, clearance::distances{});
  double sum = 0;
  const double a = time_of([&] { sum += double(least(poses, points).distance); });
  const double b = time_of([&] { sum += double(all(poses, points).distance.back()); });
  std::printf("%.9g %.9g %.17g\n", a, b, double(least(poses, points).distance));
  return sum == sum ? 0 : 1;
}

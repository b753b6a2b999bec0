// SPDX-License-Identifier: BSD-3-Clause
// Reads one file and says what that took: `read_file mesh|cloud|image|spheres|robot FILE`. For
// tests/attack/worst-files.

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/mesh.hpp>
#include <clearance/io/png.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/io/spheres_file.hpp>

#include <cstdio>
#include <ctime>
#include <fstream>

int main(int count, char** arguments) {
  namespace io = clearance::io;
  if (count != 3) return std::fprintf(stderr, "usage: read_file mesh|cloud|image|spheres|robot FILE\n"), 2;
  const std::string kind = arguments[1], file = arguments[2];
  std::string said = "read";
  try {
    if (kind == "mesh") io::load_mesh(file);
    if (kind == "cloud") io::load_cloud(file);
    if (kind == "image") io::load_png(file);
    if (kind == "spheres") io::load_spheres(file);
    if (kind == "robot") io::load_robot(file);
  } catch (const std::runtime_error& error) {
    said = std::string(error.what()).substr(file.size());
  }
  std::ifstream status("/proc/self/status");  // getrusage would also count who started this
  long peak = 0;
  for (std::string word; status >> word;)
    if (word == "VmHWM:") status >> peak;
  std::printf("%.1f s, %ld MiB%s%s\n", double(std::clock()) / CLOCKS_PER_SEC, peak / 1024, said == "read" ? ", " : "",
              said.c_str());
}

// SPDX-License-Identifier: BSD-3-Clause
// Memory ends at every allocation of every reader and writer: it is told, nothing is lost, no file is half written, and
// the next time all is as it is with memory. glTF is left out: a JSON value of nlohmann's allocates in its destructor,
// so memory that ends there ends the program.
#include "io/robot_folder.hpp"
#include "solid/shapes.hpp"
#include "support/catch.hpp"
#include "support/failing_new.hpp"
#include "tools/small_png.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/ist.hpp>
#include <clearance/io/packing_cache.hpp>
#include <clearance/io/ply_writer.hpp>
#include <clearance/io/png.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/io/spheres_file.hpp>
#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/volume/aabb.hpp>

namespace io_faults_test {

using namespace clearance;
using testing::end_memory_everywhere, testing::end_of_memory;
namespace fs = std::filesystem;

namespace {

std::size_t entries(const fs::path& folder) {
  return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// Calls `work()`, whose result is a string, wherever memory ends. `check()` is called after each time.
template <class Work, class Check>
void end_memory_of(const std::string& what, const Work& work, const Check& check) {
  INFO(what);
  const std::string expected = work();
  const std::size_t open = entries("/proc/self/fd");
  std::string wrong;
  const auto require = [&](bool holds, const char* law, std::size_t k) {
    if (!holds && wrong.empty()) wrong = std::string(law) + " at allocation " + std::to_string(k);
  };
  const auto attempt = [&](end_of_memory& end) {
    std::string found;
    bool done = false;
    try {
      done = end.during([&] { found = work(); });
    } catch (const std::runtime_error& error) {
      require(std::string(error.what()).find("not enough memory") != std::string::npos, "another sentence", end.k);
    }
    if (done) require(found == expected, "another result", end.k);
    require(done || end.reached, "no memory, though there is", end.k);
    require(check(), "something is left, or lost", end.k);
    require(entries("/proc/self/fd") == open, "a file stays open", end.k);
    require(work() == expected, "another result afterwards", end.k);
  };
  end_of_memory never{testing::failing_allocations::none - 1, false};
  attempt(never);
  const std::size_t places =
      end_memory_everywhere(attempt, [&](std::size_t k) { require(false, "memory is lost", k); });
  CHECK(wrong == "");
  CHECK(places > 0);
}

std::string text(const triangle_mesh& m) {
  std::string all;
  for (const auto& p : m.vertices) all += std::to_string(p.x()) + ' ' + std::to_string(p.y() + p.z()) + ' ';
  for (const auto& t : m.triangles) all += std::to_string(t[0] + 10 * t[1] + 100 * t[2]) + ' ';
  return all;
}
std::string text(const std::vector<Eigen::Vector3d>& points) {
  std::string all;
  for (const auto& p : points) all += std::to_string(p.x() + 10 * p.y() + 100 * p.z()) + ' ';
  return all;
}

/// A file of each kind.
struct all_files {
  robot_folder folder;
  std::vector<fs::path> meshes, clouds, spheres;
  fs::path image, urdf;
  std::vector<io::packed_part> parts = {{.name = "a",
                                         .spheres = pack(mesh_solid(close_mesh(shapes::cube(0.1))), {.count = 8}),
                                         .solid = {},
                                         .recipe = {}}};

  all_files() {
    const std::string dae =
        "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><library_geometries>"
        "<geometry id=\"g\"><mesh><source id=\"s\"><float_array id=\"a\" count=\"9\">0 0 0 1 0 0 0 2 3</float_array>"
        "<technique_common><accessor source=\"#a\" count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/>"
        "<param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
        "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#s\"/></vertices><triangles count=\"1\">"
        "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2</p></triangles></mesh></geometry>"
        "</library_geometries><library_visual_scenes><visual_scene id=\"vs\"><node id=\"n\" xmlns:a_prefix_that_"
        "no_short_string_holds=\"x\"><instance_geometry url=\"#g\"/></node></visual_scene>"
        "</library_visual_scenes><scene><instance_visual_scene url=\"#vs\"/></scene></COLLADA>";
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    meshes = {folder.put("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\n"),
              folder.put("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              folder.put("m.stl",
                         "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                         "endloop\nendfacet\nendsolid s\n"),
              folder.put("m.ply", ply + "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              folder.put("m.dae", dae)};
    const std::string pcd = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nDATA ";
    const float numbers[] = {1, 2, 3, 4, 5, 6};
    const std::string raw(reinterpret_cast<const char*>(numbers), sizeof numbers);
    // A compressed block of 24 bytes that are copied: their number less 1, then they. Coordinate by coordinate.
    std::string packed("\x19\0\0\0\x18\0\0\0\x17", 9);
    packed += raw;
    clouds = {folder.put("c.xyz", "1 2 3\n4 5 6\n"), folder.put("text.pcd", pcd + "ascii\n1 2 3\n4 5 6\n"),
              folder.put("raw.pcd", pcd + "binary\n" + raw),
              folder.put("packed.pcd", pcd + "binary_compressed\n" + packed),
              folder.put("c.ply", ply + "end_header\n0 0 0\n1 0 0\n0 1 0\n")};
    for (const char* name : {"s.ist", "s.csv", "s.yaml"})
      io::save_spheres(parts, spheres.emplace_back(folder.path / name).string());
    image = folder.put("i.png", png(1000, 2000));
    urdf =
        folder.put("r.urdf",
                   "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"m.obj\"/></geometry>"
                   "</collision><collision><geometry><cylinder radius=\"0.1\" length=\"0.2\"/></geometry></collision>"
                   "</link><link name=\"b\"/><joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child "
                   "link=\"b\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\"/></joint></robot>");
  }
};

const auto nothing_else = [] { return true; };

}  // namespace

TEST_CASE("wherever memory ends in a reader of meshes or robots, it is told, and nothing is lost") {
  const all_files all;
  for (const auto& file : all.meshes)
    end_memory_of(file.filename().string(), [&] { return text(io::load_mesh(file)); }, nothing_else);
  end_memory_of("r.urdf", [&] { return std::to_string(io::load_robot(all.urdf).parts().size()); }, nothing_else);
}

TEST_CASE("wherever memory ends in a reader of clouds or images, it is told, and nothing is lost") {
  const all_files all;
  for (const auto& file : all.clouds)
    end_memory_of(file.filename().string(), [&] { return text(io::load_cloud(file.string()).points); }, nothing_else);
  end_memory_of("i.png", [&] { return std::to_string(io::load_png(all.image.string()).pixels[1]); }, nothing_else);
}

TEST_CASE("wherever memory ends in a reader of spheres, it is told, and nothing is lost") {
  const all_files all;
  for (const auto& file : all.spheres)
    end_memory_of(
        file.filename().string(), [&] { return io::ist_bytes(io::load_spheres(file.string())); }, nothing_else);
}

TEST_CASE("wherever memory ends in a writer, the old file stays or the new one is whole, alone") {
  const all_files all;
  std::vector<std::ifstream> held;  // so that a descriptor's name in /proc is too long for a short string
  while (held.size() < 12) held.emplace_back("/dev/null");
  const auto write = [&](const std::string& name, const auto& save) {
    const fs::path file = all.folder.put("out/" + name, "old");
    save(file.string());
    const std::string whole = io::read_bytes(file.string());
    const auto content = [&] {
      std::ifstream in(file, std::ios::binary);
      return std::string(std::istreambuf_iterator<char>(in), {});
    };
    end_memory_of(
        name,
        [&] {
          save(file.string());
          return std::string();
        },
        [&] {
          const std::string now = content();
          all.folder.put("out/" + name, "old");
          return (now == "old" || now == whole) && entries(file.parent_path()) == 1;
        });
    fs::remove(file);
  };
  for (const char* name : {"s.ist", "s.csv", "s.yaml"})
    write(name, [&](const std::string& file) { io::save_spheres(all.parts, file); });
  const std::vector<Eigen::Vector3d> points = {{1, 2, 3}, {4, 5, 6}};
  const io::ply_column columns[] = {{"distance", std::vector<float>{0.25f, 1}}};
  write("c.ply", [&](const std::string& file) { io::save_ply(file, points, columns); });
}

TEST_CASE("wherever memory ends while a tree is built or a mesh closed or packed, nothing is lost") {
  const triangle_mesh cube = shapes::cube(0.2);
  const closed_mesh closed = close_mesh(cube);
  end_memory_of("closed", [&] { return text(close_mesh(cube).surface); }, nothing_else);
  end_memory_of("a tree", [&] { return std::to_string(make_part<aabb>(closed).tree.primitives.size()); }, nothing_else);
  end_memory_of(
      "packed", [&] { return std::to_string(pack(mesh_solid(closed), {.count = 2, .threads = 1}).gap); }, nothing_else);
}

}  // namespace io_faults_test

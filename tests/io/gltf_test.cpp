// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_files.hpp"
#include "io/robot_folder.hpp"
#include "support/catch.hpp"

#include <clearance/io/mesh.hpp>
#include <clearance/io/scene.hpp>

#include <sys/stat.h>
#include <algorithm>
#include <array>
#include <random>

namespace gltf_test {

using namespace clearance;
using io::gltf_axis;
using io::load_mesh;

namespace {

const box_mesh box({1, 2, 3});

Eigen::AlignedBox3d bounds(const triangle_mesh& mesh) {
  Eigen::AlignedBox3d all;
  for (const auto& t : mesh.triangles)
    for (const auto v : t) all.extend(mesh.vertices[v]);
  return all;
}

bool same(const triangle_mesh& a, const triangle_mesh& b) {
  return a.triangles == b.triangles && std::ranges::equal(a.vertices, b.vertices);
}

std::string joined(const std::vector<std::string>& notes) {
  std::string all;
  for (const auto& note : notes) all += note + '\n';
  return all;
}

}  // namespace

TEST_CASE("glTF is read with y up, as the format has it, unless z is asked for, and says so unless asked") {
  const robot_folder folder;
  const auto file = folder.put("box.glb", glb_of(box.y_up()));
  CHECK(bounds(load_mesh(file)).sizes() == Eigen::Vector3d(1, 2, 3));
  CHECK(bounds(load_mesh(file, {}, gltf_axis::z)).sizes() == Eigen::Vector3d(1, 3, 2));
  const io::loaded_mesh silent = io::load_mesh_noted(file, {}, gltf_axis::y), asked = io::load_mesh_noted(file);
  CHECK(same(silent.mesh, asked.mesh));
  CHECK(silent.notes.empty());
  CHECK(says(joined(asked.notes), "--gltf-up z"));
  // A turn is no mirror: what is up is up, and faces still look out.
  CHECK(bounds(load_mesh(file)).min() == Eigen::Vector3d(0, 0, 0));
  double volume = 0;
  const triangle_mesh mesh = load_mesh(file);
  for (const auto& [a, b, c] : mesh.triangles)
    volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6;
  CHECK(volume == Approx(6));
}

TEST_CASE("A mesh that is written into a scene is read back where it was, unturned") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-2, 2);
  for (int run = 0; run < 20; ++run) {
    const scratch_file file(".glb");
    triangle_mesh mesh;
    for (int k = 0; k < 30; ++k)
      mesh.vertices.push_back(
          {double(float(place(random))), double(float(place(random))), double(float(place(random)))});
    for (std::uint32_t k = 0; k < 30; k += 3) mesh.triangles.push_back({k, k + 1, k + 2});
    io::save_scene({.bodies = {{.name = "b", .mesh = mesh}}, .clouds = {}, .balls = {}, .segments = {}}, file.path);
    const triangle_mesh back = load_mesh(file.path);
    REQUIRE(back.triangles.size() == mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(back.vertices[back.triangles[t][k]] == mesh.vertices[mesh.triangles[t][k]]);
  }
}

TEST_CASE("A glTF file keeps its numbers in a chunk, in data URIs or in files beside it, and is the same mesh") {
  const robot_folder folder;
  const triangle_mesh whole = load_mesh(folder.put("box.glb", glb_of(box)));
  folder.put("box data.bin", box.data());
  folder.put("sub/below.bin", box.data() + "more than is needed");
  for (const std::string& uri :
       {data_uri(box), std::string("box%20data.bin"), std::string("box data.bin"), std::string("sub/below.bin"),
        std::string("./sub/../box data.bin"), "data:;base64," + base64(box.data())}) {
    INFO(uri.substr(0, 60));
    const io::loaded_mesh read = io::load_mesh_noted(folder.put("box.gltf", gltf_of(box, uri)), {}, gltf_axis::y);
    CHECK(same(read.mesh, whole));
    CHECK(read.notes.empty());
  }
  CHECK(same(load_mesh(folder.put("marked.gltf", "\xEF\xBB\xBF" + gltf_of(box, data_uri(box)))), whole));
  nlohmann::json two = box.json();  // one buffer for each view
  const std::size_t positions = two["bufferViews"][0]["byteLength"];
  two["buffers"][0] = {{"byteLength", positions}, {"uri", "data:;base64," + base64(box.data().substr(0, positions))}};
  two["buffers"][1] = {{"byteLength", box.data().size() - positions}, {"uri", "rest.bin"}};
  two["bufferViews"][1]["buffer"] = 1, two["bufferViews"][1]["byteOffset"] = 0;
  folder.put("rest.bin", box.data().substr(positions));
  CHECK(same(load_mesh(folder.put("two.gltf", two.dump())), whole));
  // As a build tool lays a package out: links to each file of the source.
  std::filesystem::create_directories(folder.path / "install");
  folder.put("source/b.bin", box.data()), folder.put("source/b.gltf", gltf_of(box, "b.bin"));
  for (const char* name : {"b.bin", "b.gltf"})
    std::filesystem::create_symlink(folder.path / "source" / name, folder.path / "install" / name);
  CHECK(same(load_mesh(folder.path / "install/b.gltf"), whole));
}

TEST_CASE("A buffer in any other place is refused, and nothing there is read") {
  const robot_folder folder;
  folder.put("secret.bin", box.data());
  folder.put("m/beside.bin", box.data());
  std::filesystem::create_symlink(folder.path / "secret.bin", folder.path / "m/link.bin");
  std::filesystem::create_directory_symlink(folder.path, folder.path / "m/out");
  std::filesystem::create_directories(folder.path / "m/folder");
  ::mkfifo((folder.path / "m/pipe").c_str(), 0600);
  const auto refusal = [&](const std::string& uri) {
    const auto file = folder.put("m/m.gltf", gltf_of(box, uri));
    const std::string said = sentence([&] { load_mesh(file); });
    INFO(uri.substr(0, 60) << " -> " << said);
    CHECK(!said.empty());
    CHECK(said.size() <= 400);
    return said;
  };
  for (const std::string& uri :
       {std::string("../secret.bin"), std::string("..%2fsecret.bin"), std::string("folder/../../secret.bin"),
        std::string("link.bin"), std::string("out/secret.bin"), std::string("..\\secret.bin"),
        (folder.path / "secret.bin").string(), (folder.path / "m/beside.bin").string(),
        "file://" + (folder.path / "secret.bin").string(), std::string("http://example.org/b.bin"),
        std::string("/dev/zero"), std::string("/etc/passwd"), std::string("")})
    CHECK(says(refusal(uri), "only files beside this one are read"));
  for (const std::string uri : {"pipe", "folder"}) CHECK(says(refusal(uri), "no regular file"));
  CHECK(says(refusal("gone.bin"), "gone.bin"));
  CHECK(says(refusal("data:,abc"), "not base64"));
  CHECK(says(refusal("data:;base64,!!!!"), "damaged"));
  nlohmann::json none = box.json();
  CHECK(says(sentence([&] { load_mesh(folder.put("n.gltf", none.dump())); }), "neither a uri nor data"));
  none["buffers"][0]["uri"] = 7;
  CHECK(says(sentence([&] { load_mesh(folder.put("n.gltf", none.dump())); }), "is no text"));
}

TEST_CASE("Data that are cut short anywhere are refused, and what files hold counts to the limit") {
  const robot_folder folder;
  const std::string data = box.data(), coded = base64(data);
  for (std::size_t size = 0; size < coded.size(); size += 7)
    CHECK_FALSE(sentence([&] {
                  load_mesh(folder.put("m.gltf", gltf_of(box, "data:;base64," + coded.substr(0, size))));
                }).empty());
  const auto file = folder.put("f.gltf", gltf_of(box, "b.bin"));
  for (std::size_t size = 0; size < data.size(); size += 5) {
    folder.put("b.bin", data.substr(0, size));
    CHECK_FALSE(sentence([&] { load_mesh(file); }).empty());
  }
  folder.put("b.bin", data);
  const std::uint64_t both = std::filesystem::file_size(file) + data.size();
  CHECK(io::load_mesh_noted(file).bytes == both);
  CHECK(sentence([&] { load_mesh(file, {.bytes = both}); }).empty());
  CHECK(says(sentence([&] { load_mesh(file, {.bytes = both - 1}); }), "mesh_limits::bytes"));
}

TEST_CASE("What a glTF file has besides plain triangles is read, refused by name or noted, and never passed over") {
  const robot_folder folder;
  const auto with = [&](const std::string& pointer, const nlohmann::json& value) {
    nlohmann::json json = box.json();
    json[nlohmann::json::json_pointer(pointer)] = value;
    return folder.put("m.glb", glb_of(json.dump(), box.data()));
  };
  const triangle_mesh plain = load_mesh(folder.put("p.glb", glb_of(box)));
  const nlohmann::json empty = nlohmann::json::object();
  for (const auto& [where, value, name] : std::vector<std::array<std::string, 3>>{
           {"/extensionsRequired", R"(["KHR_draco_mesh_compression"])", "KHR_draco_mesh_compression"},
           {"/extensionsRequired", R"(["EXT_meshopt_compression"])", "EXT_meshopt_compression"},
           {"/extensionsRequired", R"(["VENDOR_thing"])", "VENDOR_thing"},
           {"/accessors/0/sparse", "{}", "sparse"},
           {"/meshes/0/primitives/0/targets", R"([{"POSITION": 0}])", "morph targets"},
           {"/nodes/0/skin", "0", "skin"},
           {"/nodes/0/extensions/EXT_mesh_gpu_instancing", "{}", "EXT_mesh_gpu_instancing"},
           {"/nodes/0/extensions/KHR_node_visibility", R"({"visible": false})", "KHR_node_visibility"},
           {"/nodes/0/extensions/MSFT_lod", "{}", "MSFT_lod"},
           {"/meshes/0/primitives/0/extensions/KHR_gaussian_splatting", "{}", "KHR_gaussian_splatting"},
           {"/accessors/0/normalized", "true", "three floats"},
           {"/accessors/0/componentType", "5122", "three floats"},
           {"/meshes/0/primitives/0/mode", "7", "mode 7"},
           {"/asset/version", R"("1.0")", "glTF 2 is read"},
           {"/nodes/0/scael", "2", "scael"}}) {
    const std::string said = sentence([&] { load_mesh(with(where, nlohmann::json::parse(value))); });
    INFO(where << " -> " << said);
    CHECK(says(said, name));
  }
  for (const std::string where :
       {"/extensions", "/scenes/0/extensions", "/nodes/0/extensions", "/meshes/0/extensions",
        "/meshes/0/primitives/0/extensions", "/accessors/0/extensions", "/bufferViews/1/extensions"}) {
    INFO(where);
    const io::loaded_mesh noted = io::load_mesh_noted(with(where + "/VENDOR_thing", empty), {}, gltf_axis::y);
    CHECK(same(noted.mesh, plain));
    CHECK(joined(noted.notes) == "has the extension \"VENDOR_thing\", which is not known, and is passed over\n");
    for (const std::string looks : {"KHR_materials_variants", "KHR_lights_punctual", "KHR_xmp_json_ld"})
      CHECK(io::load_mesh_noted(with(where + "/" + looks, empty), {}, gltf_axis::y).notes.empty());
  }
  // A packed copy beside the plain one does not matter; without the plain one it does.
  nlohmann::json draco = box.json();
  draco["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = empty;
  CHECK(same(load_mesh(folder.put("d.glb", glb_of(draco.dump(), box.data()))), plain));
  draco["accessors"][0].erase("bufferView");
  CHECK(says(sentence([&] { load_mesh(folder.put("d.glb", glb_of(draco.dump(), box.data()))); }), "has no data"));
  // Points and lines beside the triangles.
  nlohmann::json more = box.json();
  for (const int mode : {0, 1, 2, 3})
    more["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", mode}});
  const io::loaded_mesh lines =
      io::load_mesh_noted(folder.put("l.glb", glb_of(more.dump(), box.data())), {}, gltf_axis::y);
  CHECK(same(lines.mesh, plain));
  CHECK(joined(lines.notes) == "has points or lines, which have no surface, and are passed over\n");
  // A node outside the scene is lost only with a mesh.
  nlohmann::json camera = box.json();
  camera["nodes"].push_back({{"name", "camera"}});
  CHECK(same(load_mesh(folder.put("c.glb", glb_of(camera.dump(), box.data()))), plain));
  camera["nodes"][1]["mesh"] = 0;
  CHECK(says(sentence([&] { load_mesh(folder.put("c.glb", glb_of(camera.dump(), box.data()))); }), "would be lost"));
}

TEST_CASE("Positions that are whole numbers mean what KHR_mesh_quantization says, with the node's scale") {
  const robot_folder folder;
  const auto quantized = [&]<class T>(T, int kind, bool normalized, double unit) {
    box_mesh made({1, 2, 3});
    nlohmann::json json = made.json();
    std::string data;
    const std::size_t each = sizeof(T) == 1 ? 4 : 8;
    for (const auto& p : made.corners) {
      for (int k = 0; k < 3; ++k) data += raw_bytes(T(20 * p[k]));
      data.resize((data.size() + each - 1) / each * each, '\0');
    }
    const std::size_t positions = data.size();
    for (const auto i : made.indices) data += raw_bytes(i);
    json["accessors"][0]["componentType"] = kind, json["accessors"][0]["normalized"] = normalized;
    json["bufferViews"][0] = {{"buffer", 0}, {"byteLength", positions}, {"byteStride", each}};
    json["bufferViews"][1] = {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", data.size() - positions}};
    json["buffers"][0]["byteLength"] = data.size();
    const double scale = 1 / (20 * unit);
    for (int k = 0; k < 3; ++k) json["nodes"][0]["scale"].push_back(scale);
    CHECK_FALSE(sentence([&] { load_mesh(folder.put("q.glb", glb_of(json.dump(), data))); }).empty());
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) json[list].push_back("KHR_mesh_quantization");
    const auto box = bounds(load_mesh(folder.put("q.glb", glb_of(json.dump(), data)), {}, gltf_axis::z));
    CHECK((box.sizes() - Eigen::Vector3d(1, 2, 3)).norm() < 1e-12);
  };
  quantized(std::int8_t{}, 5120, false, 1), quantized(std::int8_t{}, 5120, true, 1.0 / 127);
  quantized(std::uint8_t{}, 5121, false, 1), quantized(std::uint8_t{}, 5121, true, 1.0 / 255);
  quantized(std::int16_t{}, 5122, false, 1), quantized(std::int16_t{}, 5122, true, 1.0 / 32767);
  quantized(std::uint16_t{}, 5123, false, 1), quantized(std::uint16_t{}, 5123, true, 1.0 / 65535);
}

}  // namespace gltf_test

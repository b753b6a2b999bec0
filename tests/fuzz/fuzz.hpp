// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One program holds all targets; `--target=NAME` chooses. tests/fuzz/fuzz builds and runs it.

#include <clearance/io/cloud.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/limits.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <cstdint>
#include <fstream>
#include <random>
#include <string>
#include <string_view>

namespace fuzz {

using bytes = std::string;

/// Reads an input, and ends the program by `finding` if a promise is broken.
using reader = void (*)(std::string_view);
/// Damages an input so that it stays close to its format.
using damager = bytes (*)(bytes, std::mt19937&);

/// Damages bytes as libFuzzer does.
bytes any_damage(const bytes& input);

/// Makes a target known by its name.
struct target {
  target(const char* name, reader read, damager damage = nullptr);
};

[[noreturn]] void finding(const std::string& why);

/// So small that a run is short. Whether the usual limits hold, tests/io/read_limits_test.cpp checks.
inline constexpr clearance::io::mesh_limits meshes{
    .bytes = 1 << 20, .triangles = 5000, .values = 20000, .nodes = 500, .depth = 20};
inline constexpr clearance::io::read_limits limits{.unfolded = 1 << 22, .piped = 1 << 22};

/// Puts the bytes into a file of the current folder.
inline void put(const std::string& file, std::string_view content) { std::ofstream(file, std::ios::binary) << content; }

/// Does `read` return? Else it must refuse the file with one sentence.
template <class Read>
bool reads(const std::string& file, Read read) {
  std::string why;
  try {
    read();
    return true;
  } catch (const std::runtime_error& error) {
    why = error.what();
  } catch (const std::exception& error) {
    finding(std::string("another exception: ") + error.what());
  }
  if (!why.starts_with(file)) finding("a refusal that does not name its file: " + why);
  if (why.size() > clearance::io::longest_sentence || why != clearance::io::printable(why))
    finding("no short sentence: " + why);
  return false;
}

/// Reads a mesh file twice. Its triangles must have corners that exist and are finite.
void read_mesh(const std::string& file, std::string_view content);

/// Reads a cloud file; written as PLY, it must be the same cloud.
void read_cloud(const std::string& file, std::string_view content);

/// Reads a file of spheres; written in its format and in .ist, it must be the same spheres.
void read_spheres(const std::string& file, std::string_view content);

/// Changes the tree of an XML document; what follows a zero byte is changed as bytes.
bytes damage_xml(bytes input, std::mt19937& random);

bool same(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b);
/// The corners of all triangles in turn.
std::vector<Eigen::Vector3d> corners(const clearance::triangle_mesh& mesh);

}  // namespace fuzz

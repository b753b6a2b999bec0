// SPDX-License-Identifier: BSD-3-Clause
#include "io/png_check.hpp"
#include "io/scratch_file.hpp"
#include "solid/shapes.hpp"
#include "support/catch.hpp"

#include <clearance/backends/host.hpp>
#include <clearance/io/bytes.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/ist.hpp>
#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstring>

namespace ist_test {

using namespace clearance;

namespace {

io::packed_part packed_box(const std::string& name, std::size_t count) {
  const closed_mesh mesh = close_mesh(shapes::box({-0.1, -0.2, -0.05}, {0.1, 0.2, 0.05}));
  io::packed_part part{
      .name = name, .spheres = pack(mesh_solid(mesh), {.count = count}), .solid = io::digest_of(mesh), .recipe = {}};
  part.tolerance = 1e-4 / 3;
  part.recipe = io::digest_of("some recipe");
  return part;
}

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// All members, bit by bit.
bool same(const packing& a, const packing& b) {
  std::vector<std::string> one, other;
  const auto bytes = [](auto& to) {
    return [&to]<class T>(const T& member) {
      if constexpr (requires { member.data(); })
        to.emplace_back(reinterpret_cast<const char*>(member.data()), member.size() * sizeof(member[0]));
      else
        to.emplace_back(reinterpret_cast<const char*>(&member), sizeof member);
    };
  };
  io::detail::for_each_member(a, bytes(one));
  io::detail::for_each_member(b, bytes(other));
  return one == other;
}

/// The bytes with another checksum that fits, as a program would write them that forges or is wrong.
std::string sealed(std::string bytes) {
  io::byte_writer sum;
  sum.put(io::png_crc(std::string_view(bytes).substr(0, bytes.size() - 4)));
  return bytes.substr(0, bytes.size() - 4) + sum.bytes();
}

std::string with(std::string bytes, std::size_t at, std::string_view replacement) {
  return sealed(bytes.replace(at, replacement.size(), replacement));
}

template <class T>
std::string little(T value) {
  io::byte_writer out;
  out.put(value);
  return out.bytes();
}

std::string refused(const std::string& bytes) {
  return refusal([&] { io::read_ist(bytes, "x.ist"); });
}

bool says(const std::string& text, const std::string& part) {
  INFO(text);
  CHECK(text.find(part) != std::string::npos);
  return text.starts_with("x.ist: ");
}

// Where things are in a file whose first part has a name of four letters.
constexpr std::size_t first_part = 24, name_at = first_part + 4, tolerance_at = name_at + 4 + 32,
                      gap_at = tolerance_at + 8, radius_min_at = gap_at + 4 * 8, stop_at = gap_at + 8 * 8,
                      count_at = stop_at + 4, spheres_at = count_at + 8;

}  // namespace

TEST_CASE("a packing comes back from an .ist file to the bit, and gives the same answers") {
  const std::vector<io::packed_part> parts = {packed_box("base", 300), packed_box("hand \xc3\xbc", 17)};
  const scratch_file file(".ist");
  io::save_ist(parts, file.path);
  const auto loaded = io::load_ist(file.path);
  REQUIRE(loaded.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(loaded[i].name == parts[i].name);
    CHECK(same(loaded[i].spheres, parts[i].spheres));
    CHECK(same_bits(loaded[i].tolerance, parts[i].tolerance));
    CHECK(loaded[i].solid == parts[i].solid);
    CHECK(loaded[i].recipe == parts[i].recipe);
    std::vector<vec3> cloud;
    for (int k = 0; k < 500; ++k)
      cloud.push_back({0.3f * std::sin(k * 1.1f), 0.4f * std::sin(k * 0.7f), 0.2f * std::cos(k * 0.3f)});
    const auto ask = [&](const packing& p) {
      return clearance::ask(host{}, make_part<sphere>(p, {.tolerance = parts[i].tolerance}),
                            Eigen::Isometry3d::Identity(), cloud, min_distance{});
    };
    const auto a = ask(parts[i].spheres), b = ask(loaded[i].spheres);
    CHECK(same_bits(a.distance, b.distance));
    CHECK(same_bits(a.lower, b.lower));
    CHECK(same_bits(a.upper, b.upper));
    CHECK(a.point == b.point);
    CHECK(a.primitive == b.primitive);
  }
  CHECK(io::ist_bytes(loaded) == io::ist_bytes(parts));
}

TEST_CASE("a packing without a certificate keeps its infinite gap") {
  const io::packed_part part{
      .name = "", .spheres = io::uncertified({{{1, 2, 3}, 0.5f}, {{0, 0, 0}, 0.75f}}), .solid = {}, .recipe = {}};
  const scratch_file file(".ist");
  io::save_ist(std::vector{part}, file.path);
  const auto loaded = io::load_ist(file.path);
  CHECK(loaded.at(0).spheres.gap == std::numeric_limits<double>::infinity());
  CHECK(loaded[0].spheres.radius_max == 0.75);
  CHECK(!loaded[0].solid);
}

TEST_CASE("the bytes of an .ist file are as documented on every machine") {
  const io::packed_part part{
      .name = "ab", .spheres = io::uncertified({{{1, -2, 0.5f}, 0.25f}}), .tolerance = 2, .solid = {}, .recipe = {}};
  const std::string bytes = io::ist_bytes(std::vector{part});
  using namespace std::string_literals;
  const std::string inf = "\0\0\0\0\0\0\xf0\x7f"s, quarter = "\0\0\0\0\0\0\xd0\x3f"s, zero(8, '\0');
  CHECK(bytes.substr(0, bytes.size() - 4) == "\x89IST\r\n\x1a\n"s + "\1\0\0\0"s + "\1\0\0\0"s + "\xa6\0\0\0\0\0\0\0"s +
                                                 "\2\0\0\0"s + "ab" + std::string(32, '\0') + "\0\0\0\0\0\0\0\x40"s +
                                                 inf + inf + inf + zero + quarter + quarter + inf + zero +
                                                 std::string(4, '\0') + "\1\0\0\0\0\0\0\0"s + "\0\0\x80\x3f"s +
                                                 "\0\0\0\xc0"s + "\0\0\0\x3f"s + "\0\0\x80\x3e"s);
  CHECK(bytes.size() == 0xa6);
}

TEST_CASE("no byte of an .ist file can be changed, lost or added unnoticed") {
  const std::string good = io::ist_bytes(std::vector{packed_box("base", 20), packed_box("arm", 5)});
  CHECK(refused(good).empty());
  for (std::size_t i = 0; i < good.size(); ++i)
    for (const int flip : {0x01, 0x10, 0x80, 0xff}) {
      std::string bad = good;
      bad[i] = char(bad[i] ^ flip);
      if (refused(bad).empty()) FAIL("byte " << i << " can be changed");
    }
  for (std::size_t size = 0; size < good.size(); ++size)
    if (refused(good.substr(0, size)).empty()) FAIL("it can be cut to " << size << " bytes");
  says(refused(good + '\0'), "has bytes after its end");
  says(refused(good.substr(0, good.size() - 1)), "is cut short: it should have");
}

TEST_CASE("an .ist file that is not what it should be is refused with a sentence, whatever its checksum says") {
  const std::string good = io::ist_bytes(std::vector{packed_box("base", 20), packed_box("hand", 5)});
  says(refused("solid ascii"), "is not an .ist file");
  says(refused(good.substr(0, 20)), "is cut short: 20 bytes hold no header");
  says(refused(with(good, 8, little(2u))), "is of version 2, and this clearance reads version 1");
  says(refused(with(good, 8, std::string("\0\0\0\1", 4))), "big-endian");
  says(refused(with(good, 12, little(0u))), "holds no part");
  says(refused(with(good.substr(0, 28), 12, little(0u) + little(std::uint64_t(28)))), "holds no part");
  says(refused(with(good, 12, little(1u))), "bytes after its last part");
  says(refused(with(good, 12, little(3u))), "ends in the middle of a record");
  says(refused(with(good, 12, little(0xffffffffu))), "ends in the middle of a record");
  says(refused(with(good, first_part, little(0xffffffffu))), "ends in the middle of a record");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::size_t at : {tolerance_at, gap_at, radius_min_at}) {
    says(refused(with(good, at, little(nan))), "a length of part \"base\" is ");
    says(refused(with(good, at, little(-1.0))), "a length of part \"base\" is -1");
  }
  says(refused(with(good, radius_min_at, little(1e-9))), "the radii of part \"base\" are not what its figures say");
  says(refused(with(good, stop_at, little(7u))), "the reason of part \"base\" is number 7");
  says(refused(with(good, count_at, little(std::uint64_t(0)))), "there is no sphere of part \"base\"");
  for (const std::uint64_t absurd : {std::uint64_t(1) << 32, std::uint64_t(1) << 60, ~std::uint64_t(0)})
    says(refused(with(good, count_at, little(absurd))),
         "has no room for the " + std::to_string(absurd) + " spheres of part \"base\"");
  CHECK(!refused(with(good, count_at, little(std::uint64_t(19)))).empty());
  CHECK(!refused(with(good, count_at, little(std::uint64_t(21)))).empty());
  const float infinite = std::numeric_limits<float>::infinity();
  for (const float radius : {0.0f, -0.01f, infinite, std::numeric_limits<float>::quiet_NaN()})
    says(refused(with(good, spheres_at + 12, little(radius))), "sphere 0 of part \"base\" has a radius of");
  says(refused(with(good, spheres_at + 4, little(infinite))),
       "sphere 0 of part \"base\" has a centre that is not finite");
  const auto twice = std::vector{packed_box("base", 5), packed_box("base", 5)};
  says(refused(io::ist_bytes(twice)), "has two parts \"base\"");

  const scratch_file empty(".ist");
  CHECK(refusal([&] { io::load_ist(empty.path); }) == empty.path + ": is empty (0 bytes)");
  const std::string folder = std::filesystem::temp_directory_path().string();
  CHECK(refusal([&] { io::load_ist(folder); }) == folder + ": is a folder, not a file");
  CHECK(refusal([&] { io::load_ist("/nonexistent.ist"); }) == "/nonexistent.ist: there is no such file");
  CHECK(refusal([&] {
          io::save_ist(std::vector{packed_box("base", 5)}, "/nonexistent/x.ist");
        }).find("/nonexistent/x.ist") == 0);
}

TEST_CASE("what could not be loaded again is not saved") {
  const scratch_file file(".ist", "untouched");
  io::packed_part bad = packed_box("base", 5);
  bad.spheres.spheres[2].radius = not_a_number;
  CHECK_THROWS_AS(io::save_ist(std::vector{bad}, file.path), std::invalid_argument);
  CHECK_THROWS_AS(io::save_ist(std::vector<io::packed_part>{}, file.path), std::invalid_argument);
  CHECK(io::read_bytes(file.path) == "untouched");
}

}  // namespace ist_test

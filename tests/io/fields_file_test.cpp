// SPDX-License-Identifier: BSD-3-Clause
// Fields in files and in the cache.
#include "io/png_check.hpp"
#include "io/robot_folder.hpp"
#include "io/scratch_file.hpp"
#include "solid/shapes.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/same_answer.hpp"

#include <clearance/io/field_cache.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/usual_models.hpp>

#include <sys/stat.h>

#include <cmath>
#include <limits>
#include <thread>

namespace fields_file_test {

using namespace clearance;
using testing::dice;

namespace {

constexpr field_options small{20480};

sphere_model<> balls(std::uint64_t seed = 1, std::size_t parts = 2) {
  dice d(seed);
  std::vector<std::vector<inner_sphere>> bodies;
  for (std::size_t k = 0; k < parts; ++k) bodies.push_back(testing::random_spheres(d, 30, 0.3));
  return make_model<sphere>(bodies);
}
/// Two boxes, one of them open; `inside`: how often the first one's lid counts.
triangle_model<> boxes(double tolerance = 0.001, std::int8_t inside = 1) {
  std::vector both(2, close_mesh(shapes::box({-0.1, -0.2, -0.05}, {0.1, 0.2, 0.05})));
  both[0].counts[1] = inside;
  auto open = shapes::cube(0.2);
  open.triangles.resize(4);
  both[1] = close_mesh(open, {.cap = false});
  return make_model<obb>(both, part_options{.tolerance = tolerance});
}
template <class Model>
Model sampled(Model robot, const field_options& options = small) {
  auto made = with_fields(host{}, std::move(robot), options);
  REQUIRE(made.model.fields().size() == made.model.size());
  return std::move(made.model);
}

std::string_view bytes_of(const std::vector<field_cell>& cells) {
  return {reinterpret_cast<const char*>(cells.data()), cells.size() * sizeof(field_cell)};
}
template <class T>
std::string little(T value) {
  io::byte_writer out;
  out.put(value);
  return out.bytes();
}
/// With a size and a checksum that fit, as a program would write them that is wrong.
std::string sealed(std::string bytes) {
  bytes.replace(16, 8, little(std::uint64_t(bytes.size())));
  return bytes.replace(bytes.size() - 4, 4, little(io::png_crc(std::string_view(bytes).substr(0, bytes.size() - 4))));
}
std::string with(std::string bytes, std::size_t at, std::string_view replacement) {
  return sealed(bytes.replace(at, replacement.size(), replacement));
}
template <class Model>
std::string refused(const std::string& bytes, const Model& robot) {
  const std::string why = refusal([&] { io::read_fields(bytes, "x.fields", std::span(robot.parts())); });
  CHECK((why.empty() || why.starts_with("x.fields: ")));
  return why;
}

/// Where things are in a file's first part.
constexpr std::size_t key_at = 24, bytes_at = key_at + 16, count_at = bytes_at + 8, cells_at = count_at + 8;

/// All bounds of both robots have the same bits, near and far.
template <class Model>
void require_same_bounds(const Model& a, const Model& b) {
  dice d(7);
  for (std::size_t k = 0; k < a.size(); ++k)
    for (int i = 0; i < 3000; ++i) {
      const vec3 q = d.point(0.1 * std::pow(2.0, d.number(-3, 8)));
      const field_range one = a.view().fields[k](q), other = b.view().fields[k](q);
      if (to_bits(one.low) != to_bits(other.low) || to_bits(one.high) != to_bits(other.high) || one.side != other.side)
        FAIL("another bound of part " << k);
    }
}

template <class Model>
void check_round_trip(const Model& bare) {
  const Model robot = sampled(bare);
  const scratch_file file(".fields");
  io::save_fields(robot, file.path);
  const Model back = io::load_fields(file.path, bare);
  REQUIRE(back.fields().size() == robot.size());
  for (std::size_t k = 0; k < robot.size(); ++k) {
    CHECK(bytes_of(back.fields()[k].cells) == bytes_of(robot.fields()[k].cells));
    CHECK(io::field_key(back.parts()[k], back.fields()[k].shape) ==
          io::field_key(robot.parts()[k], robot.fields()[k].shape));
  }
  require_same_bounds(robot, back);
  CHECK(io::fields_bytes(back) == io::read_bytes(file.path));

  dice d(3);
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t c = 0; c < 40 * bare.size(); ++c) poses.push_back(d.pose(1));
  const auto cloud = d.points(800, 1.5);
  const auto of = [&](const Model& its) { return ask(host{}, its, poses, point_span(cloud), min_distances{}); };
  CHECK(testing::same_answer(of(bare), of(back)));
  CHECK(testing::same_answer(of(robot), of(back)));
}

std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for (const auto& each : std::filesystem::recursive_directory_iterator(folder)) count += each.is_regular_file();
  return count;
}
/// How many fields came from the cache.
template <class Model>
std::size_t found(const Model& robot, const std::filesystem::path& folder, const field_options& options = small) {
  const auto made = io::with_fields_cached(host{}, robot, options, io::field_cache(folder));
  CHECK(made.model.fields().size() == robot.size());
  return made.found;
}

}  // namespace

TEST_CASE("fields come back from a file to the bit, and give the same bounds and answers") {
  check_round_trip(balls());
  check_round_trip(boxes());
}

TEST_CASE("a field of other geometry is refused, whatever differs by a bit") {
  const auto robot = balls();
  const std::string good = io::fields_bytes(sampled(robot));
  CHECK(refused(good, robot).empty());
  const std::string another = "x.fields: the field of part 0 is of another part, or of another version of clearance";
  CHECK(refused(good, balls(2)) == another);
  CHECK(refused(good, model(std::vector{robot.parts()[1], robot.parts()[0]})) == another);
  CHECK(refused(good, balls(1, 1)) == "x.fields: holds fields of 2 parts, and the robot has 1");
  const auto changed = [&](auto change) {
    auto parts = robot.parts();
    change(parts[1]);
    return refused(good, model(parts));
  };
  const std::string second = "x.fields: the field of part 1 is of another part, or of another version of clearance";
  CHECK(changed([](auto&) {}).empty());
  CHECK(changed([](auto& p) { p.tree.primitives[7].radius = std::nextafter(p.tree.primitives[7].radius, 1.0f); }) ==
        second);
  CHECK(changed([](auto& p) { p.tree.primitives[7].center.y = -p.tree.primitives[7].center.y; }) == second);
  CHECK(changed([](auto& p) { p.facts.tolerance = 1e-4f; }) == second);
  CHECK(changed([](auto& p) { p.facts.radius = std::nextafter(p.facts.radius, 9.0f); }) == second);
  CHECK(changed([](auto& p) { p.facts.radius = infinity; }) ==
        "x.fields: the field of part 1: a part without a finite size has no field");
  CHECK(changed([](auto& p) { p.facts.gap = 1; }).empty());  // is not asked by a field

  const std::string solid = io::fields_bytes(sampled(boxes()));
  CHECK(refused(solid, boxes()).empty());
  CHECK(refused(solid, boxes(0.002)) == another);
  CHECK(refused(solid, boxes(0.001, -1)) == another);  // the same triangles, but another inside
  CHECK(refused(solid, robot) == another);
  CHECK(refused(good, boxes()) == another);
}

TEST_CASE("no byte of a file of fields can be changed, lost or added unnoticed") {
  const auto robot = balls(1, 1);
  const std::string good = io::fields_bytes(sampled(robot));
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = char(bad[i] ^ (1 << i % 8));
    if (refused(bad, robot).empty()) FAIL("byte " << i << " can be changed");
  }
  for (std::size_t size = 0; size < good.size(); size += size < 100 ? 1 : 97)
    if (refused(good.substr(0, size), robot).empty()) FAIL("it can be cut to " << size << " bytes");
  CHECK(says(refused(good + '\0', robot), "has bytes after its end"));
  CHECK(says(refused(good.substr(0, good.size() - 1), robot), "is cut short: it should have"));
}

TEST_CASE("a file of fields that is not what it should be is refused with a sentence, whatever its checksum says") {
  const auto robot = balls(1, 1);
  const auto fielded = sampled(robot);
  const std::string good = io::fields_bytes(fielded);
  const auto says_of = [&](const std::string& bytes, const std::string& part) {
    INFO(refused(bytes, robot));
    CHECK(says(refused(bytes, robot), part));
  };
  CHECK(refused(sealed(good), robot).empty());
  says_of("solid ascii", "is not a .fields file");
  says_of(good.substr(0, 20), "is cut short: 20 bytes hold no header");
  says_of(with(good, 8, little(2u)), "is of version 2, and this clearance reads version 1");
  says_of(with(good, 8, std::string("\0\0\0\1", 4)), "big-endian");
  says_of(with(good, 12, little(0u)), "holds no part");
  says_of(with(good, 12, little(2u)), "holds fields of 2 parts, and the robot has 1");
  says_of(with(good, 12, little(~0u)), "holds fields of 4294967295 parts");
  for (std::size_t i = key_at; i < bytes_at; ++i)
    says_of(with(good, i, std::string(1, char(good[i] ^ 1))), "of another");
  for (const std::uint64_t few : {0, 1, 20479}) says_of(with(good, bytes_at, little(few)), "bytes are too few");
  for (const std::uint64_t many : {std::uint64_t(good.size()), std::uint64_t(1) << 40, ~std::uint64_t(0)})
    says_of(with(good, bytes_at, little(many)), "bytes, which are not there");
  says_of(with(good, bytes_at, little(std::uint64_t(20480 + 40))), "of another part");  // other boxes
  const std::uint64_t cells = fielded.fields()[0].cells.size();
  for (const std::uint64_t other : {std::uint64_t(0), cells - 1, cells + 1, std::uint64_t(1) << 61, ~std::uint64_t(0)})
    says_of(with(good, count_at, little(other)), "has " + std::to_string(other) + " cells instead of");
  says_of(sealed(good.substr(0, good.size() - 8)), "ends in the middle of the field of part 0");
  says_of(sealed(good + std::string(8, '\0')), "has 8 bytes after its last part");
  says_of(sealed(good.substr(0, 28)), "ends in the middle of a record");
  says_of(with(good, cells_at + 8 * 17 + 7, "\3"), "has a cell that no part has");
  for (int k = 2; k < 5; ++k)
    says_of(with(good, cells_at + 8 * 17 + std::size_t(k), "\x80"), "a cell that no part has");

  const scratch_file empty(".fields");
  CHECK(refusal([&] { io::load_fields(empty.path, robot); }) == empty.path + ": is empty (0 bytes)");
  CHECK(refusal([&] { io::load_fields("/nonexistent.fields", robot); }) ==
        "/nonexistent.fields: there is no such file");
  CHECK(refusal([&] { io::save_fields(fielded, "/nonexistent/x.fields"); }).starts_with("/nonexistent/x.fields: "));
}

TEST_CASE("fields that could not be loaded again are not saved") {
  const scratch_file file(".fields", "untouched");
  auto robot = balls();
  CHECK_THROWS_AS(io::save_fields(robot, file.path), std::invalid_argument);
  CHECK_THROWS_AS(robot.set_fields(sampled(balls(2)).fields()), std::invalid_argument);  // of another robot
  robot = sampled(balls());
  auto fields = robot.fields();
  fields[1].bytes = 0;  // somebody's own
  robot.set_fields(fields);
  CHECK_THROWS_AS(io::save_fields(robot, file.path), std::invalid_argument);
  CHECK(io::read_bytes(file.path) == "untouched");
}

TEST_CASE("the bytes of a file of fields are as documented, and so are its cells: or raise field_recipe") {
  const auto part = make_part<sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 0.5f}, {{1, 0, 0}, 0.25f}});
  const auto robot = sampled(model(std::vector{part}));
  const auto& f = robot.fields()[0];
  const std::string bytes = io::fields_bytes(robot);
  using namespace std::string_literals;
  CHECK(bytes.substr(0, 16) ==
        "\x89"
        "FLD\r\n\x1a\n"s +
            "\1\0\0\0"s + "\1\0\0\0"s);
  const io::digest key = io::field_key(part, f.shape);
  CHECK(bytes.substr(key_at, 16) == std::string(key.bytes.begin(), key.bytes.end()));
  CHECK(bytes.substr(bytes_at, 16) == little(std::uint64_t(20480)) + little(std::uint64_t(f.cells.size())));
  CHECK(bytes.size() == cells_at + 8 * f.cells.size() + 4);
  const field_cell& c = f.cells[100];
  CHECK(bytes.substr(cells_at + 800, 8) == little(c.value) + little(std::uint8_t(c.way[0])) +
                                               little(std::uint8_t(c.way[1])) + little(std::uint8_t(c.way[2])) +
                                               little(c.below) + little(c.above) + little(std::uint8_t(c.side)));
  CHECK(io::png_crc("123456789") == 0xcbf43926u);
  CHECK(io::png_crc("") == 0);
#if defined(__x86_64__) && !defined(__FMA__)  // a fused sum may round otherwise, and is as right
  CHECK(key.hex() == "370b08be5256a31cd36a7ce924428741");
  CHECK(io::digest_of(bytes_of(f.cells)).hex() == "095ed4f3d05d036088cbab6adcab5ae4");
#endif
}

TEST_CASE("what was sampled once is not sampled again, and is the same to the bit") {
  const robot_folder folder;
  const auto cache = folder.path / "deep" / "cache";
  const auto robot = balls();
  CHECK(io::with_kept_fields(robot, small, io::field_cache(cache)).model.fields().empty());
  CHECK(found(robot, cache) == 0);
  CHECK(files_in(cache) == 2);
  CHECK(found(robot, cache) == 2);
  const auto kept = io::with_kept_fields(robot, small, io::field_cache(cache));
  CHECK(kept.found == 2);
  REQUIRE(kept.model.fields().size() == 2);
  const auto fresh = sampled(robot);
  for (std::size_t k = 0; k < 2; ++k)
    CHECK(bytes_of(kept.model.fields()[k].cells) == bytes_of(fresh.fields()[k].cells));
  require_same_bounds(fresh, kept.model);

  CHECK(found(robot, cache, {1 << 15}) == 0);  // others
  CHECK(found(robot, cache) == 2);
  const auto exchanged = model(std::vector{robot.parts()[1], balls(5).parts()[0]});
  const auto half = io::with_kept_fields(exchanged, small, io::field_cache(cache));
  CHECK((half.found == 0 && half.model.fields().empty()));
  const auto others = io::with_kept_fields(sampled(balls(), {1 << 15}), {1 << 16}, io::field_cache(cache));
  CHECK((others.found == 0 && others.model.fields().size() == 2));  // as it was
  CHECK(found(exchanged, cache) == 1);
  CHECK(found(boxes(), cache) == 0);
  CHECK(found(boxes(), cache) == 2);
}

TEST_CASE("without a folder no field is kept, and one that cannot be written is no error") {
  CHECK(found(balls(), {}) == 0);
  CHECK(found(balls(), {}) == 0);
  const scratch_file file(".txt", "no folder");
  for (const std::string& place : {file.path, file.path + "/below"}) CHECK(found(balls(), place) == 0);
  CHECK(io::read_bytes(file.path) == "no folder");
  auto endless = balls().parts();
  endless[1].facts.radius = infinity;
  const robot_folder folder;
  const auto made = io::with_fields_cached(host{}, model(endless), small, io::field_cache(folder.path));
  CHECK(made.without[1] == "a part without a finite size has no field");
  CHECK((made.model.fields().empty() && files_in(folder.path) == 1));
}

TEST_CASE("a damaged or foreign entry of the cache is sampled anew and repaired, and what is no file is let be") {
  const robot_folder folder;
  const auto robot = balls(1, 1), other = balls(2, 1);
  CHECK(found(robot, folder.path) == 0);
  const auto entry = std::filesystem::directory_iterator(folder.path)->path();
  const std::string good = io::read_bytes(entry.string());
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  for (const std::string& bad :
       {flipped, with(good, 8, little(2u)), good.substr(0, good.size() - 7), good + "x", std::string(),
        std::string("solid"), io::fields_bytes(sampled(other)), io::fields_bytes(sampled(balls()))}) {
    std::ofstream(entry, std::ios::binary | std::ios::trunc) << bad;
    CHECK(found(robot, folder.path) == 0);
    CHECK(io::read_bytes(entry.string()) == good);
    CHECK(found(robot, folder.path) == 1);
  }
  std::filesystem::remove(entry);
  REQUIRE(::mkfifo(entry.c_str(), 0600) == 0);  // nobody writes into it, so a reader would wait for ever
  CHECK(found(robot, folder.path) == 0);
  CHECK(std::filesystem::is_fifo(entry));
  std::filesystem::remove(entry);
  const auto elsewhere = folder.put("elsewhere", "another's");
  std::filesystem::create_symlink(elsewhere, entry);
  CHECK(found(robot, folder.path) == 0);
  CHECK(io::read_bytes(elsewhere.string()) == "another's");
}

TEST_CASE("many at once keep the same fields, and leave one whole file") {
  const robot_folder folder;
  const auto robot = balls(1, 1);
  const auto fresh = sampled(robot);
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0;
  for (int t = 0; t < 6; ++t)
    threads.emplace_back([&] {
      const io::field_cache cache(folder.path);
      for (int i = 0; i < 20; ++i) {
        if (!cache.keep(robot.parts()[0], fresh.fields()[0])) ++wrong;
        const auto its = cache.find(robot.parts()[0], small);
        if (bytes_of(its.cells) != bytes_of(fresh.fields()[0].cells)) ++wrong;
      }
    });
  for (auto& t : threads) t.join();
  CHECK(wrong == 0);
  CHECK(files_in(folder.path) == 1);
}

}  // namespace fields_file_test

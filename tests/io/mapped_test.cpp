// SPDX-License-Identifier: BSD-3-Clause
// Clouds in mapped files give the same answer as their points in memory; a bad file is reported in a sentence.
// wraps: madvise
#include "scratch_file.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/same_result.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/io/mapped_cloud.hpp>
#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <sys/resource.h>

namespace mapped_test {

using namespace testing;
using clearance::chunked, clearance::host;

extern "C" {
int __real_madvise(void*, std::size_t, int);
int broken_disk = 0;                  // what populating says instead
std::string moved_there, moved_here;  // another file takes the name of one that is open
int __wrap_madvise(void* at, std::size_t bytes, int advice) {
  if (!moved_there.empty()) std::filesystem::rename(std::exchange(moved_there, {}), moved_here);
  if (advice == 22 && broken_disk != 0) return errno = broken_disk, -1;
  return __real_madvise(at, bytes, advice);
}
}

namespace {

std::vector<vec3> some_points(std::size_t n) {
  dice d(11);
  return d.points(n, 3);
}
template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
const auto& arm() {
  static const auto model = clearance::make_model<clearance::sphere>(
      std::vector<std::vector<clearance::inner_sphere>>{{{{0, 0, 0}, 0.1f}, {{0.2f, 0, 0}, 0.1f}}});
  return model;
}
const std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d::Identity()};

template <class Cloud>
void same(Cloud cloud, const std::vector<vec3>& points) {
  chunked in_chunks(std::move(cloud), 5000);
  clearance::chunked_query query(host{}, arm(), clearance::min_distance{});
  const auto expected = clearance::ask(host{}, arm(), poses, points, clearance::min_distance{});
  CHECK(same_result(query(poses, in_chunks), expected));
  CHECK(same_result(query(poses, in_chunks), expected));
}
std::string pcd(const std::string& fields, const std::string& size, std::size_t n, const std::string& data = "binary") {
  return "VERSION .7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE F F F F\nWIDTH " + std::to_string(n) +
         "\nHEIGHT 1\nPOINTS " + std::to_string(n) + "\nDATA " + data + "\n";
}

}  // namespace

TEST_CASE("Points in a mapped file have the answer of those in memory") {
  const auto points = some_points(30011);
  const scratch_file raw(".raw", bytes_of(points)), with_header(".raw", std::string(20, 'h') + bytes_of(points));
  same(clearance::io::map_points(raw.path), points);
  same(clearance::io::map_points(with_header.path, 20), points);
  std::string records;
  for (const vec3& p : points) {
    const float zxy[4] = {p.z, 0.5f, p.x, p.y};
    records.append(reinterpret_cast<const char*>(zxy), sizeof zxy);
  }
  const scratch_file cloud(".pcd", pcd("z intensity x y", "4 4 4 4", points.size()) + records);
  same(clearance::io::map_pcd(cloud.path), points);
  clearance::strided_points<float> layout;
  layout.step = 16, layout.offset[0] = 8, layout.offset[1] = 12, layout.offset[2] = 0;
  const scratch_file odd(".bin", "odd" + records);
  same(clearance::io::map_records(odd.path, layout, 3), points);
}

TEST_CASE("What cannot be mapped is refused in a sentence") {
  using clearance::io::map_pcd, clearance::io::map_points;
  const auto points = some_points(100);
  const scratch_file empty(".raw"), cut(".raw", bytes_of(points).substr(0, 1195)), folderless(".raw", "x");
  CHECK(refusal([&] { map_points(empty.path); }) == empty.path + ": is empty (0 bytes)");
  CHECK(refusal([&] { map_points(cut.path); }).find("ends in the middle of a record of 12 bytes: it has 1195 bytes") !=
        std::string::npos);
  CHECK(refusal([&] { map_points(cut.path + "no"); }).find("there is no such file") != std::string::npos);
  CHECK(refusal([&] { map_points("/tmp"); }).find("is no regular file") != std::string::npos);
  CHECK(refusal([&] { map_points("/dev/null"); }).find("is no regular file") != std::string::npos);
  CHECK(refusal([&] { map_points(cut.path, 1201); }).find("1201 of them before the first") != std::string::npos);
  const scratch_file odd(".raw", "h" + bytes_of(points));
  CHECK(refusal([&] { map_points(odd.path, 1); }).find("no multiple of 4") != std::string::npos);
  clearance::strided_points<float> layout;
  layout.step = 8;
  CHECK(refusal([&] {
          clearance::io::map_records(odd.path, layout, 1);
        }).find("a coordinate at byte 8 of records of 8 bytes") != std::string::npos);
  layout.step = 12, layout.count = 101;
  CHECK(refusal([&] { clearance::io::map_records(odd.path, layout, 1); }).find("has 100 records, not 101") !=
        std::string::npos);

  const std::string body = bytes_of(std::vector<float>(400, 1.0f));
  const scratch_file shorter(".pcd", pcd("x y z i", "4 4 4 4", 101) + body),
      longer(".pcd", pcd("x y z i", "4 4 4 4", 99) + body);
  const scratch_file ascii(".pcd", pcd("x y z i", "4 4 4 4", 1, "ascii") + "1 2 3 4\n"),
      none(".pcd", pcd("x y z i", "4 4 4 4", 0));
  const scratch_file doubles(".pcd", pcd("x y z i", "8 8 8 8", 50) + body);
  CHECK(refusal([&] {
          map_pcd(shorter.path);
        }).find("POINTS says 101 records of 16 bytes, but the file ends 1600 bytes after the header") !=
        std::string::npos);
  CHECK(refusal([&] { map_pcd(longer.path); }).find("POINTS says 99, but 16 bytes follow the last record") !=
        std::string::npos);
  CHECK(refusal([&] { map_pcd(ascii.path); }).find("not binary") != std::string::npos);
  CHECK(refusal([&] { map_pcd(none.path); }).find("POINTS is 0") != std::string::npos);
  CHECK(refusal([&] { map_pcd(doubles.path); }).find("field x is of TYPE F and SIZE 8, not F and 4") !=
        std::string::npos);
  CHECK(map_pcd<double>(doubles.path).size() == 50);

  const std::string knot = odd.path + ".knot";
  std::filesystem::create_symlink(knot, knot);
  CHECK(refusal([&] { map_points(knot); }).find("cannot be opened for reading: ") != std::string::npos);
  std::filesystem::remove(knot);
}

TEST_CASE("No more than the beginning of a large file is looked through for a PCD header") {
  const auto resident = [] {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    return used.ru_maxrss / 1024;  // MiB
  };
  const scratch_file zeros(".pcd"), comments(".pcd", pcd("x y z i", "4 4 4 4", 1).substr(0, 60) + "#" +
                                                         std::string((1 << 20) + 10, 'c') + "\nDATA binary\n");
  std::filesystem::resize_file(zeros.path, std::uintmax_t(1) << 32);  // a hole, which takes no disk
  const auto before = resident();
  CHECK(refusal([&] { clearance::io::map_pcd(zeros.path); }).find("is no PCD header entry") != std::string::npos);
  CHECK(resident() < before + 256);
  CHECK(refusal([&] { clearance::io::map_pcd(comments.path); }).find("no DATA entry") != std::string::npos);
  // What ends at the end of the first MiB could go on after it.
  std::string header = pcd("x y z i", "4 4 4 4", 1);
  header.insert(header.find("FIELDS"), "#" + std::string((1 << 20) - header.size() - 2, 'c') + "\n");
  REQUIRE(header.size() == 1 << 20);
  const scratch_file just(".pcd", header + std::string(16, '\0')),
      less(".pcd", header.erase(header.find("cc"), 1) + std::string(16, '\0'));
  CHECK(refusal([&] { clearance::io::map_pcd(just.path); }).find("has a PCD header of 1 MiB or more") !=
        std::string::npos);
  CHECK(clearance::io::map_pcd(less.path).size() == 1);
}

TEST_CASE("A PCD file that takes the name of one that is being opened is not taken for it") {
  const auto points = some_points(100);
  auto others = some_points(300);
  std::ranges::reverse(others);
  const auto file = [](const std::vector<vec3>& all) {
    std::vector<std::array<float, 4>> records;
    for (const vec3& p : all) records.push_back({p.x, p.y, p.z, 0});
    return pcd("x y z i", "4 4 4 4", all.size()) + bytes_of(records);
  };
  const scratch_file old(".pcd", file(points)), fresh(".pcd", file(others));
  moved_there = fresh.path, moved_here = old.path;
  const auto cloud = clearance::io::map_pcd(old.path);
  CHECK(moved_there.empty());
  CHECK(cloud.size() == 100);
  CHECK(cloud.source[99].position == points[99]);
  same(clearance::io::map_pcd(old.path), others);
}

TEST_CASE("A file that changes its size, and a disk that fails, are told, and the question can be asked again") {
  const auto points = some_points(30011);
  const scratch_file raw(".raw", bytes_of(points));
  chunked cloud(clearance::io::map_points(raw.path), 5000);
  clearance::chunked_query query(host{}, arm(), clearance::min_distance{});
  const auto expected = clearance::ask(host{}, arm(), poses, points, clearance::min_distance{});
  const auto ask = [&] { query(poses, cloud); };
  std::filesystem::resize_file(raw.path, points.size() * 12 - 12);
  CHECK(refusal(ask) == raw.path + ": had 360132 bytes when it was opened, and has 360120 now");
  raw.put(bytes_of(points) + "more");
  CHECK(refusal(ask).find("has 360136 now") != std::string::npos);
  raw.put(bytes_of(points));
  broken_disk = EFAULT;
  CHECK(refusal(ask) == raw.path + ": cannot be read at byte 0: Input/output error");
  broken_disk = EINVAL;  // an older system, that reads when it is looked at
  CHECK(same_result(query(poses, cloud), expected));
  broken_disk = 0;
  CHECK(same_result(query(poses, cloud), expected));
}

}  // namespace mapped_test

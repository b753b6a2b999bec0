// SPDX-License-Identifier: BSD-3-Clause
#include "io/robot_folder.hpp"
#include "io/scratch_file.hpp"
#include "solid/shapes.hpp"
#include "support/catch.hpp"

#include <clearance/io/error.hpp>
#include <clearance/io/ist.hpp>
#include <clearance/io/packing_cache.hpp>
#include <clearance/io/spheres_file.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/solid/close_mesh.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace packing_cache_test {

using namespace clearance;

namespace {

const closed_mesh box = close_mesh(shapes::box({-0.1, -0.2, -0.05}, {0.1, 0.2, 0.05}));

struct packed {
  std::string bytes;
  bool found, ran;
};

/// Packs through a cache, and knows whether `pack` ran.
packed through(const std::filesystem::path& folder, pack_options options = {.count = 40}) {
  bool ran = false;
  options.progress = [&](std::size_t, std::size_t) { ran = true; };
  const auto [made, found] = io::pack_cached(box, options, io::packing_cache(folder));
  return {io::ist_bytes(std::vector{io::packed_part{.name = "", .spheres = made, .solid = {}, .recipe = {}}}), found,
          ran};
}

std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for (const auto& each : std::filesystem::recursive_directory_iterator(folder)) count += each.is_regular_file();
  return count;
}

/// An environment variable that is what it was afterwards.
struct variable {
  const char* name;
  std::optional<std::string> before;
  variable(const char* n, const char* value) : name(n) {
    if (const char* old = std::getenv(n)) before = old;
    value ? ::setenv(n, value, 1) : ::unsetenv(n);
  }
  variable(const variable&) = delete;
  variable& operator=(const variable&) = delete;
  ~variable() { before ? ::setenv(name, before->c_str(), 1) : ::unsetenv(name); }
};

}  // namespace

TEST_CASE("what was packed once is not packed again, and is the same to the bit") {
  const robot_folder folder;
  const auto cache = folder.path / "deep" / "cache";
  const packed first = through(cache), second = through(cache);
  CHECK((!first.found && first.ran));
  CHECK((second.found && !second.ran));
  CHECK(second.bytes == first.bytes);
  CHECK(files_in(cache) == 1);
  CHECK(!through(cache, {.count = 41}).found);
  CHECK(through(cache, {.count = 41}).found);
  CHECK(through(cache).found);
  CHECK(files_in(cache) == 2);
}

TEST_CASE("packings of different makers are kept apart") {
  const robot_folder folder;
  const io::packing_cache cache(folder.path);
  int made = 0;
  const auto other = [&] {
    return io::pack_cached(box, {.count = 20}, cache, "mine", [&](const mesh_solid& s, pack_options o) {
      ++made;
      o.count = 7;
      return pack(s, o);
    });
  };
  CHECK(io::pack_cached(box, {.count = 20}, cache).made.spheres.size() == 20);
  CHECK(other().made.spheres.size() == 7);
  CHECK(other().made.spheres.size() == 7);
  CHECK(made == 1);
  CHECK(io::pack_cached(box, {.count = 20}, cache).made.spheres.size() == 20);
  const std::vector<closed_mesh> several = {box, close_mesh(shapes::globe({0, 0, 0}, 0.1))};
  const auto three = [](const mesh_solid& s, pack_options o) {
    o.count = 3;
    return pack(s, o);
  };
  const auto both = io::pack_cached(several, {.count = 20}, cache, "mine", three);
  REQUIRE(both.size() == 2);
  CHECK((both[0].found && both[0].made.spheres.size() == 7));  // by the first of that name
  CHECK((!both[1].found && both[1].made.spheres.size() == 3));
}

TEST_CASE("several are packed beside one another, and each is kept and found by itself") {
  const robot_folder folder;
  const io::packing_cache cache(folder.path);
  const std::vector<closed_mesh> meshes = {box, close_mesh(shapes::globe({0, 0, 0}, 0.1)),
                                           close_mesh(shapes::box({0, 0, 0}, {0.3, 0.2, 0.1}))};
  const pack_options options = {.count = 40};
  const packing known = io::pack_cached(meshes[1], options, cache).made;
  const auto first = io::pack_cached(meshes, options, cache), again = io::pack_cached(meshes, options, cache);
  REQUIRE(first.size() == 3);
  REQUIRE(again.size() == 3);
  CHECK(files_in(folder.path) == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(first[i].found == (i == 1));
    CHECK(again[i].found);
    const auto alone = pack(mesh_solid(meshes[i]), options).spheres;
    for (const auto* made : {&first[i], &again[i]})
      CHECK(std::ranges::equal(made->made.spheres, alone, [](const auto& a, const auto& b) {
        return a.center == b.center && a.radius == b.radius;
      }));
  }
  CHECK(first[1].made.gap == known.gap);

  auto wrong = meshes;
  wrong[2] = close_mesh(shapes::moebius());
  try {
    io::pack_cached(wrong, {.count = 41}, cache);
    CHECK(false);
  } catch (const solid_error& error) {
    CHECK(error.index == 2);
  }
}

TEST_CASE("equal meshes are packed once, and the first bad one is named by its own number") {
  const closed_mesh globe = close_mesh(shapes::globe({0, 0, 0}, 0.1));
  std::vector<closed_mesh> meshes = {box, globe, box, box};
  std::atomic<int> ran = 0;
  std::atomic<std::size_t> told = 0;
  const auto counted = [&](const mesh_solid& s, const pack_options& o) { return ++ran, pack(s, o); };
  const auto made =
      io::pack_cached(meshes, {.count = 20}, {}, "host", counted, [&](std::size_t more) { told += more; });
  CHECK(ran == 2);
  CHECK(told == 4);
  REQUIRE(made.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto alone = pack(mesh_solid(meshes[i]), {.count = 20}).spheres;
    CHECK(std::ranges::equal(made[i].made.spheres, alone, [](const auto& a, const auto& b) {
      return a.center == b.center && a.radius == b.radius;
    }));
  }
  meshes[3] = close_mesh(shapes::moebius());
  try {
    io::pack_cached(meshes, {.count = 20}, {});
    CHECK(false);
  } catch (const solid_error& error) {
    CHECK(error.index == 3);
  }
}

TEST_CASE("without a folder nothing is kept") {
  CHECK(through({}).ran);
  CHECK(through({}).ran);
  CHECK(!io::packing_cache().find(io::packing_key(box, {})));
}

TEST_CASE("the key is of the mesh and of every option that changes the spheres, and of no other") {
  const io::digest key = io::packing_key(box, {});
  CHECK(key == io::packing_key(box, {.seconds = 3, .threads = 2, .progress = [](std::size_t, std::size_t) {}}));
  std::vector<io::digest> keys = {key};
  for (const pack_options& other : std::vector<pack_options>{{.count = 7},
                                                             {.smallest_radius = 1e-3},
                                                             {.gap_target = 1e-3},
                                                             {.seed = 1},
                                                             {.gap_per_radius = 2},
                                                             {.allow_overlap = true},
                                                             {.gap_tolerance = 0.02}})
    keys.push_back(io::packing_key(box, other));
  keys.push_back(io::packing_key(box, {}, "device"));
  closed_mesh other = box;
  other.surface.vertices[3].y() = std::nextafter(other.surface.vertices[3].y(), 1.0);
  keys.push_back(io::packing_key(other, {}));
  other = box;
  std::swap(other.surface.triangles[0], other.surface.triangles[1]);
  keys.push_back(io::packing_key(other, {}));
  other = box;
  other.counts[2] = false;
  keys.push_back(io::packing_key(other, {}));
  for (std::size_t i = 0; i < keys.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) CHECK(!(keys[i] == keys[k]));
}

TEST_CASE("a damaged entry of the cache is packed anew and repaired") {
  const robot_folder folder;
  const packed first = through(folder.path);
  const auto entry = io::packing_cache(folder.path).file(io::packing_key(box, {.count = 40}));
  const std::string good = io::read_bytes(entry.string());
  std::string flipped = good, version = good;
  flipped[good.size() / 2] ^= 1;
  version[8] = 2;
  const auto part = io::load_ist(entry.string())[0];
  auto other = part;
  other.recipe = io::packing_key(box, {.count = 41});  // undamaged, but about something else
  for (const std::string& bad : {flipped, version, good.substr(0, good.size() - 7), good + "x", std::string(),
                                 std::string("solid"), io::ist_bytes(std::vector{other})}) {
    std::ofstream(entry, std::ios::binary | std::ios::trunc) << bad;
    const packed again = through(folder.path);
    CHECK((!again.found && again.ran));
    CHECK(io::read_ist(again.bytes, "x")[0].spheres.spheres.size() == 40);
    CHECK(io::read_bytes(entry.string()).size() == good.size());
    CHECK(through(folder.path).found);
  }
  std::filesystem::remove(entry);
  std::filesystem::create_directories(entry);  // a folder in its place
  CHECK(through(folder.path).ran);
  CHECK(first.bytes.size() == through(folder.path).bytes.size());
}

TEST_CASE("what somebody else put into the cache is not waited for, followed or removed, and the packing is made") {
  const robot_folder folder;
  const packed first = through({});
  const auto entry = io::packing_cache(folder.path).file(io::packing_key(box, {.count = 40}));
  const auto made = [&](const char* what) {
    INFO(what);
    const packed now = through(folder.path);
    CHECK((now.ran && now.bytes.size() == first.bytes.size()));
  };
  REQUIRE(::mkfifo(entry.c_str(), 0600) == 0);  // nobody writes into it, so a reader would wait for ever
  made("a pipe");
  CHECK(std::filesystem::is_fifo(entry));
  std::filesystem::remove(entry);
  const auto elsewhere = folder.put("elsewhere", "another's");
  std::filesystem::create_symlink(elsewhere, entry);
  made("a link to a file");
  CHECK(io::read_bytes(elsewhere.string()) == "another's");
  std::filesystem::remove(entry);
  std::filesystem::create_symlink(folder.path / "nowhere", entry);
  made("a link to nothing");
  CHECK(!std::filesystem::exists(folder.path / "nowhere"));
  std::filesystem::remove(entry);
  CHECK(through(folder.path).ran);
  const std::string good = io::read_bytes(entry.string());
  std::string swapped = good;  // as a machine of the other byte order would write the version
  std::reverse(swapped.begin() + 8, swapped.begin() + 12);
  REQUIRE(swapped != good);
  std::ofstream(entry, std::ios::binary | std::ios::trunc) << swapped;
  made("the other byte order");
  std::filesystem::permissions(entry, std::filesystem::perms::none);
  CHECK(through(folder.path).bytes.size() == first.bytes.size());  // a root may read it all the same
}

TEST_CASE("a cache that cannot be written is no error") {
  const scratch_file file(".txt", "no folder");
  CHECK(through(file.path).ran);
  CHECK(through(file.path + "/below").ran);
  CHECK(io::read_bytes(file.path) == "no folder");
}

TEST_CASE("what was cut short by time or by a person is not kept") {
  const robot_folder folder;
  const io::packing_cache cache(folder.path);
  pack_options options{.count = 100000};
  options.cancelled = [n = 0]() mutable { return ++n > 5; };
  CHECK(io::pack_cached(box, options, cache).made.stopped_by == pack_stop::cancelled);
  CHECK(io::pack_cached(box, {.count = 1000000, .seconds = 0.05}, cache).made.stopped_by == pack_stop::time);
  CHECK(files_in(folder.path) == 0);
}

TEST_CASE("many at once pack the same, and leave one whole file") {
  const robot_folder folder;
  const io::digest key = io::packing_key(box, {.count = 12});
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 40; ++i) {
        const io::packing_cache cache(folder.path);
        if (const auto found = cache.find(key); found && found->spheres.size() != 12) ++wrong;
        if (i % 8 == 0 && io::pack_cached(box, {.count = 12}, cache).made.spheres.size() != 12) ++wrong;
        if (!cache.keep(key, io::digest_of(box), pack(mesh_solid(box), {.count = 12}))) ++wrong;
        if (!cache.find(key)) ++wrong;
      }
    });
  for (auto& t : threads) t.join();
  CHECK(wrong == 0);
  CHECK(files_in(folder.path) == 1);
}

TEST_CASE("the cache is where the environment says") {
  const variable home("HOME", "/home/somebody");
  {
    const variable own("CLEARANCE_CACHE", nullptr), xdg("XDG_CACHE_HOME", nullptr);
    CHECK(io::packing_cache::usual_folder() == "/home/somebody/.cache/clearance");
    const variable other("XDG_CACHE_HOME", "/var/cache/x");
    CHECK(io::packing_cache::usual_folder() == "/var/cache/x/clearance");
    const variable relative("XDG_CACHE_HOME", "not/absolute");
    CHECK(io::packing_cache::usual_folder() == "/home/somebody/.cache/clearance");
    const variable homeless("HOME", nullptr);
    CHECK(io::packing_cache::usual_folder().empty());
  }
  const variable own("CLEARANCE_CACHE", "/some/where");
  CHECK(io::packing_cache::usual_folder() == "/some/where");
  const variable none("CLEARANCE_CACHE", "");
  CHECK(io::packing_cache::usual_folder().empty());
}

TEST_CASE("a file of spheres is read and written by the end of its name") {
  const auto spheres = pack(mesh_solid(box), {.count = 9});
  const std::vector<io::packed_part> one = {{.name = "a", .spheres = spheres, .solid = {}, .recipe = {}}};
  const std::vector<io::packed_part> two = {one[0], {.name = "b", .spheres = spheres, .solid = {}, .recipe = {}}};
  for (const std::string end : {".ist", ".csv", ".yaml", ".yml", ".IST"}) {
    const scratch_file file(end);
    io::save_spheres(one, file.path);
    const auto back = io::load_spheres(file.path);
    REQUIRE(back.size() == 1);
    CHECK(back[0].name == (end == ".csv" ? std::filesystem::path(file.path).stem().string() : "a"));
    CHECK(back[0].spheres.spheres.size() == 9);
    CHECK(std::isfinite(back[0].spheres.gap) == (end == ".ist" || end == ".IST"));
    if (end == ".csv")
      CHECK(refusal([&] { io::save_spheres(two, file.path); }).find("holds the spheres of one part, here are 2") !=
            std::string::npos);
    else
      io::save_spheres(two, file.path);
  }
  CHECK(refusal([] { io::load_spheres("x.stl"); }) == "x.stl: spheres are read from .ist, .csv, .yaml and .yml files");
  CHECK(refusal([&] { io::save_spheres(one, "x.stl"); }) ==
        "x.stl: spheres are written to .ist, .csv, .yaml and .yml files");
}

}  // namespace packing_cache_test

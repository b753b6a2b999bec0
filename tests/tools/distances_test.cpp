// SPDX-License-Identifier: BSD-3-Clause
// `--distances` writes every point's distance into a file, and shows it in a scene.
#include "tools/small_png.hpp"
#include "tools/two_boxes.hpp"
#include "tools/written_distances.hpp"

#include <clearance/io/error.hpp>

#include <array>
#include <cmath>

namespace distances_test {

using namespace testing;

TEST_CASE("--distances writes every valid point where it is in the world, with its distance, number, part and colour") {
  const two_boxes q;
  const scratch_file ply(".ply");
  const auto j = parsed(run_command(q.ask + " --distances " + ply.path));
  CHECK(j.at("distances") == nlohmann::json({{"file", ply.path},
                                             {"points", 3},
                                             {"left_out", 1},
                                             {"beyond", 0},
                                             {"signed", false},
                                             {"d_max", nullptr},
                                             {"blue_at", 1.0}}));
  auto all = records(ply.path);
  REQUIRE(all.size() == 3);
  CHECK(all[0].x == 5);
  CHECK(all[0].distance > 7);
  CHECK(std::array{all[0].red, all[0].green, all[0].blue} == std::array{0, 0, 255});
  CHECK(all[1].z == 1.0);
  CHECK(all[1].distance == Approx(0.4));
  CHECK(all[1].part == 1);
  CHECK(all[1].point == 1);
  CHECK(all[2].point == 3);  // 2 is none
  CHECK(all[2].part == 0);
  CHECK(all[2].distance == Approx(0.2));
  CHECK(all[2].red == 255);
  CHECK(all[2].green == 204);

  const scratch_file inside(".xyz", "0 0 0\n");
  const auto cut = parsed(run_command(q.ask + " --cloud " + inside.path + " --d-max 0.3 --distances " + ply.path));
  CHECK(cut.at("distances").at("beyond") == 2);
  CHECK(cut.at("distances").at("d_max").get<double>() == Approx(0.3));
  CHECK(cut.at("distance") == 0);
  all = records(ply.path);
  REQUIRE(all.size() == 4);
  for (const int k : {0, 1}) {
    CHECK(std::isinf(all[k].distance));
    CHECK(all[k].part == -1);
    CHECK(all[k].blue == 255);
  }
  CHECK(all[3].distance == 0);
  CHECK(all[3].cloud == 1);
  CHECK(all[3].point == 0);
  CHECK(std::array{all[3].red, all[3].green, all[3].blue} == std::array{255, 0, 0});

  // The nearest of all is what the query says.
  const auto alone = parsed(run_command(q.ask));
  records(ply.path);
  CHECK(alone.at("distance").get<float>() == all[2].distance);
  const std::string text =
      run_command(q.robot + " --cloud " + q.cloud.path + " --d-max 0.3 --distances " + ply.path).out;
  CHECK(text.find(ply.path + ": 3 points, 1 left out, 2 beyond 0.3 m; red at 0 m, blue at 0.3 m\n") != text.npos);
}

TEST_CASE("positions are those of the file, moved by poses in double, and images count their pixels") {
  const two_boxes q;
  const scratch_file ply(".ply"),
      far(".xyz", "447123.0625 5411987.125 251.0\n447123.0625 5411987.125 252.0009765625\n");
  run_command(q.robot + " --base-pose 447123.0625,5411987.125,250,0,0,0,1 --cloud " + far.path + " --distances " +
              ply.path);
  auto all = records(ply.path);
  REQUIRE(all.size() == 2);
  CHECK(all[0].x == 447123.0625);
  CHECK(all[0].y == 5411987.125);
  CHECK(all[1].z == 252.0009765625);
  CHECK(all[0].distance == Approx(0.4));
  const scratch_file depth(".png", png(0, 1000));
  run_command(q.robot + " --intrinsics 500,500,0,0 --camera-pose 0,0,1,0,0,0,1 --cloud " + depth.path +
              " --distances " + ply.path);
  all = records(ply.path);
  REQUIRE(all.size() == 1);
  CHECK(all[0].point == 1);
  CHECK(all[0].z == Approx(2));
  CHECK(all[0].x == Approx(0.002));
}

TEST_CASE("without a valid point the file of distances has none, and the exit code is 3") {
  const two_boxes q;
  const scratch_file ply(".ply"), blind(".xyz", "nan nan nan\n");
  CHECK(run_command(q.robot + " --cloud " + blind.path + " --distances " + ply.path).code == 3);
  CHECK(records(ply.path).empty());
}

TEST_CASE("--scene shows the points in the colours of their distances") {
  const two_boxes q;
  const scratch_file ply(".ply"), plain(".glb"), coloured(".glb");
  CHECK(run_command(q.ask + " --scene " + plain.path).code == 0);
  CHECK(run_command(q.ask + " --scene " + coloured.path + " --distances " + ply.path).code == 0);
  const auto read = [](const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  CHECK(read(plain.path).size() == read(coloured.path).size());
  CHECK(read(plain.path) != read(coloured.path));
}

TEST_CASE("--cells changes no answer, is for --distances, and on the host says that it makes none") {
  const two_boxes q;
  const scratch_file ply(".ply"), other(".ply");
  for (const std::string d_max : {"", " --d-max 0.3"}) {
    auto plain = parsed(run_command(q.ask + d_max + " --distances " + ply.path)),
         with = parsed(run_command(q.ask + d_max + " --cells --distances " + other.path));
    CHECK(with.at("distances").at("points") == 3);
    auto& notes = with.at("notes");
    const auto note = std::find(notes.begin(), notes.end(), "--cells: none are made, because the host looks into none");
    REQUIRE(note != notes.end());
    notes.erase(note);
    for (auto* j : {&plain, &with}) j->erase("seconds"), j->at("distances").erase("file");
    CHECK(with == plain);
    CHECK(clearance::io::read_bytes(other.path) == clearance::io::read_bytes(ply.path));
  }
  refuses(q.ask + " --cells", "--cells: is for --distances");
}

TEST_CASE("--signed says how deep points are in a mesh") {
  const two_boxes q;
  const scratch_file cloud(".xyz", "0.02 0 0\n0.3 0 0\n0.05 0 0.5\n"), ply(".ply");
  const std::string ask = q.robot + " --json --cloud " + cloud.path + " --distances " + ply.path;
  const auto j = parsed(run_command(ask + " --signed"));
  CHECK(j.at("distances").at("signed") == true);
  const auto deep = records(ply.path);
  REQUIRE(deep.size() == 3);
  CHECK(std::abs(deep[0].distance + 0.08f) < 1e-6f);
  CHECK(std::abs(deep[1].distance - 0.2f) < 1e-6f);
  CHECK(std::abs(deep[2].distance + 0.05f) < 1e-6f);
  CHECK(deep[2].part == 1);
  CHECK(parsed(run_command(ask)).at("distances").at("signed") == false);
  CHECK(records(ply.path)[0].distance == 0);
}

}  // namespace distances_test

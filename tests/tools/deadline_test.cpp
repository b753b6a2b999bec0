// SPDX-License-Identifier: BSD-3-Clause
// `--deadline` answers in time, and says what it did not look at.
#include "tools/two_boxes.hpp"

namespace deadline_test {

using namespace testing;

TEST_CASE("--deadline tells how many points are unseen, and what is certain all the same") {
  const two_boxes q;
  auto plain = parsed(run_command(q.ask + " --check 0.1")),
       all = parsed(run_command(q.ask + " --check 0.1 --deadline 1e9"));
  CHECK(all.at("deadline") == nlohmann::json({{"milliseconds", 1e9}, {"unseen", 0}, {"complete", true}}));
  for (auto& part : plain.at("parts"))
    for (const char* key : {"distance", "cloud", "point", "primitive"}) part.at(key) = nullptr;
  all.erase("deadline");
  for (auto* each : {&plain, &all}) each->erase("seconds");
  CHECK(all == plain);
  CHECK_FALSE(plain.contains("deadline"));
  CHECK(run_command(q.robot + " --deadline 1e9 --cloud " + q.cloud.path)
            .out.find("deadline  1e+09 ms: all points were looked at\n") != std::string::npos);

  for (const std::string never : {"0", "-0", "0.0"}) {
    const outcome o = run_command(q.ask + " --check 0 --deadline " + never);
    CHECK(o.code == 3);
    const auto none = parsed(o);
    CHECK(none.at("state") == "no_data");
    CHECK(none.at("check").at("passes") == false);
    CHECK(none.at("points").at("seen") == 0);
    CHECK(o.out.find("\"deadline\": {\n    \"milliseconds\": 0.0,\n    \"unseen\": 4,\n    \"complete\": false\n  }") !=
          std::string::npos);
    for (const char* key : {"distance", "lower", "upper", "point", "part"}) CHECK(none.at(key).is_null());
  }
  const outcome blind = run_command(q.robot + " --deadline 0 --cloud " + q.cloud.path);
  CHECK(blind.code == 3);
  CHECK(blind.out.find("state     no data: no valid point was seen in time, so nothing is known") == 0);
  CHECK(blind.out.find("deadline  0 ms: 4 of 4 points were not looked at, and may be anywhere\n") != std::string::npos);
}

TEST_CASE("a deadline between nothing and all is no free robot") {
  const two_boxes q;
  constexpr int count = 1'000'000;
  std::string bytes = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + std::to_string(count) +
                      "\nHEIGHT 1\nPOINTS " + std::to_string(count) + "\nDATA binary\n";
  for (int i = 0; i < count; ++i) {
    const float wall[] = {1.2f + 1e-6f * float(count - i), 0.001f * float(i % 1000) - 0.5f,
                          0.001f * float(i / 1000) - 0.5f},
                zero[3] = {};
    bytes.append(reinterpret_cast<const char*>(i % 7 == 0 ? zero : wall), sizeof wall);
  }
  const scratch_file cloud(".pcd", bytes);
  const std::string ask = q.robot + " --volume obb --range 0.9,3 --cloud " + cloud.path,
                    json = ask + " --json --check 0.1";
  const auto whole = parsed(run_command(json));
  CHECK(whole.at("state") == "free");
  bool cut = false;
  for (int turn = 0; turn < 30 && !cut; ++turn) {
    const outcome o = run_command(json + " --deadline 0.1");
    const auto some = parsed(o);
    const auto unseen = some.at("deadline").at("unseen").get<std::uint64_t>();
    CHECK(some.at("points").at("seen").get<std::uint64_t>() + unseen == count);
    CHECK(some.at("deadline").at("complete") == (unseen == 0));
    if (unseen == 0 || some.at("state") == "no_data") continue;
    cut = true;
    CHECK(some.at("state") == "possible");
    CHECK(o.code == 2);
    CHECK(some.at("check").at("passes") == false);
    CHECK(some.at("lower") == 0);
    CHECK(some.at("distance") >= whole.at("distance"));
    CHECK(some.at("upper") >= whole.at("upper"));
    CHECK_FALSE(some.at("part").is_null());
    CHECK(some.at("clouds").at(0).at("points") == count);
  }
  CHECK(cut);
  // Records that are (0,0,0) are counted as something that is left out, whichever of them were seen.
  for (const std::string by : {"0", "0.1", "1e9"}) {
    const auto counts = parsed(run_command(json + " --zero-is-missing --deadline " + by)).at("points");
    std::uint64_t sum = counts.at("valid");
    for (const auto& dropped : counts.at("dropped")) sum += dropped.get<std::uint64_t>();
    CHECK(sum == counts.at("seen"));
  }
}

TEST_CASE("a complete answer by a deadline has the lower end of the answer without one, where links have other gaps") {
  const two_boxes q;
  const scratch_file spheres(".csv", "0,0,0,0.05\n");
  const std::string ask = "query --backend host --no-cache --json --spheres 20 --robot " + q.urdf.path +
                          " --attach tool=" + spheres.path + " --cloud " + q.cloud.path;
  const auto plain = parsed(run_command(ask)), all = parsed(run_command(ask + " --deadline 1e9"));
  CHECK(all.at("deadline").at("complete") == true);
  for (const char* key : {"state", "distance", "lower", "upper", "point", "part"}) CHECK(all.at(key) == plain.at(key));
}

}  // namespace deadline_test

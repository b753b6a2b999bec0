// SPDX-License-Identifier: BSD-3-Clause
// `--shard` in a process of its own.
#include "tools/two_boxes.hpp"

namespace shard_test {

using namespace testing;

TEST_CASE("--shard without mpirun is one rank, or refused where there is no MPI") {
  const two_boxes q;
  const moving_boxes m;
  const scratch_file rows(".csv", "slide,turn\n0,0\n0.4,1\n1,2\n"), ply(".ply");
  const std::string plan = "plan --configurations " + rows.path + " --cloud " + m.cloud.path + m.robot;
  if (const outcome o = run_command(q.ask + " --shard"); o.code != 0) {
    for (const std::string& ask : {q.ask, plan})
      refuses(ask + " --shard", "--shard: this clearance was built without MPI");
    return;
  }
  const std::string moved = m.ask + " --joint slide=0.1 --joint turn=1";
  for (const std::string& ask : {
           q.ask,
           q.ask + " --zones 0.1,0.3,9 --min-points 2",
           q.ask + " --nearest 2 --d-max 1",
           q.ask + " --self-filter 0.21 --zones 0.1",
           moved + " --gradient",
           moved + " --attach claw=" + m.cube.path + " --self-filter 0.1 --nearest 9 --gradient",
           q.ask + " --distances " + ply.path + " --signed --d-max 3",
           plan,
           plan + " --d-max 0.25 --check 0.1",
           plan + " --between --check 0.1 --csv",
       }) {
    const auto without_times = [](std::string text) {
      const std::size_t begin = text.find("\"seconds\"");
      return begin == text.npos ? text : text.erase(begin, text.find('}', begin) - begin);
    };
    const outcome one = run_command(ask + " --shard"), plain = run_command(ask);
    INFO(ask);
    CHECK(one.code == plain.code);
    CHECK(one.err.find(plain.err) != std::string::npos);
    CHECK(!one.out.empty());
    CHECK(without_times(one.out) == without_times(plain.out));
  }
}

}  // namespace shard_test

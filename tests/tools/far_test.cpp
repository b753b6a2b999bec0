// SPDX-License-Identifier: BSD-3-Clause
// Points far away, from every file format that holds doubles, alone and merged.
#include "tools/run_command.hpp"

namespace far_test {

namespace {

/// A box of 0.2 x 0.3 x 0.4 m at (0.25, 0.25, 0) from `at`, before many points far away and one inside it or 0.35 m
/// off.
struct far_question {
  scratch_file robot{".urdf",
                     "<robot name=\"r\"><link name=\"w\"/><link name=\"a\"><collision><geometry><box size=\"0.2 0.3 "
                     "0.4\"/></geometry></collision></link>"
                     "<joint name=\"j\" type=\"continuous\"><parent link=\"w\"/><child link=\"a\"/><axis xyz=\"0 0 "
                     "1\"/></joint></robot>"};
  double at;
  std::string base() const {
    return "--robot " + robot.path + " --model triangles --base-pose " + text(at + 0.25) + "," + text(at + 0.25) +
           ",0,0,0,0,1 ";
  }
  static std::string text(double x) {
    char s[64];
    std::snprintf(s, sizeof s, "%.17g", x);
    return s;
  }
  std::string lines(double far, bool inside) const {
    std::string all;
    for (int k = 0; k < 20; ++k) all += text(at + far) + ' ' + text(at + 0.1 * far) + " 0\n";
    return all + text(at + 0.2) + ' ' + text(at + (inside ? 0.22 : 0.75)) + " 0\n";
  }
};

void check(const nlohmann::json& r, bool inside) {
  INFO(r.dump());
  if (inside) {
    CHECK(r["state"] == "collision");
  } else {
    CHECK(r["state"] == "free");
    CHECK(double(r["lower"]) <= 0.35);
    CHECK(0.35 <= double(r["upper"]));
    CHECK(double(r["upper"]) - double(r["lower"]) < 1e-4);
  }
  CHECK(r["point"] == 20);
}

}  // namespace

TEST_CASE("placeholders a thousand kilometres away change no answer, in any file, alone and merged") {
  for (const double at : {0.0, 1000.0})
    for (const double far : {1e2, 5e6, 1e9})
      for (const bool inside : {true, false}) {
        const far_question q{.at = at};
        const std::string lines = q.lines(far, inside);
        const scratch_file xyz(".xyz", lines);
        const scratch_file pcd(".pcd",
                               "VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 21\nHEIGHT "
                               "1\nPOINTS 21\nDATA ascii\n" +
                                   lines);
        const scratch_file ply(".ply",
                               "ply\nformat ascii 1.0\nelement vertex 21\nproperty double x\nproperty double "
                               "y\nproperty double z\nend_header\n" +
                                   lines);
        for (const auto* cloud : {&xyz, &pcd, &ply})
          check(parsed(run_command("query " + q.base() + "--joints 0 --json --cloud " + cloud->path)), inside);
        const scratch_file list(".txt", xyz.path + '\n' + pcd.path + '\n'), row(".csv", "j\n0\n");
        const outcome merged =
            run_command("run " + q.base() + "--merge --frames " + list.path + " --trajectory " + row.path);
        INFO(merged.err);
        check(nlohmann::json::parse(merged.out.substr(0, merged.out.find('\n'))), inside);
      }
}

}  // namespace far_test

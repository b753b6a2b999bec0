// SPDX-License-Identifier: BSD-3-Clause
// `--unfold-limit` holds for all that a question makes of a small file.
#include "tools/two_boxes.hpp"

#include <liblzf/lzf.h>

namespace unfold_limit_test {

using namespace testing;

TEST_CASE(
    "what a small file would become is counted with all that is asked, and refused with the limit and the option that "
    "raises it") {
  const two_boxes q;
  const std::uint32_t points = 1'000'000;  // that are all 0, three bytes each
  const std::string zeros(3 * std::size_t(points), '\0');
  std::string data(zeros.size(), '\0');
  data.resize(lzf_compress(zeros.data(), unsigned(zeros.size()), data.data(), unsigned(data.size())));
  std::string packed =
      "FIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH " + std::to_string(points) + "\nHEIGHT 1\nDATA binary_compressed\n";
  for (const std::size_t size : {data.size(), zeros.size()}) packed.append(reinterpret_cast<const char*>(&size), 4);
  const scratch_file cloud(".pcd", packed + data), file(".ply"), scene(".glb"), rows(".csv", "\n");
  const std::string with =
      " --backend host --model triangles --robot " + q.urdf.path + " --cloud " + cloud.path + " --unfold-limit 90";
  CHECK(parsed(run_command("query --json" + with)).at("state") == "collision");
  const std::string says = cloud.path + ": has 1000000 points, of which ",
                    limit = " MiB would be made here, more than the limit of 90 MiB (--unfold-limit MiB raises it)";
  refuses("query" + with + " --distances " + file.path, says + "125" + limit);
  refuses("query" + with + " --scene " + scene.path, says + "186" + limit);
  refuses("plan" + with + " --configurations " + rows.path, says + "141" + limit);
  CHECK(run_command("plan" + with + "0 --configurations " + rows.path).code == 0);
  // A file of that many bytes is no small one.
  const scratch_file plain(".pcd",
                           "FIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH 1000000\nHEIGHT 1\nDATA binary\n" + zeros);
  CHECK(run_command("query --json --backend host --model triangles --robot " + q.urdf.path + " --cloud " + plain.path +
                    " --unfold-limit 1 --distances " + file.path)
            .code == 0);
}

}  // namespace unfold_limit_test

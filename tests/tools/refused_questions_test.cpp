// SPDX-License-Identifier: BSD-3-Clause
// Options of questions that make no sense are refused.
#include "tools/two_boxes.hpp"

namespace refused_questions_test {

using namespace testing;

TEST_CASE("what is wrong with zones and distances is one sentence that names the option") {
  const two_boxes q;
  refuses(q.ask + " --zones 0.5,0.1", "--zones: needs thresholds in ascending order");
  refuses(q.ask + " --zones -0.1,0.1", "--zones: needs thresholds in ascending order, none below 0");
  refuses(q.ask + " --zones 0.1,,0.2", "--zones: \"\" is not a number");
  refuses(q.ask + " --zones 0.1,nan", "--zones: \"nan\" is not a finite number");
  refuses(q.ask + " --zones inf", "--zones: \"inf\" is not a finite number");
  refuses(q.ask + " --zones near", "--zones: \"near\" is not a number");
  refuses(q.ask + " --zones 0.1 --zones 0.2", "--zones");
  refuses(q.ask + " --zones 0.1 --min-points 0", "--min-points: \"0\" is not a whole number from 1");
  refuses(q.ask + " --zones 0.1 --min-points 1.5", "--min-points");
  refuses(q.ask + " --min-points 3", "--min-points: is for --zones");
  refuses(q.ask + " --d-max 3", "--d-max: is for --distances and --nearest");
  refuses(q.ask + " --signed", "--signed: is for --distances");
  refuses("query --robot " + q.urdf.path + " --cloud " + q.cloud.path + " --distances x.ply --signed",
          "--signed: is for --model triangles");
  refuses(q.ask + " --nearest 0", "--nearest: \"0\" is not a whole number from 1");
  refuses(q.ask + " --nearest 1048577", "--nearest: \"1048577\" is not a whole number from 1 to 1048576");
  refuses(q.ask + " --nearest 3 --deadline 5",
          "--deadline: cannot be mixed with --nearest: it is for the least distance alone");
  const scratch_file ply(".ply");
  for (const std::string value : {"0", "-1"})
    refuses(q.ask + " --distances " + ply.path + " --d-max " + value, "--d-max: must be above 0");
  for (const std::string value : {"nan", "inf", "1,2", "x"})
    refuses(q.ask + " --distances " + ply.path + " --d-max " + value, "--d-max");
  refuses(q.ask + " --distances out.xyz", "--distances: out.xyz: its name must end in .ply");
  refuses(q.ask + " --distances /nonexistent/folder/x.ply", "/nonexistent/folder/x.ply");
  refuses(q.ask + " --distances " + ply.path + " --scene " + ply.path, "--distances: is the same file as --scene");
  refuses(q.ask + " --distances " + ply.path + " --scene " + std::filesystem::path(ply.path).parent_path().string() +
              "/./" + std::filesystem::path(ply.path).filename().string(),
          "--distances: is the same file as --scene");
  const scratch_file input(".ply",
                           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
                           "float z\nend_header\n3 0 0\n");
  refuses(q.robot + " --cloud " + input.path + " --distances " + input.path,
          input.path + ": is a file that this reads");
  refuses("run --robot x --frames y --zones 0.1", "--zones");
}

TEST_CASE("what is wrong with filter, support, gradient and what is held is one sentence that names the option") {
  const moving_boxes m;
  for (const std::string value : {"-0.01", "-1e-30", "1e16"})
    refuses(m.ask + " --self-filter " + value, "--self-filter: must be from 0 to 1e15");
  for (const std::string value : {"nan", "inf", "near", "0.1,0.2", "1e999"})
    refuses(m.ask + " --self-filter " + value, "--self-filter: ");
  refuses(m.ask + " --self-filter 0.1 --self-filter 0.1", "--self-filter");
  for (const std::string value : {"3", "3@", "@0.1", "@", "0@0.1", "-3@0.1", "2.5@0.1", "1@0.1", "3@-0.1", "3@nan",
                                  "3@inf", "3@1e16", "3@0.1@0.2", "99999999999@1"})
    refuses(m.ask + " --min-support " + value, "--min-support: ");
  refuses(m.ask + " --min-support 3@0.1 --min-support 3@0.1", "--min-support");

  const std::string cube = " --attach claw=" + m.cube.path, pose = " --attach-pose 0,0,0,0,0,0,1";
  for (const std::string& value : {std::string("claw"), std::string("="), std::string("claw="), "=" + m.cube.path})
    refuses(m.ask + " --attach " + value, "is not of the form LINK=FILE");
  refuses(m.ask + " --attach elbow=" + m.cube.path, "--attach: the robot has no link \"elbow\"");
  refuses(m.ask + " --attach claw=nowhere.stl", "nowhere.stl: there is no such file");
  refuses(m.ask + " --attach claw=" + m.cloud.path, m.cloud.path + ": ");
  refuses(m.ask + " --attach claw=/dev/zero", "/dev/zero: ");
  refuses(m.ask + pose + cube, "--attach-pose: is for the --attach before it, and there is none");
  refuses(m.ask + cube + pose + pose, "--attach-pose: is given twice for " + m.cube.path);
  for (const std::string value : {"0,0,0", "0,0,0,0,0,0,2", "nan,0,0,0,0,0,1", "1e19,0,0,0,0,0,1", "0,0,0,0,0,0"})
    refuses(m.ask + cube + " --attach-pose " + value, "--attach-pose: ");
  refuses(m.ask + cube + " --attach-pose 1e19,0,0,0,0,0,1", "--attach-pose: the pose of what is attached is not rigid");
  const scratch_file spheres(".csv", "0,0,0,0.05\n"), broken(".csv", "0,0,0,-1\n"),
      flat(".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  refuses(m.ask + " --attach claw=" + spheres.path,
          "--attach: " + spheres.path + " holds spheres, which are for --model spheres");
  const std::string balls = "query --spheres 5 --no-cache --backend host --robot " + m.urdf.path + " --cloud " +
                            m.cloud.path + " --attach claw=";
  refuses(balls + "nowhere.csv", "nowhere.csv: there is no such file");
  refuses(balls + broken.path, broken.path + ":1: ");
  CHECK(run_command(balls + flat.path).err.find("encloses nothing") != std::string::npos);  // held all the same
  const scratch_file yaml(".yaml",
                          "collision_spheres:\n  a:\n    - {center: [0, 0, 0], radius: 0.1}\n  b:\n    - {center: [0, "
                          "0, 0], radius: 0.1}\n");
  refuses(balls + yaml.path, yaml.path + ": holds the spheres of 2 parts, and --attach takes those of one");
  for (const std::string more : {" --self-filter 0.1", " --min-support 3@0.1", " --gradient"}) {
    if (more != " --self-filter 0.1") refuses("run --robot x --frames y" + more, more.substr(1, 10));
    refuses("plan --robot x --cloud y --configurations z" + more, more.substr(1, 10));
  }
  refuses(m.ask + " --svg x.svg", "--svg");
  const scratch_file input(
      ".ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  refuses(m.ask + " --attach claw=" + input.path + " --distances " + input.path,
          input.path + ": is a file that this reads");
}

TEST_CASE("what is wrong with a deadline or with ranks is one sentence that names the option") {
  const two_boxes q;
  for (const std::string value : {"-1", "-1e-300", "1e300", "1e10"})
    refuses(q.ask + " --deadline " + value, "--deadline: must be from 0 to 1e9 (milliseconds)");
  for (const std::string value : {"nan", "inf", "-inf", "soon", "1,2", "5ms", "1e999"})
    refuses(q.ask + " --deadline " + value, "--deadline: ");
  refuses(q.ask + " --deadline ''", "--deadline: has an empty value");
  refuses(q.ask + " --deadline 5 --deadline 5", "--deadline");
  refuses(q.ask + " --deadline 5 --volume aabb",
          "--volume: cannot be aabb with --deadline, which has obb for --model triangles");
  for (const std::string other :
       {"--zones 0.1", "--distances x.ply", "--self-filter 0.1", "--min-support 3@0.1", "--nearest 2", "--gradient"})
    refuses(q.ask + " --deadline 5 " + other, "--deadline: cannot be mixed with " + other.substr(0, other.find(' ')));
  refuses("plan --robot x --cloud y --configurations z --deadline 5", "--deadline");
  for (const std::string option : {"--deadline 5", "--shard"})
    refuses("run --robot x --frames y " + option, option.substr(0, option.find(' ')));
  refuses(q.ask + " --shard --deadline 5", "--shard: cannot be mixed with --deadline");
  refuses(q.ask + " --shard --min-support 3@0.1", "--shard: cannot be mixed with --min-support");
  refuses(q.ask + " --shard --zones 0.1 --support-limit 5", "--support-limit: is for --min-support");
}

}  // namespace refused_questions_test

// SPDX-License-Identifier: BSD-3-Clause
// `--unseen` says how far each link is from what depth images hide, in `query`, `run` and `plan`.
#include "tools/small_png.hpp"
#include "tools/two_boxes.hpp"

#include <fstream>
#include <iterator>

namespace unseen_tool_test {

using namespace testing;

namespace {

/// A camera 2 m before the boxes looks at the lower one, with two pixels a centimetre apart for each metre.
struct watched_boxes {
  scratch_file urdf{".urdf", two_boxes_text};
  std::string robot = " --backend host --model triangles --robot " + urdf.path;
  std::string camera = " --camera-pose=-2,0,0,-0.5,0.5,-0.5,0.5 --intrinsics 100,100,0.5,0";

  std::string ask(const scratch_file& image) const { return "query" + robot + camera + " --cloud " + image.path; }
};

std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace

TEST_CASE("--unseen says how far every link is from the room behind the pixels, and --check is about that, too") {
  const watched_boxes q;
  const scratch_file image(".png", png(1000, 1200));
  const auto j = parsed(run_command(q.ask(image) + " --json --unseen 0.1:1.5"));
  const auto& all = j.at("unseen");
  CHECK(all.at("state") == "free");
  CHECK(all.at("near").get<double>() == Approx(0.1));
  CHECK(all.at("far") == 1.5);
  CHECK(all.at("distance").get<double>() == Approx(0.4).margin(1e-5));
  CHECK((all.at("lower") < 0.4 && all.at("lower") > 0.38 && all.at("upper") > 0.4 && all.at("upper") < 0.42));
  CHECK(all.at("part") == "base");
  CHECK(all.at("cloud") == image.path);
  CHECK(all.at("point_xyz").at(0).get<double>() == Approx(-0.5).margin(1e-5));
  CHECK(all.at("pixels") == nlohmann::json({{"seen", 2}, {"hiding", 2}}));
  CHECK_FALSE(all.contains("own_shadow"));
  CHECK_FALSE(all.contains("passes"));
  const auto tool = j.at("parts").at(1).at("unseen");
  CHECK(tool.at("distance").get<double>() == Approx(std::sqrt(0.32)).margin(1e-4));
  CHECK(tool.at("lower") < tool.at("distance"));
  CHECK(tool.at("out_of_view") == 1);
  CHECK(j.at("distance").get<double>() == Approx(0.7).margin(1e-4));  // to the second pixel's point
  CHECK_FALSE(parsed(run_command(q.ask(image) + " --json")).contains("unseen"));

  const std::string near = q.ask(image) + " --json --unseen 0.1:1.5 --check ";
  CHECK(run_command(near + "0.3").code == 0);
  const outcome fails = run_command(near + "0.5");
  CHECK(fails.code == 2);
  CHECK(parsed(fails).at("check").at("passes") == true);
  CHECK(parsed(fails).at("unseen").at("passes") == false);

  // Up to 10 m, unless something else is said, it goes through the box.
  const auto through = parsed(run_command(q.ask(image) + " --json --unseen"));
  CHECK(through.at("unseen").at("state") == "unknown");
  CHECK(through.at("unseen").at("lower") == 0);
  CHECK(through.at("state") == "free");
  CHECK(run_command(q.ask(image) + " --unseen").code == 0);
  CHECK(run_command(q.ask(image) + " --unseen --check 0").code == 2);
  // Without a return everything is hidden.
  const scratch_file blind(".png", png(0, 65535));
  CHECK(parsed(run_command(q.ask(blind) + " --json --unseen 1:1.2")).at("unseen").at("distance").get<double>() ==
        Approx(0.7).margin(1e-4));
  // Nothing is hidden before what is seen.
  const auto open = parsed(run_command(q.ask(image) + " --json --unseen 0.1:0.9")).at("unseen");
  CHECK((open.at("state") == "free" && open.at("distance").is_null() && open.at("cloud").is_null()));

  const std::string text = run_command(q.ask(image) + " --unseen 0.1:1.5 --check 0.3").out;
  CHECK(text.find("unseen    0.4000") != text.npos);
  CHECK(text.find(", part base; above 0.3 m\n") != text.npos);
  CHECK(text.find("100 %, pixel ") != text.npos);
  CHECK(run_command(q.ask(image) + " --unseen").out.find(": it reaches into room that no camera sees") != text.npos);
  CHECK(run_command(q.ask(image) + " --unseen 0.1:0.9").out.find("no pixel hides anything nearer than 0.9 m") !=
        text.npos);
}

TEST_CASE("--unseen tells apart what the points of --self-filter hide, and what several cameras hide together") {
  const watched_boxes q;
  const scratch_file own(".png", png(1900, 1000));  // the box's face, and something before it
  const auto j = parsed(run_command(q.ask(own) + " --json --self-filter 0.05 --unseen 0.1:1.5"));
  CHECK(j.at("unseen").at("pixels").at("hiding") == 1);
  CHECK(j.at("unseen").at("pixel") == nlohmann::json({1, 0}));
  CHECK(j.at("unseen").at("own_shadow").at("pixels") == 0);  // it begins beyond 1.5 m
  const auto far = parsed(run_command(q.ask(own) + " --json --self-filter 0.05 --unseen 0.1:3")).at("unseen");
  CHECK(far.at("own_shadow").at("pixels") == 1);
  CHECK(far.at("own_shadow").at("distance").get<double>() == Approx(0).margin(1e-4));
  CHECK(far.at("own_shadow").at("pixel") == nlohmann::json({0, 0}));
  CHECK(far.at("own_shadow").at("part") == "base");
  CHECK(run_command(q.ask(own) + " --self-filter 0.05 --unseen 0.1:3").out.find("shadow    1 pixels of the robot's") !=
        std::string::npos);

  const scratch_file other(".png", png(1100, 1100));
  const auto two = parsed(run_command(q.ask(own) + " --json --unseen 0.1:1.5 --cloud " + other.path)).at("unseen");
  CHECK(two.at("upper").is_null());
  CHECK(two.at("pixels") == nlohmann::json({{"seen", 4}, {"hiding", 3}}));
}

TEST_CASE("--unseen needs depth images, a range, and no question that it cannot be mixed with") {
  const watched_boxes q;
  const scratch_file image(".png", png(1000, 1200)), cloud(".xyz", "0 0 1\n");
  refuses("query" + q.robot + " --unseen --cloud " + cloud.path,
          cloud.path + " is a point cloud, which does not say what was hidden");
  refuses(q.ask(image) + " --unseen --cloud " + cloud.path, "is a point cloud");
  refuses(q.ask(image) + " --unseen 3", "is not of the form NEAR:FAR, such as 0.1:10");
  for (const char* range : {"0:1", "2:1", "1:1", "-1:2", "1:1e7", "1e-60:1"})
    refuses(q.ask(image) + " --unseen=" + range, "needs 0 < NEAR < FAR <= 1e6");
  for (const char* range : {"nan:1", "1:", ":1", "1:2:3", "1:inf"})
    refuses(q.ask(image) + " --unseen=" + range, "--unseen");
  refuses(q.ask(image) + " --unseen --deadline 5", "cannot be mixed with --unseen");
  refuses(q.ask(image) + " --unseen --unseen", "--unseen");
}

TEST_CASE("What is uncertain about a camera is in --unseen, too") {
  const watched_boxes q;
  const scratch_file image(".png", png(1000, 1200));
  const auto ask = [&](const std::string& more) {
    return parsed(run_command(q.ask(image) + " --json --unseen 0.1:1.5" + more)).at("unseen");
  };
  const double sure = ask("").at("lower");
  for (const char* more : {" --sensor lidar:0.01,0", " --calibration 0.03,0", " --max-speed 0.3 --delay 0.1"}) {
    const auto vague = ask(more);
    CHECK(vague.at("lower").get<double>() == Approx(sure - 0.03).margin(1e-3));
    CHECK(vague.at("upper").is_null());
  }
  CHECK(ask(" --calibration 0.5,0").at("state") == "possible");
}

TEST_CASE("What is uncertain about joints is in --unseen, of query, run and plan") {
  const watched_boxes q;
  const scratch_file urdf(".urdf", moving_boxes_text), image(".png", png(1000, 1200));
  const scratch_file rows(".csv", "turn,slide\n0,0\n0,-0.1\n"), still(".csv", "turn,slide\n0,-0.1\n"),
      list(".txt", image.path + "\n");
  const std::string robot = " --backend host --model triangles --robot " + urdf.path + q.camera + " --unseen 0.1:1.5",
                    cloud = " --cloud " + image.path, off = " --joint-error 0.2,0",
                    alone = "query --json --joint slide=-0.1" + robot + cloud,
                    frame = "run --frames " + list.path + " --trajectory " + still.path + robot,
                    plan = "plan --configurations " + rows.path + robot + cloud;
  const auto sure = parsed(run_command(alone)), all = parsed(run_command(alone + off));
  const auto lower = [](const auto& parts, int k) { return parts.at("parts").at(k).at("unseen").at("lower"); };
  const auto& vague = all.at("unseen");
  CHECK(lower(all, 0) == lower(sure, 0));  // the base has no joint
  CHECK(lower(all, 1).template get<double>() == Approx(lower(sure, 1).template get<double>() - 0.2).margin(1e-6));
  CHECK(vague.at("lower") == lower(all, 1));
  CHECK(vague.at("lower") < sure.at("unseen").at("lower"));
  CHECK(lines(run_command(frame + off))[0].at("unseen").at("lower") == vague.at("lower"));
  CHECK(lines(run_command(plan + off))[1].at("unseen").at("lower") == vague.at("lower"));
}

TEST_CASE("plan --between --unseen asks the ways about hidden room, and run --plan --unseen the rows of the plan") {
  // The camera looks along z = 1, where nothing is before the tool; behind is hidden. The tool passes through that.
  const scratch_file urdf(".urdf", moving_boxes_text), image(".png", png(1000, 1200)), clear(".png", png(9000, 9000));
  const scratch_file rows(".csv", "turn,slide\n0,0\n0,1\n"), through(".csv", "turn,slide\n0,0\n0,0.5\n"),
      still(".csv", "turn,slide\n0,0\n"), list(".txt", image.path + "\n");
  const std::string robot = " --backend host --model triangles --robot " + urdf.path +
                            " --camera-pose=-2,0,1,-0.5,0.5,-0.5,0.5 --intrinsics 100,100,0.5,0 --unseen 0.1:3",
                    plan = "plan" + robot + " --configurations " + rows.path + " --cloud ";
  const std::string ask = plan + image.path;
  const outcome apart = run_command(ask + " --check 0.3"), between = run_command(ask + " --between --check 0.3");
  CHECK(apart.code == 0);  // both rows are 0.4 m from it
  CHECK(between.code == 2);
  const auto all = lines(between);
  CHECK(all[0].at("way").at("state") == "free");  // no point is nearer
  CHECK((all[0].at("way").at("unseen").at("state") == "unknown" && all[0].at("way").at("unseen").at("lower") == 0));
  CHECK(all[0].at("way").at("unseen").at("part") == "tool");
  const auto& ways = all[2].at("plan").at("ways");
  CHECK((ways.at("first_below").is_null() && ways.at("unseen").at("first_below") == 0));
  CHECK(all[2].at("check").at("passes") == false);
  CHECK(run_command(ask + " --between --check 0").code == 2);
  const auto exact = lines(run_command(ask + " --between"));
  CHECK(exact[0].at("way").at("unseen").at("state") == "unknown");
  std::istringstream table(run_command(ask + " --between --csv --check 0.3").out);
  std::string names, row;
  std::getline(table, names), std::getline(table, row);
  CHECK(names.ends_with(",way_unseen_state,way_unseen_lower,way_unseen_part"));
  CHECK(row.ends_with(",unknown,0.0,tool"));
  CHECK(run_command(ask + " --between --csv --check 0.3").err.find("from row 0 to the next what is hidden") !=
        std::string::npos);
  // A way aside is free, and as far as its nearest end; if no pixel hides anything, infinitely.
  const scratch_file aside(".csv", "turn,slide\n0,-0.1\n0,0\n");
  const auto free = lines(run_command("plan" + robot + " --between --configurations " + aside.path + " --cloud " +
                                      image.path + " --check 0.3"));
  CHECK(free[0].at("way").at("unseen").at("state") == "free");
  CHECK(free[0].at("way").at("unseen").at("lower") > 0.3);
  CHECK(free[0].at("way").at("unseen").at("lower") <= free[1].at("unseen").at("lower"));
  const auto open = lines(run_command(plan + clear.path + " --between --check 0.3"));
  CHECK((open[0].at("way").at("unseen").at("state") == "free" && open[2].at("check").at("passes") == true));
  // What is uncertain is in it: the way aside is 0.4 m away, and 0.2 m of that are not certain.
  const std::string vague = " --joint-error 0.2,0";
  CHECK(run_command("plan" + robot + " --between --configurations " + aside.path + " --cloud " + image.path +
                    " --check 0.3" + vague)
            .code == 2);

  const std::string run = "run" + robot + " --frames " + list.path + " --trajectory " + still.path + " --check 0.3";
  CHECK(run_command(run).code == 0);
  const outcome planned = run_command(run + " --plan " + through.path);
  CHECK(planned.code == 2);
  const auto its = lines(planned)[0].at("plan");
  CHECK(its.at("first_below").is_null());
  CHECK(its.at("unseen").at("first_below") == 1);
  CHECK(its.at("unseen_lower").at(1) == 0);
  CHECK(its.at("unseen_lower").at(0) == lines(planned)[0].at("unseen").at("lower"));
  CHECK(run_command(run + " --plan " + still.path).code == 0);
  CHECK(run_command(run + " --plan " + still.path + " --max-speed 1 --delay 0 --plan-time 0.2").code == 2);
  CHECK(run_command(run + " --csv --plan " + through.path).out.find(",plan_unseen_lower,plan_unseen_at\n") !=
        std::string::npos);
  refuses(run + " --plan " + still.path + " --self-filter 0.01",
          "--plan: cannot be mixed with --unseen and --self-filter: the plan may lead into the room");
}

TEST_CASE("--scene has the hidden room, and the way behind the pixel") {
  const watched_boxes q;
  const scratch_file image(".png", png(1000, 1200)), scene(".glb");
  REQUIRE(run_command(q.ask(image) + " --unseen 0.1:1.5 --scene " + scene.path).code == 0);
  const std::string bytes = read(scene.path);
  for (const char* name : {" hides\"", "\"hidden way\"", "\"witness of what is hidden\"", "BLEND"})
    CHECK(bytes.find(name) != bytes.npos);
  REQUIRE(run_command(q.ask(image) + " --scene " + scene.path).code == 0);
  CHECK(read(scene.path).find(" hides\"") == std::string::npos);
}

TEST_CASE("run --unseen has both distances of every frame and part, in JSON, in a table and in a picture") {
  const watched_boxes q;
  const scratch_file first(".png", png(1000, 1200)), second(".png", png(1300, 1400)), svg(".svg");
  const scratch_file list(".txt", first.path + "\n" + second.path + "\n");
  const std::string ask = "run" + q.robot + q.camera + " --frames " + list.path + " --unseen 0.1:1.5";
  const outcome o = run_command(ask + " --check 0.3 --svg " + svg.path);
  CHECK(o.code == 0);
  const auto all = lines(o);
  REQUIRE(all.size() == 2);
  for (const auto& j : all) {
    CHECK(j.at("unseen").at("distance").get<double>() == Approx(0.4).margin(1e-4));
    CHECK(j.at("unseen").at("latency_us") > 0);
    CHECK(j.at("parts").at(1).at("name") == "tool");
    CHECK(j.at("parts").at(1).at("unseen").at("out_of_view") == 1);
  }
  CHECK(all[0].at("parts").at(0).at("distance") == all[0].at("distance"));
  CHECK(run_command(ask + " --check 0.45").code == 2);
  const std::string picture = read(svg.path);
  for (const char* name : {"id=\"unseen-bracket\"", "id=\"unseen-distance\"", "orange: to what is not seen"})
    CHECK(picture.find(name) != picture.npos);

  std::istringstream table(run_command(ask + " --csv").out);
  std::string names, row;
  std::getline(table, names), std::getline(table, row);
  CHECK(names.find(
            ",unseen_state,unseen_distance,unseen_lower,unseen_part,unseen_pixel_x,unseen_pixel_y,base distance,base "
            "unseen,base unseen_lower,base out_of_view,tool distance") != names.npos);
  CHECK(std::count(names.begin(), names.end(), ',') == std::count(row.begin(), row.end(), ','));
  CHECK(row.find(",free,0.4") != row.npos);
  refuses(ask + " --merge", "cannot be mixed with --unseen");
  const scratch_file own(".png", png(1900, 1000)), owns(".txt", own.path + "\n");  // the box's face is in it
  const std::string filtered = " --self-filter 0.05 --unseen 0.1:3";
  auto told = lines(run_command("run" + q.robot + q.camera + " --frames " + owns.path + filtered))[0].at("unseen");
  CHECK(told.at("own_shadow").at("pixels") == 1);
  told.erase("latency_us");
  CHECK(told == parsed(run_command(q.ask(own) + " --json" + filtered)).at("unseen"));
  const scratch_file cloud(".xyz", "0 0 1\n"), clouds(".txt", cloud.path + "\n");
  refuses("run" + q.robot + " --frames " + clouds.path + " --unseen", "is a point cloud");
}

TEST_CASE("plan --unseen says of each configuration what query says of it, and --check is about all") {
  const watched_boxes q;
  const scratch_file urdf(".urdf", moving_boxes_text), image(".png", png(1000, 1200));
  const scratch_file rows(".csv", "turn,slide\n0,0.5\n0,-0.1\n0,0\n");
  const std::string robot = " --backend host --model triangles --robot " + urdf.path + q.camera + " --cloud " +
                            image.path + " --unseen 0.1:1.5";
  const std::string ask = "plan" + robot + " --configurations " + rows.path;
  const auto all = lines(run_command(ask));
  REQUIRE(all.size() == 4);
  for (int k = 0; k < 3; ++k) {
    const char* const slides[] = {"0.5", "-0.1", "0"};
    const auto alone = parsed(run_command("query --json --joint slide=" + std::string(slides[k]) + robot));
    CHECK(all[k].at("unseen") == alone.at("unseen"));
    CHECK(all[k].at("unseen").at("lower") >= all[3].at("plan").at("unseen").at("least_lower"));
  }
  CHECK(run_command(ask + " --check 0.3").code == 0);
  const outcome fails = run_command(ask + " --check 0.5");  // all points are farther
  CHECK(fails.code == 2);
  CHECK(lines(fails)[3].at("plan").at("unseen").at("first_below") == 0);
  CHECK(lines(fails)[3].at("plan").at("first_below").is_null());
  std::istringstream table(run_command(ask + " --csv").out);
  std::string names, row;
  std::getline(table, names), std::getline(table, row);
  CHECK(names.find(",unseen_state,unseen_distance,unseen_lower") != names.npos);
  CHECK(std::count(names.begin(), names.end(), ',') == std::count(row.begin(), row.end(), ','));
  refuses(ask + " --shard", "--shard");
}

}  // namespace unseen_tool_test

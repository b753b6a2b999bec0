// SPDX-License-Identifier: BSD-3-Clause
// `clearance plan`, and the plan of `clearance run`: many configurations, compared with `clearance query` about each.
#include "io/robot_folder.hpp"
#include "tools/small_png.hpp"
#include "tools/two_boxes.hpp"

#include <sstream>

namespace plan_test {

namespace {

const char* const slides[] = {"0", "0.3", "0.35", "0.1"};  // 0.4, 0.1, 0.05 and 0.3 m below the point

struct path {
  scratch_file urdf{".urdf", testing::boxes_with_eye_text};
  scratch_file cloud{".xyz", "5 5 5\n0 0 1.0\nnan 0 0\n"};
  scratch_file rows{".csv", "turn, slide\n0,0\n0.5,0.3\n1,0.35\n1,0.1\n"};
  std::string robot = " --backend host --model triangles --robot " + urdf.path;
  std::string with(const std::string& csv) const {
    return "plan" + robot + " --cloud " + cloud.path + " --configurations " + csv;
  }
  std::string ask = with(rows.path);
};

const char* const no_field = "--fields: link \"huge\": a part without a finite size has no field; so no field is used";

const char* const answered[] = {"state",     "distance", "upper",     "cloud",       "point", "pixel",
                                "point_xyz", "part",     "primitive", "nearest_xyz", "normal"};

/// A table of frames without `latency_us`.
std::string without_times(const std::string& table) {
  std::istringstream rows(table);
  std::string all;
  std::size_t column = std::string::npos;
  for (std::string line; std::getline(rows, line); all += '\n') {
    std::istringstream cells(line);
    std::size_t k = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++k) {
      if (cell == "latency_us") column = k;
      if (k != column) all += cell + ',';
    }
  }
  return all;
}

}  // namespace

TEST_CASE("clearance plan answers each configuration as clearance query does") {
  const path p;
  for (const std::string model : {"triangles", "spheres --spheres 100"}) {
    const std::string how = " --backend host --robot " + p.urdf.path + " --cloud " + p.cloud.path + " --model " + model;
    const outcome o = run_command("plan --configurations " + p.rows.path + how);
    CHECK(o.code == 0);
    const auto all = lines(o);
    REQUIRE(all.size() == 5);
    for (int k = 0; k < 4; ++k) {
      const auto alone = parsed(run_command("query --json --joint slide=" + std::string(slides[k]) + how));
      INFO(model << " row " << k);
      CHECK(all[k].at("row") == k);
      for (const char* key : answered) CHECK(all[k].at(key) == alone.at(key));
      CHECK(all[k].at("lower") <= alone.at("distance"));
    }
    const auto& last = all.back();
    CHECK(
        last.at("plan") ==
        nlohmann::json({{"rows", 4}, {"least", all[2].at("distance")}, {"at", 2}}));  // nobody asked who is below what
    CHECK_FALSE(last.contains("check"));
    CHECK(last.at("points").at("seen") == 3);
    CHECK(last.at("points").at("valid") == 2);
    CHECK(last.at("backend") == "host");
    for (const char* key : {"load", "pack", "build", "upload", "query"})
      CHECK(last.at("seconds").at(key).get<double>() >= 0);
  }
}

TEST_CASE("--check names the first configuration that is too near, and the exit code says that there is one") {
  const path p;
  const auto last = [](const outcome& o) { return lines(o).back(); };
  const outcome fails = run_command(p.ask + " --check 0.2");
  CHECK(fails.code == 2);
  CHECK(last(fails).at("plan").at("first_below") == 1);
  CHECK(last(fails).at("check") == nlohmann::json({{"margin", 0.2}, {"passes", false}}));
  const outcome passes = run_command(p.ask + " --check 0.04");
  CHECK(passes.code == 0);
  CHECK(last(passes).at("plan").at("first_below").is_null());
  CHECK(last(passes).at("check").at("passes") == true);
  CHECK(last(run_command(p.ask + " --check 0.07")).at("plan").at("first_below") == 2);
  CHECK(last(run_command(p.ask + " --check 0.4")).at("plan").at("first_below") == 0);  // lower is rounded down

  const scratch_file blind(".xyz", "nan nan nan\n");
  for (const std::string check : {"", " --check 0.1", " --check 0"}) {
    const outcome o =
        run_command("plan" + p.robot + " --configurations " + p.rows.path + " --cloud " + blind.path + check);
    CHECK(o.code == 3);
    const auto all = lines(o);
    REQUIRE(all.size() == 5);
    CHECK(all[1].at("state") == "no_data");
    for (const char* key : {"distance", "lower", "upper", "cloud", "part"}) CHECK(all[1].at(key).is_null());
    CHECK(all[4].at("plan").at("least").is_null());
    if (check.empty()) continue;
    CHECK(all[4].at("plan").at("first_below") == 0);  // what is not known is not free
    CHECK(all[4].at("check").at("passes") == false);
  }
}

TEST_CASE("beyond --d-max a configuration has no witness, and is still no less certain") {
  const path p;
  const auto all = lines(run_command(p.ask + " --d-max 0.2")), exact = lines(run_command(p.ask));
  REQUIRE(all.size() == 5);
  for (const int k : {0, 3}) {
    CHECK(all[k].at("state") == "free");
    CHECK(all[k].at("distance").is_null());
    CHECK(all[k].at("part").is_null());
    CHECK(all[k].at("cloud").is_null());
    CHECK(all[k].at("lower").get<double>() <= exact[k].at("lower").get<double>());
    CHECK(all[k].at("lower").get<double>() > 0.19);
  }
  for (const int k : {1, 2})
    for (const char* key : answered) CHECK(all[k].at(key) == exact[k].at(key));
  CHECK(all[4].at("plan").at("at") == 2);
  CHECK(run_command(p.ask + " --d-max 0.2 --check 0.15").code == 2);
  CHECK(lines(run_command(p.ask + " --d-max 0.2 --check 0.15")).back().at("plan").at("first_below") == 1);
  const auto far = lines(run_command(p.ask + " --d-max 0.01")).back();
  CHECK(far.at("plan").at("least").is_null());
  CHECK(far.at("plan").at("at").is_null());
}

TEST_CASE("--csv says the same in columns, and on stderr which row is the first") {
  const path p;
  const outcome o = run_command(p.ask + " --csv --d-max 0.35 --check 0.2");
  CHECK(o.code == 2);
  CHECK(o.err.find("row 1 is the first whose lower end is not above the margin") != std::string::npos);
  CHECK(run_command(p.ask + " --csv --check 0.01").err.find("every row's lower end is above the margin") !=
        std::string::npos);
  const auto all = lines(run_command(p.ask + " --d-max 0.35"));
  std::istringstream in(o.out);
  std::string line;
  std::getline(in, line);
  CHECK(line ==
        "row,state,distance,lower,upper,cloud,point,part,primitive,point_x,point_y,point_z,nearest_x,nearest_y,nearest_"
        "z");
  for (int k = 0; k < 4; ++k) {
    REQUIRE(std::getline(in, line));
    CHECK(std::count(line.begin(), line.end(), ',') == 14);
    std::istringstream words(line + ',');
    std::vector<std::string> cells;
    for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
    REQUIRE(cells.size() == 15);
    CHECK(cells[0] == std::to_string(k));
    CHECK(cells[1] == all[k].at("state").get<std::string>());
    const bool near = !all[k].at("cloud").is_null();
    CHECK(cells[2] == (near ? all[k].at("distance").dump() : "inf"));
    CHECK(cells[3] == all[k].at("lower").dump());
    CHECK(cells[5] == (near ? p.cloud.path : ""));
    CHECK(cells[7] == (near ? "tool" : ""));
    CHECK(cells[11] == (near ? all[k].at("point_xyz").at(2).dump() : ""));
  }
  CHECK_FALSE(std::getline(in, line));
  const scratch_file named(",\"a\".xyz", "0 0 1\n");  // names that CSV must quote
  const std::string quoted =
      run_command("plan" + p.robot + " --csv --configurations " + p.rows.path + " --cloud '" + named.path + "'").out;
  CHECK(quoted.find(",\"\"a\"\".xyz\",0,tool,") != std::string::npos);
  const scratch_file blind(".xyz", "nan nan nan\n");
  CHECK(run_command("plan" + p.robot + " --csv --configurations " + p.rows.path + " --cloud " + blind.path)
            .out.find("\n0,no_data,,,,,,,,,,,,,\n") != std::string::npos);
}

TEST_CASE("a camera on a link saw the clouds where the first configuration has it") {
  const path p;
  const scratch_file depth(".png", png(0, 1000)), start(".csv", "slide,turn\n0.1,0\n0,0\n");
  const auto all = lines(run_command("plan" + p.robot + " --camera-link eye --intrinsics 500,500,1,0 --cloud " +
                                     depth.path + " --configurations " + start.path));
  REQUIRE(all.size() == 3);
  for (const int k : {0, 1}) {
    CHECK(all[k].at("point_xyz").at(2).get<double>() == Approx(1.7));
    CHECK(all[k].at("pixel") == nlohmann::json({1, 0}));
  }
  CHECK(all[0].at("distance").get<double>() == Approx(1.0));
  CHECK(all[1].at("distance").get<double>() == Approx(1.1));
}

TEST_CASE("a joint without a column is fixed by --joint, and what is wrong with a plan is one sentence") {
  const path p;
  const scratch_file one(".csv", "slide\n0.3\n");
  CHECK(lines(run_command(p.with(one.path) + " --joint turn=0.5")).front().at("distance").get<double>() == Approx(0.1));
  const scratch_file list(".txt", p.cloud.path + '\n'), still(".csv", "turn,slide\n0,0\n");
  const auto with = [&](const std::string& csv, const std::string& sentence) {
    const scratch_file file(".csv", csv);
    refuses(p.with(file.path), file.path + sentence);
    refuses("run" + p.robot + " --frames " + list.path + " --trajectory " + still.path + " --plan " + file.path,
            file.path + sentence);
  };
  with("slide\n0\n", ":1: has no column for joint \"turn\"");
  with("slide,turn,elbow\n0,0,0\n", ":1: ");
  with("slide,turn,turn\n0,0,0\n", ":1: has two columns for joint \"turn\"");
  with("slide,turn\n0\n", ":2: needs 2 numbers");
  with("slide,turn\n0,0\n0,nan\n", ":3: \"nan\" is not a finite number");
  with("slide,turn\n0,0\n0,\n", ":3: \"\" is not a number");
  with("slide,turn\n0,0\n5,0\n", ":3: ");  // beyond its limit
  with("slide,turn\n", ": has no row");
  with("", ": is empty");
  refuses(p.with("nowhere.csv"), "nowhere.csv: there is no such file");
  refuses("plan" + p.robot + " --cloud " + p.cloud.path, "--configurations is required");
  refuses("plan" + p.robot + " --configurations " + p.rows.path, "--cloud is required");
  refuses(p.ask + " --json", "--json");
  refuses(p.ask + " --volume obb", "--volume");
  refuses(p.ask + " --joints 0,0", "--joints");
  refuses(p.ask + " --camera-link elbow", "elbow");
  refuses(p.ask + " --check nan", "--check: \"nan\" is not a finite number");
  refuses(p.ask + " --check 0.2 --d-max 0.2", "--d-max: must be above the margin of --check");
  for (const std::string value : {"0", "-0.1"}) refuses(p.ask + " --d-max " + value, "--d-max: must be above 0");
  for (const std::string value : {"1e-60", "1e300"})
    refuses(p.ask + " --d-max " + value, "--d-max: must be from 1e-30 to 1e30");
}

TEST_CASE("clearance run --plan says in every frame what clearance plan says of its points") {
  const path p;
  const scratch_file near(".xyz", "0 0 0.9\n3 0 0\n"), blind(".xyz", "nan nan nan\n"),
      list(".txt", p.cloud.path + '\n' + near.path + '\n');
  const scratch_file still(".csv", "turn,slide\n0,0\n");
  const std::string run = "run" + p.robot + " --trajectory " + still.path + " --plan " + p.rows.path + " --frames ";
  for (const std::string merge : {"", " --merge"}) {
    const outcome o = run_command(run + list.path + " --check 0.07" + merge);
    const auto all = lines(o);
    REQUIRE(all.size() == 2);
    CHECK(o.code == 2);
    for (int k = 0; k < 2; ++k) {
      const std::string cloud =
          merge.empty() ? (k == 0 ? p.cloud.path : near.path) : p.cloud.path + " --cloud " + near.path;
      const auto alone =
          lines(run_command("plan" + p.robot + " --configurations " + p.rows.path + " --check 0.07 --cloud " + cloud));
      const auto& plan = all[k].at("plan");
      CHECK(plan.at("latency_us").get<double>() > 0);
      CHECK(plan.at("first_below") == (k == 0 && merge.empty() ? 2 : 1));
      for (const char* key : {"rows", "at", "first_below"}) CHECK(plan.at(key) == alone.back().at("plan").at(key));
      CHECK(plan.at("least").get<double>() == Approx(alone.back().at("plan").at("least").get<double>()).margin(1e-6));
      REQUIRE(plan.at("lower").size() == 4);
      for (int row = 0; row < 4; ++row)
        CHECK(plan.at("lower").at(row).get<double>() == Approx(alone[row].at("lower").get<double>()).margin(1e-5));
    }
  }
  // The frame itself is far enough.
  const scratch_file first(".txt", p.cloud.path + '\n'), none(".txt", blind.path + '\n');
  CHECK(run_command(run + first.path + " --check 0.04").code == 0);
  CHECK(run_command(run + first.path + " --check 0.07").code == 2);
  CHECK_FALSE(lines(run_command(run + first.path)).at(0).at("plan").contains("first_below"));
  const outcome o = run_command(run + none.path + " --check 0");
  CHECK(o.code == 3);
  const auto plan = lines(o).at(0).at("plan");
  CHECK(plan.at("first_below") == 0);
  CHECK(plan.at("least").is_null());
  CHECK(plan.at("lower") == nlohmann::json({nullptr, nullptr, nullptr, nullptr}));
  CHECK_FALSE(lines(run_command("run" + p.robot + " --trajectory " + still.path + " --frames " + first.path))
                  .at(0)
                  .contains("plan"));
}

TEST_CASE("--between judges the way from each row to the next, and --check is about it, too") {
  const path p;
  const scratch_file rows{".csv", "turn, slide\n0,0\n0,0.3\n0,0.1\n"};
  // A point 0.1 m beside the way of the upper box.
  const scratch_file beside{".xyz", "0.2 0 0.65\n5 5 5\n"};
  const std::string ask = "plan" + p.robot + " --cloud " + beside.path + " --configurations " + rows.path;
  const auto all = lines(run_command(ask + " --between"));
  REQUIRE(all.size() == 4);
  for (int k = 0; k < 2; ++k) {
    const auto way = all[std::size_t(k)].at("way");
    INFO(k);
    CHECK(way.at("lower") <= 0.1);
    CHECK(way.at("upper") >= 0.1);
    CHECK(way.at("upper") <= 0.11);
    CHECK(way.at("lower") >= 0.085);
    CHECK(way.at("state") == "free");
    CHECK(way.at("part") == "tool");
    CHECK(way.at("settled") == true);
  }
  CHECK_FALSE(all[2].contains("way"));
  CHECK(all[3].at("plan").at("ways").at("least_lower") <= 0.1);
  const scratch_file apart{".csv", "turn, slide\n0,-0.1\n0,0.6\n"};  // the ends are farther than what lies between them
  const std::string wide =
      "plan" + p.robot + " --cloud " + beside.path + " --configurations " + apart.path + " --check 0.12";
  CHECK(run_command(wide).code == 0);
  const outcome o = run_command(wide + " --between");
  CHECK(o.code == 2);
  CHECK(lines(o).back().at("plan").at("ways") ==
        nlohmann::json::parse(R"({"least_lower": )" + lines(o)[0].at("way").at("lower").dump() +
                              R"(, "at": 0, "first_below": 0})"));
  CHECK(lines(o).back().at("plan").at("first_below").is_null());
  CHECK(run_command("plan" + p.robot + " --cloud " + beside.path + " --configurations " + apart.path +
                    " --check 0.08 --between")
            .code == 0);
  const outcome csv = run_command(wide + " --between --csv");
  CHECK(csv.code == 2);
  CHECK(csv.out.find(",nearest_z,way_state,way_lower,way_upper,way_time,way_from,way_to,way_part\n") != csv.out.npos);
  CHECK(csv.out.ends_with(",,,,,,,\n"));
  const auto way = lines(o)[0].at("way");
  CHECK(csv.out.find(',' + way.at("time").dump() + ',' + way.at("from").dump() + ',' + way.at("to").dump() + ',') !=
        csv.out.npos);
  CHECK(csv.err.find("on the way from row 0 to the next the margin may be fallen below") != csv.err.npos);
  const scratch_file one{".csv", "turn, slide\n0,0\n"}, blind{".xyz", "nan nan nan\n"};
  const auto alone = lines(run_command("plan" + p.robot + " --cloud " + beside.path + " --configurations " + one.path +
                                       " --between --check 0.1"));
  CHECK(alone.back().at("plan").at("ways") ==
        nlohmann::json::parse(R"({"least_lower": null, "at": null, "first_below": null})"));
  const outcome dark = run_command("plan" + p.robot + " --cloud " + blind.path + " --configurations " + rows.path +
                                   " --between --check 0.1");
  CHECK(dark.code == 3);
  CHECK(lines(dark)[0].at("way").at("state") == "no_data");
  refuses(ask + " --between --attach tool=" + p.cloud.path, "--between: cannot be mixed with --attach");
  for (const std::string more : {"", " --between"})
    refuses(ask + more + " --check -0.1", "--check: must not be negative (metres)");
}

TEST_CASE("--fields changes no answer, and names a link that can have none") {
  const path p;
  const std::string plain = run_command(p.ask + " --csv").out;
  CHECK(plain.size() > 100);
  const outcome o = run_command(p.ask + " --csv --fields");
  CHECK((o.code == 0 && o.out == plain && o.err.find("--fields") == std::string::npos));
  CHECK(run_command(p.ask + " --csv --fields on").out == plain);
  refuses(p.ask + " --fields maybe", "--fields");
  const scratch_file still{".csv", "turn,slide\n0,0\n"}, list{".txt", p.cloud.path + "\n"};
  const std::string run = "run --csv" + p.robot + " --trajectory " + still.path + " --frames " + list.path;
  refuses(run + " --fields", "--fields: is for --plan");
  const outcome frames = run_command(run + " --fields --plan " + p.rows.path);
  CHECK(frames.code == 0);
  CHECK(without_times(frames.out) == without_times(run_command(run + " --plan " + p.rows.path).out));

  const scratch_file large{".urdf",
                           "<robot name=\"r\"><link name=\"huge\"><collision><geometry><box size=\"3e6 3e6 "
                           "3e6\"/></geometry></collision></link></robot>"},
      far{".xyz", "0 0 2e6\n"}, once{".csv", "\n"};
  const std::string alone = "plan --csv --backend host --model triangles --robot " + large.path + " --cloud " +
                            far.path + " --configurations " + once.path;
  const outcome none = run_command(alone + " --fields");
  CHECK(none.out == run_command(alone).out);
  CHECK(none.err.find(no_field) != std::string::npos);
}

TEST_CASE("Fields are sampled once: the cache has them for the next plan, which says so") {
  path p;
  const auto base_of = [](const std::string& size) {
    std::string text = testing::boxes_with_eye_text;
    return text.replace(text.find("0.2 0.2 0.2"), 11, size);
  };
  p.urdf.put(base_of("0.21 0.2 0.2"));  // two different links: equal ones share a file
  const robot_folder cache;
  const std::string where = cache.path.string(), plain = run_command(p.ask + " --csv").out;
  const auto counted = [&](const std::string& arguments, const std::string& kept_in) {
    const outcome o = run_command(arguments, kept_in);
    CHECK((o.code == 0 && o.err.empty()));
    const auto last = lines(o).back();
    return last.contains("fields") ? last.at("fields").dump() : std::string();
  };
  const std::string fresh = R"({"cached":0,"links":2})", kept = R"({"cached":2,"links":2})";
  CHECK(counted(p.ask, where).empty());
  CHECK(counted(p.ask + " --fields", where) == fresh);
  CHECK(counted(p.ask + " --fields", where) == kept);
  CHECK(counted(p.ask + " --fields --cache " + where, "") == kept);
  CHECK(counted(p.ask + " --fields --no-cache", where) == fresh);
  CHECK(run_command(p.ask + " --csv --fields", where).out == plain);
  // Another model, and a robot of which one link is another, have others.
  CHECK(counted("plan --backend host --spheres 20 --robot " + p.urdf.path + " --cloud " + p.cloud.path +
                    " --configurations " + p.rows.path + " --fields",
                where) == fresh);
  const scratch_file other{".urdf", base_of("0.22 0.2 0.2")};
  CHECK(counted("plan --backend host --model triangles --robot " + other.path + " --cloud " + p.cloud.path +
                    " --configurations " + p.rows.path + " --fields",
                where) == R"({"cached":1,"links":2})");
  // auto takes what is kept, of 100 rows and more.
  const auto rows = [&](std::size_t count) {
    std::string csv = "turn,slide\n";
    for (std::size_t k = 0; k < count; ++k) csv += "0,0.1\n";
    return csv;
  };
  const scratch_file few{".csv", rows(99)}, many{".csv", rows(100)};
  CHECK(counted(p.with(few.path), where).empty());
  CHECK(counted(p.with(many.path), where) == kept);
  CHECK(counted(p.with(many.path), "").empty());
  for (const char* never : {" --no-cache", " --d-max 1", " --fields off"})
    CHECK(counted(p.with(many.path) + never, where).empty());
  std::size_t damaged = 0;
  for (const auto& entry : std::filesystem::directory_iterator(cache.path)) {
    if (entry.path().extension() != ".fields") continue;
    std::fstream(entry.path(), std::ios::in | std::ios::out | std::ios::binary).seekp(5000).put('\xa5').put('\x5a');
    ++damaged;
  }
  CHECK(damaged == 5);
  CHECK(counted(p.with(many.path), where).empty());
  CHECK(run_command(p.ask + " --csv --fields", where).out == plain);
  CHECK(counted(p.with(many.path), where) == kept);  // repaired
}

TEST_CASE("The cache of fields: options that change nothing are refused, and what cannot be kept is told") {
  const path p;
  const robot_folder place;
  const std::string file = place.put("file", "no folder").string();
  for (const std::string option : {"--no-cache", "--cache /tmp"}) {
    const std::string its = option.substr(0, option.find(' ')) + ": is for --model spheres, and for --fields";
    refuses(p.ask + " --fields off " + option, its);
    refuses(p.ask + " --d-max 1 " + option, its);
  }
  refuses(p.ask + " --fields --cache " + file, "--cache: " + file + " is no folder, and none can be made");
  const outcome o = run_command(p.ask + " --csv --fields", file);
  CHECK(o.err.starts_with("note: " + file + ": cannot be written to, so nothing new is kept"));
  CHECK(o.out == run_command(p.ask + " --csv").out);
  const scratch_file still{".csv", "turn,slide\n0,0\n"}, list{".txt", p.cloud.path + "\n"};
  const std::string run = "run --csv" + p.robot + " --trajectory " + still.path + " --frames " + list.path;
  refuses(run + " --no-cache", "--no-cache: is for --model spheres");
  const auto in = place.path / "kept";
  for (int k = 0; k < 2; ++k)
    CHECK(run_command(run + " --fields --plan " + p.rows.path + " --cache " + in.string()).code == 0);
  CHECK(std::distance(std::filesystem::directory_iterator(in), std::filesystem::directory_iterator()) ==
        1);                               // of equal links
  const auto full = place.path / "full";  // no room for a field
  CHECK(run_command(p.ask + " --csv --fields", full.string(), "ulimit -f 500; ").out == o.out);
  CHECK(std::filesystem::is_empty(full));
  std::vector<FILE*> running;  // at once
  for (int k = 0; k < 2; ++k)
    running.push_back(::popen(("CLEARANCE_CACHE='" + (place.path / "new").string() + "' \"" + testing::command() +
                               "\" " + p.ask + " --csv --fields 2>&1")
                                  .c_str(),
                              "r"));
  for (FILE* each : running) {
    REQUIRE(each);
    std::string said;
    for (int c; (c = std::fgetc(each)) != EOF;) said += char(c);
    CHECK(::pclose(each) == 0);
    CHECK(said == run_command(p.ask + " --csv").out);
  }
}

TEST_CASE("Without --fields they are used where it pays, which a link that can have none tells") {
  const scratch_file turning{".urdf",
                             "<robot name=\"r\"><link name=\"base\"/><link name=\"huge\"><collision><geometry><box "
                             "size=\"3e6 3e6 3e6\"/></geometry></collision></link><joint name=\"j\" "
                             "type=\"continuous\"><parent link=\"base\"/><child link=\"huge\"/></joint></robot>"},
      far{".xyz", "0 0 2e6\n"}, start{".csv", "j\n0\n"}, two{".txt", far.path + "\n" + far.path + "\n"};
  const auto noted = [&](const std::string& more, std::size_t rows) {
    std::string csv = "j\n";
    for (std::size_t k = 0; k < rows; ++k) csv += "0\n";
    const scratch_file path{".csv", csv};
    return run_command((more.starts_with("run") ? more + " --plan " : more + " --configurations ") + path.path +
                       " --csv --backend host --model triangles --robot " + turning.path)
               .err.find(no_field) != std::string::npos;
  };
  const std::string plan = "plan --cloud " + far.path;
  CHECK_FALSE(noted(plan, 99'999));
  CHECK(noted(plan, 100'000));
  for (const char* never : {" --d-max 1", " --fields off"}) CHECK_FALSE(noted(plan + never, 100'000));
  const std::string frames = "run --trajectory " + start.path + " --frames " + two.path;
  CHECK(noted(frames, 50'000));
}

TEST_CASE("a plan of more poses than are in memory at once has the same answers") {
  constexpr std::size_t links = 16, block = (1u << 20) / links,
                        rows = block + 40;  // poses go through in blocks of 2^20
  std::string robot = "<robot name=\"many\"><link name=\"base\"/>\n", csv = "j0\n";
  for (std::size_t k = 0; k < links; ++k) {
    const std::string name = std::to_string(k);
    robot += "<link name=\"l" + name +
             "\"><collision><geometry><box size=\"0.02 0.02 0.02\"/></geometry></collision></link><joint name=\"j" +
             name + "\" type=\"" + (k == 0 ? "continuous" : "fixed") + "\"><parent link=\"base\"/><child link=\"l" +
             name + "\"/><origin xyz=\"" + std::to_string(0.05 * double(k)) + " 0 0\"/></joint>\n";
  }
  const auto angle = [](std::size_t row) { return std::to_string(1e-5 * double(row)) + "\n"; };
  for (std::size_t row = 0; row < rows; ++row) csv += angle(row);
  const scratch_file urdf{".urdf", robot + "</robot>"}, path{".csv", csv}, cloud{".xyz", "0 0.1 0\n"};
  const std::string with = " --csv --backend host --model triangles --robot " + urdf.path + " --cloud " + cloud.path;
  const auto table = [&](const std::string& configurations) {
    std::istringstream text(run_command("plan --configurations " + configurations + with).out);
    std::vector<std::string> all;
    for (std::string line; std::getline(text, line);) all.push_back(line);
    return all;
  };
  const auto all = table(path.path);
  REQUIRE(all.size() == rows + 1);
  const auto answer = [](const std::string& line) { return line.substr(line.find(',')); };  // without the row's number
  for (const std::size_t row : {std::size_t(0), block - 1, block, block + 1, rows - 1}) {
    const scratch_file one{".csv", "j0\n" + angle(row)};
    CHECK(answer(all[row + 1]) == answer(table(one.path).at(1)));
  }
  CHECK(answer(all[block]) != answer(all[block + 1]));
}

}  // namespace plan_test

// SPDX-License-Identifier: BSD-3-Clause
// `clearance run`: a recording, frame by frame, compared with `clearance query` on each frame.
#include "tools/small_png.hpp"
#include "tools/two_boxes.hpp"

#include "io/xml.hpp"

#include <sys/stat.h>

#include <sstream>

namespace run_command_test {

namespace {

namespace fs = std::filesystem;

/// Three frames in a folder of their own, and a trajectory for them.
struct recording {
  scratch_file urdf{".urdf", testing::boxes_with_eye_text};
  scratch_file trajectory{".csv", "turn, slide\n0,0\n0.5,0.1\r\n-1,3e-1\n"};
  fs::path folder = fs::path(scratch_file("").path + "_frames");
  std::string slides[3] = {"0", "0.1", "0.3"}, turns[3] = {"0", "0.5", "-1"};

  recording() {
    fs::create_directory(folder);
    put("2.xyz", "0.31 0.02 0.1\n1 1 1\n");
    put("1.xyz", "5 5 5\nnan 0 0\n0.01 0.03 1.0\n");
    put("3.xyz", "3 0 0\n0 0.7 0.21\n");
    put(".notes", "no frame\n");  // others are noted: clouds_test
  }
  ~recording() { fs::remove_all(folder); }

  void put(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
  }
  std::string frame(int k) const { return (folder / (std::to_string(k + 1) + ".xyz")).string(); }
  std::string run(const std::string& frames, const std::string& csv) const {
    return "run --backend host --model triangles --robot " + urdf.path + " --frames " + frames + " --trajectory " + csv;
  }
  std::string run() const { return run(folder.string(), trajectory.path); }
  nlohmann::json query(int k, const std::string& cloud, const std::string& more = {}) const {
    return parsed(run_command("query --backend host --model triangles --json --robot " + urdf.path + " --joint slide=" +
                              slides[k] + " --joint turn=" + turns[k] + " --cloud " + cloud + ' ' + more));
  }
};

const char* const answered[] = {"state",     "distance", "lower",     "upper",       "cloud",  "point",
                                "point_xyz", "part",     "primitive", "nearest_xyz", "normal", "points"};

}  // namespace

TEST_CASE("clearance run answers each frame as clearance query does") {
  const recording r;
  for (const std::string more : {"", "--camera-link eye --camera-pose 0.1,0,0.2,0,0,0,1"}) {
    const outcome o = run_command(r.run() + ' ' + more);
    CHECK(o.code == 0);
    const auto all = lines(o);
    REQUIRE(all.size() == 3);
    for (int k = 0; k < 3; ++k) {
      INFO(more << " frame " << k);
      CHECK(all[k].at("frame") == k);
      CHECK(all[k].at("file") == r.frame(k));
      CHECK(all[k].at("latency_us").get<double>() > 0);
      const auto alone = r.query(k, r.frame(k), more);
      for (const char* key : answered) CHECK(all[k].at(key) == alone.at(key));
    }
    CHECK(all[0].at("distance") != all[1].at("distance"));
  }
}

TEST_CASE("a list names frames relative to itself, and one row holds for all") {
  const recording r;
  r.put("list", "3.xyz\n\n  1.xyz \r\n" + r.frame(2));
  const scratch_file row(".csv", "slide\n0.3\n");
  const auto all = lines(run_command(r.run((r.folder / "list").string(), row.path) + " --joint turn=-1"));
  REQUIRE(all.size() == 3);
  CHECK(all[0].at("file") == r.frame(2));
  CHECK(all[1].at("distance") == r.query(2, r.frame(0)).at("distance"));
  CHECK(all[2].at("distance") == all[0].at("distance"));
}

TEST_CASE("--merge asks every frame about the clouds of all, each where its camera was") {
  const recording r;
  // The camera is on the tool, so the clouds of the frames are apart by the slide.
  for (const bool carried : {false, true}) {
    const auto all = lines(run_command(r.run() + " --merge" + (carried ? " --camera-link eye" : "")));
    REQUIRE(all.size() == 3);
    for (int k = 0; k < 3; ++k) {
      nlohmann::json best;
      for (int other = 0; other < 3; ++other) {
        const std::string z = std::to_string(0.6 + std::stod(r.slides[other]));  // where the eye was
        const auto alone = r.query(k, r.frame(other), carried ? "--camera-pose 0,0," + z + ",0,0,0,1" : "");
        if (best.is_null() || alone.at("distance") < best.at("distance")) best = alone;
      }
      INFO("frame " << k << ", carried " << carried);
      CHECK(all[k].at("distance").get<double>() == Approx(best.at("distance").get<double>()).margin(1e-6));
      for (const char* key : {"cloud", "point", "part"}) CHECK(all[k].at(key) == best.at(key));
      CHECK(all[k].at("points").at("seen") == 7);
      CHECK(all[k].at("points").at("valid") == 6);
      CHECK(all[k].at("points").at("dropped").at("not_finite") == 1);
    }
  }
}

TEST_CASE("depth images are frames too, and keep their pixels when merged") {
  const recording r;
  for (const char* name : {"1.xyz", "2.xyz", "3.xyz"}) fs::remove(r.folder / name);
  r.put("a.png", png(700, 0));
  r.put("b.png", png(65535, 900));
  r.put("c.png", png(0, 500));
  const std::string camera = "--intrinsics 500,500,0,0 --range 0,0.8 --camera-link eye";
  const auto all = lines(run_command(r.run() + ' ' + camera));
  REQUIRE(all.size() == 3);
  for (int k = 0; k < 3; ++k) {
    const auto alone = r.query(k, all[k].at("file"), camera);
    for (const char* key : answered) CHECK(all[k].at(key) == alone.at(key));
  }
  CHECK(all[1].at("state") == "no_data");
  CHECK(all[2].at("pixel") == nlohmann::json({1, 0}));
  const auto merged = lines(run_command(r.run() + " --merge " + camera));
  REQUIRE(merged.size() == 3);
  for (const auto& line : merged) {  // at heights 0.6 + 0.7 and 0.6 + 0.3 + 0.5 above the base
    const auto& counts = line.at("points");
    CHECK(counts.at("seen") == 6);
    CHECK(counts.at("valid") == 2);
    CHECK(counts.at("dropped").at("missing") == 2);
    CHECK(counts.at("dropped").at("saturated") == 1);
    CHECK(counts.at("dropped").at("out_of_range") == 1);
    CHECK(line.at("cloud") == (r.folder / "a.png").string());
    CHECK(line.at("pixel") == nlohmann::json({0, 0}));
  }
  CHECK(merged[2].at("distance").get<double>() == Approx(0.4));
}

TEST_CASE("the exit code of a recording is its worst frame's") {
  const recording r;
  double least = 1e9;
  for (const auto& line : lines(run_command(r.run()))) least = std::min(least, line.at("lower").get<double>());
  CHECK(run_command(r.run() + " --check " + std::to_string(least - 1e-3)).code == 0);
  CHECK(run_command(r.run() + " --check " + std::to_string(least + 1e-3)).code == 2);
  r.put("2.xyz", "nan nan nan\n");
  const outcome blind = run_command(r.run() + " --check 0");
  CHECK(blind.code == 3);
  REQUIRE(lines(blind).size() == 3);
  CHECK(lines(blind)[1].at("state") == "no_data");
  CHECK(lines(blind)[1].at("cloud").is_null());
}

TEST_CASE("what is wrong with a recording is one sentence and exit code 1") {
  const recording r;
  const auto with = [&](const std::string& csv, const std::string& sentence) {
    const scratch_file file(".csv", csv);
    refuses(r.run(r.folder.string(), file.path), sentence);
  };
  with("slide\n0\n", ":1: has no column for joint \"turn\" (--joint turn=value fixes it)");
  with("slide,turn,elbow\n0,0,0\n", ":1: the robot has no joint \"elbow\"");
  with("slide,turn,mount\n0,0,0\n", "mount");
  with("slide,turn,\n0,0,0\n", ":1: ");
  with("slide,turn,slide\n0,0,0\n", ":1: has two columns for joint \"slide\"");
  with("slide,turn\n", "has no row");
  with("", "is empty (0 bytes)");
  with("slide,turn\n0,0\n0\n0,0\n", ":3: needs 2 numbers, one a column; here are 1");
  with("slide,turn\n0,0\n\n0,0\n", ":3: \"\" is not a number");
  with("slide,turn\n0,up\n", ":2: \"up\" is not a number");
  with("slide,turn\n0,nan\n", ":2: \"nan\" is not a finite number");
  with("slide,turn\n0,0\n0,0\n2,0\n", ":4: joint \"slide\" at 2.000000 is outside its limits");
  with("slide,turn\n0,0\n0,0\n", "has 2 rows, but there are 3 frames");
  refuses(r.run() + " --joint slide=0", "has a column for joint \"slide\", which --joint gives too");
  refuses(r.run(r.folder.string(), "nowhere.csv"), "nowhere.csv: there is no such file");
  refuses(r.run("nowhere", r.trajectory.path), "nowhere: there is no such file");
  refuses(r.run() + " --camera-link elbow", "the robot has no link \"elbow\"");
  refuses("run --frames x --trajectory y", "--robot is required");
  refuses(r.run() + " --cloud x.pcd", "--cloud");

  const fs::path empty = r.folder / "empty";
  fs::create_directory(empty);
  refuses(r.run(empty.string(), r.trajectory.path), "empty: has no frame");
  r.put("list", "\n \n");
  refuses(r.run((r.folder / "list").string(), r.trajectory.path), "lists no frame");
  r.put("list", "1.xyz\nx.las\n3.xyz\n");
  refuses(r.run((r.folder / "list").string(), r.trajectory.path) + " --merge", "x.las: is no point cloud by its name");
  r.put("0.png", "damaged");
  refuses(r.run(), "0.png is a depth image, which needs --intrinsics");
  fs::remove(r.folder / "0.png");
  refuses(r.run() + " --intrinsics 500,500,0,0", "--intrinsics: is for depth images, and there is none");
  refuses(r.run() + " --check -0.001", "--check: must not be negative (metres)");

  fs::remove(r.folder / "list");  // a note would name it
  r.put("2.xyz", "0 0 zero\n");   // the frames before it are answered
  const outcome o = run_command(r.run());
  CHECK(o.code == 1);
  CHECK(lines(o).size() == 1);
  CHECK(o.err.find("2.xyz:1: ") != std::string::npos);
  CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
  refuses(r.run() + " --merge", "2.xyz:1: ");
}

TEST_CASE(
    "what is named like a frame in a folder, and is no file, is refused: left out it would renumber those behind it") {
  const recording r;
  CHECK(run_command(r.run()).code == 0);
  const fs::path odd = r.folder / "1b.xyz";
  fs::create_symlink(r.folder / "nothing.xyz", odd);
  refuses(r.run(), "1b.xyz: is a link to what is not there, but is named like a frame");
  fs::remove(odd);
  fs::create_directory(odd);
  refuses(r.run(), "1b.xyz: is a folder, but is named like a frame");
  fs::remove(odd);
  fs::create_symlink(r.folder, odd);
  refuses(r.run(), "1b.xyz: is a folder, but is named like a frame");
  fs::remove(odd);
  fs::create_symlink(odd, odd);
  refuses(r.run(), "1b.xyz: ");
  fs::remove(odd);
  REQUIRE(::mkfifo(odd.c_str(), 0600) == 0);
  refuses(r.run(), "1b.xyz: is no regular file, but is named like a frame");
  fs::remove(odd);
  fs::create_directory(r.folder / "old");  // named like nothing
  REQUIRE(::mkfifo((r.folder / "pipe").c_str(), 0600) == 0);
  CHECK(lines(run_command(r.run())).size() == 3);
  fs::rename(r.folder / "2.xyz", r.folder / "old" / "2.xyz");
  fs::create_symlink("old/2.xyz", r.folder / "2.xyz");  // a link to a frame is one
  CHECK(lines(run_command(r.run())).size() == 3);
}

TEST_CASE("a frame that is listed twice and merged is told apart") {
  const recording r;
  const scratch_file row(".csv", "turn,slide\n0,0.3\n0,0\n");
  r.put("list", "3.xyz\n3.xyz\n");
  // The camera is on the slide: the second time the frame's points are 0.3 m lower, beside the tool.
  const auto all = lines(run_command(r.run((r.folder / "list").string(), row.path) + " --merge --camera-link tool"));
  REQUIRE(all.size() == 2);
  CHECK(all[1].at("cloud") == r.frame(2) + " (2)");
  CHECK(all[1].at("file") == r.frame(2));
}

TEST_CASE("a trajectory may begin with a byte order mark, end in blank lines, and end its lines anyhow") {
  const recording r;
  const std::string expected = run_command(r.run() + " --check 0").out;
  const auto states = [](const std::string& text) {
    std::string all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) all += nlohmann::json::parse(line).at("distance").dump() + ' ';
    return all;
  };
  for (const std::string end : {"\n", "\r\n", "\r"})
    for (const std::string mark : {"", "\xEF\xBB\xBF"})
      for (const std::string& last : {std::string(), end, end + end, end + " \t" + end}) {
        const scratch_file csv(".csv", mark + "turn, slide" + end + "0,0" + end + "0.5,0.1" + end + "-1,3e-1" + last);
        const scratch_file list(".txt", mark + r.frame(0) + end + end + r.frame(1) + end + r.frame(2) + last);
        const outcome o = run_command(r.run(list.path, csv.path));
        INFO(o.err);
        CHECK(o.code == 0);
        CHECK(states(o.out) == states(expected));
      }
}

TEST_CASE("a robot whose joints are all fixed needs no trajectory, and one without columns will do") {
  const recording r;
  const scratch_file box(
      ".urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link></robot>)");
  const std::string ask = "run --backend host --model triangles --frames " + r.folder.string() + " --robot ";
  const auto expected = lines(run_command(ask + box.path));
  REQUIRE(expected.size() == 3);
  for (const std::string text : {"\n", "\r\n", "\xEF\xBB\xBF\n\n", " "}) {
    const scratch_file csv(".csv", text);
    const auto all = lines(run_command(ask + box.path + " --trajectory " + csv.path));
    REQUIRE(all.size() == 3);
    for (int k = 0; k < 3; ++k) CHECK(all[k].at("distance") == expected[k].at("distance"));
  }
  const scratch_file values(".csv", "\n1\n");
  refuses(ask + box.path + " --trajectory " + values.path, values.path);
  CHECK(lines(run_command(ask + r.urdf.path + " --joint turn=0 --joint slide=0")).size() == 3);
  refuses(ask + r.urdf.path + " --joint turn=0", "joint \"slide\" has no value");
}

TEST_CASE("--svg draws the distance of every frame in the band of its bracket, and what is not known as such") {
  const recording r;
  const scratch_file svg(".svg", "old");
  const auto picture = [&] {
    std::ifstream in(svg.path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  /// Where the points of a path are.
  const auto path = [](const clearance::io::xml_element& root, const std::string& id) {
    std::vector<std::pair<double, double>> points;
    for (const auto& each : root.children) {
      const std::string* name = each.attribute("id");
      if (!name || *name != id) continue;
      std::istringstream in(*each.attribute("d"));
      for (std::string word; in >> word;)
        if (word == "M" || word == "L") in >> points.emplace_back().first >> points.back().second;
    }
    return points;
  };
  fs::permissions(svg.path, fs::perms(0640));
  const outcome plain = run_command(r.run()), o = run_command(r.run() + " --check 0.05 --svg " + svg.path);
  CHECK(o.code == 0);
  CHECK(fs::status(svg.path).permissions() == fs::perms(0640));
  const auto all = lines(o), before = lines(plain);
  REQUIRE(all.size() == 3);
  for (int k = 0; k < 3; ++k)
    for (const char* key : answered) CHECK(all[k].at(key) == before[k].at(key));
  auto root = clearance::io::read_xml(picture(), svg.path);
  const auto line = path(root, "distance"), band = path(root, "bracket");
  REQUIRE(line.size() == 3);
  REQUIRE(band.size() == 6);
  const auto metres = [&](int k, const char* key) { return all[k].at(key).get<double>(); };
  const double scale = (line[1].second - line[0].second) / (metres(1, "distance") - metres(0, "distance"));
  CHECK(scale < 0);  // up is far
  for (int k = 0; k < 3; ++k) {
    CHECK(line[k].second ==
          Approx(line[0].second + scale * (metres(k, "distance") - metres(0, "distance"))).margin(0.05));
    CHECK(band[k].second == Approx(line[0].second + scale * (metres(k, "upper") - metres(0, "distance"))).margin(0.05));
    CHECK(band[5 - k].second ==
          Approx(line[0].second + scale * (metres(k, "lower") - metres(0, "distance"))).margin(0.05));
    CHECK(band[5 - k].first == line[k].first);
    if (k > 0) CHECK(line[k].first > line[k - 1].first);
  }
  CHECK(picture().find("margin 0.05 m") != std::string::npos);
  CHECK(picture().find("no data") == std::string::npos);
  CHECK(path(root, "alone").empty());

  // Frames without data are bars, and the line ends there; one frame is a dot. Names are text, whatever is in them.
  r.put("2.xyz", "nan nan nan\n");
  const fs::path odd = r.folder / "a<b>&\"'\x01\xEF\xBF\xBF.txt";
  r.put(odd.filename().string(), "1.xyz\n2.xyz\n3.xyz\n");
  const std::string quoted = "\"$(printf '" + (r.folder / "a<b>&").string() + "\\042\\047\\001\\357\\277\\277.txt')\"";
  CHECK(run_command(r.run(quoted, r.trajectory.path) + " --svg " + svg.path).code == 3);
  root = clearance::io::read_xml(picture(), svg.path);
  CHECK(path(root, "distance").size() == 2);
  CHECK(path(root, "alone") == path(root, "distance"));  // a line of one frame is nothing to see
  CHECK(picture().find("a&lt;b&gt;&amp;&quot;&apos;\\x01\xEF\xBF\xBD.txt") != std::string::npos);
  CHECK(picture().find("red: no data") != std::string::npos);
  CHECK(picture().find("<rect x=") != std::string::npos);
  for (const std::string frame : {"1.xyz", "2.xyz"}) {
    r.put("list", frame + '\n');
    run_command("run --backend host --model triangles --robot " + r.urdf.path +
                " --joint slide=0 --joint turn=0 --frames " + (r.folder / "list").string() + " --svg " + svg.path);
    CHECK(path(clearance::io::read_xml(picture(), svg.path), "distance").size() == (frame == "1.xyz" ? 1 : 0));
  }
}

TEST_CASE("--csv says of every frame what the lines say, and of a plan which waypoint is the first") {
  const recording r;
  const scratch_file waypoints(".csv", "turn,slide\n0,0.3\n0,0.35\n");
  const auto table = [](const outcome& o) {
    INFO(o.err);
    std::vector<std::vector<std::string>> rows;
    std::istringstream in(o.out);
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line + ',');
      rows.emplace_back();
      for (std::string cell; std::getline(words, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
  };
  const std::string columns =
      "frame,file,state,distance,lower,upper,cloud,point,part,primitive,point_x,point_y,point_z,nearest_x,nearest_y,"
      "nearest_z,latency_us";
  const auto names = [&](const std::string& more) {
    return run_command(r.run() + " --csv" + more).out.starts_with(columns + (more.empty() ? "\n" : ","));
  };
  CHECK(names(""));
  CHECK(names(" --plan " + waypoints.path));
  for (const std::string margin : {"0.01", "0.12", "5"}) {
    const std::string more = " --plan " + waypoints.path + " --check " + margin;
    const outcome o = run_command(r.run() + more + " --csv"), plain = run_command(r.run() + more);
    CHECK(o.code == plain.code);
    const auto rows = table(o);
    const auto all = lines(plain);
    REQUIRE(rows.size() == 4);
    CHECK(rows[0].back() == "plan_first_below");
    for (int k = 0; k < 3; ++k) {
      const auto& row = rows[k + 1];
      INFO("frame " << k << " margin " << margin);
      REQUIRE(row.size() == 20);
      CHECK(row[0] == std::to_string(k));
      CHECK(row[1] == r.frame(k));
      const char* const keys[] = {"state", "distance", "lower", "upper", "cloud", "point", "part", "primitive"};
      for (int i = 0; i < 8; ++i) {
        const auto& value = all[k].at(keys[i]);
        CHECK(row[2 + i] == (value.is_string() ? value.get<std::string>() : value.is_null() ? "" : value.dump()));
      }
      for (int i = 0; i < 3; ++i) CHECK(row[10 + i] == all[k].at("point_xyz").at(i).dump());
      for (int i = 0; i < 3; ++i) CHECK(row[13 + i] == all[k].at("nearest_xyz").at(i).dump());
      CHECK(std::stod(row[16]) >= 0);
      const auto& plan = all[k].at("plan");
      CHECK(row[17] == plan.at("least").dump());
      CHECK(row[18] == plan.at("at").dump());
      CHECK(row[19] == (plan.at("first_below").is_null() ? "" : plan.at("first_below").dump()));
    }
  }
  // A picture and a table of the same run; a frame of which nothing is known has no numbers.
  r.put("2.xyz", "nan nan nan\n");
  const std::string svg = (r.folder / "out.svg").string();
  const outcome o = run_command(r.run() + " --csv --svg " + svg);
  CHECK(o.code == 3);
  CHECK(fs::exists(svg));
  const auto rows = table(o);
  REQUIRE(rows.size() == 4);
  REQUIRE(rows[2].size() == 17);
  CHECK(rows[2][2] == "no_data");
  for (int i = 3; i < 16; ++i) CHECK(rows[2][i].empty());
  refuses(r.run() + " --csv --json", "--json");
  refuses(r.run() + " --report out.html", "python3 -m clearance run --report out.html");
  refuses(r.run() + " --csv=yes", "--csv");
  fs::remove(svg);  // a note would name it
  r.put("1.xyz", "0 0 zero\n");
  refuses(r.run() + " --csv", r.frame(0));  // no line of names either
}

TEST_CASE("a frame that is far above all others is marked in the picture, and does not flatten them") {
  const recording r;
  r.put("near.xyz", "0 0 2\n"), r.put("far.xyz", "0 0 500\n");
  const std::string svg = (r.folder / "out.svg").string();
  const auto picture = [&](int far) {
    std::string list;
    for (int k = 0; k < 20; ++k) list += k < far ? "far.xyz\n" : "near.xyz\n";
    r.put("list", list);
    CHECK(run_command("run --backend host --model triangles --robot " + r.urdf.path +
                      " --joint slide=0 --joint turn=0 --frames " + (r.folder / "list").string() + " --svg " + svg)
              .code == 0);
    std::ifstream in(svg);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const auto heights = [](const std::string& svg) {  // of the line, from the lower edge
    std::vector<double> all;
    std::istringstream in(svg.substr(svg.find("id=\"distance\"")));
    for (std::string word; all.size() < 20 && in >> word;)
      if (word.ends_with("M") || word == "L") in >> word >> all.emplace_back();
    for (double& y : all) y = 350 - y;
    return all;
  };
  const std::string few = picture(2);
  const auto up = heights(few);
  REQUIRE(up.size() == 20);
  CHECK(up[0] == 300);  // the upper edge
  CHECK(up[2] > 90);
  CHECK(few.find("above the picture, up to 499 m") != std::string::npos);
  const std::string marks = few.substr(few.find("id=\"above\""));
  CHECK(std::count(marks.begin(), marks.begin() + std::ptrdiff_t(marks.find("/>")), 'M') == 2);

  const std::string many = picture(3);  // that is how it is there
  CHECK(heights(many)[2] == Approx(300).margin(1));
  CHECK(heights(many)[3] < 5);
  CHECK(many.find("above") == std::string::npos);
}

TEST_CASE("a picture is written when all is answered, whole or not at all, and never onto what is read") {
  const recording r;
  const std::string ask = r.run() + " --svg ", svg = (r.folder / "out.svg").string();
  for (const std::string name : {"out.png", "out", ".svg/"}) refuses(ask + (r.folder / name).string(), "--svg: ");
  refuses(ask + svg + " --svg " + svg, "--svg");
  refuses(ask + "/nonexistent/folder/x.svg", "/nonexistent/folder/x.svg: cannot be written");
  fs::create_symlink(r.frame(0), svg);
  refuses(ask + svg, "out.svg: is a symbolic link");
  fs::remove(svg);
  for (const std::string& input :
       {r.frame(1), r.urdf.path, r.trajectory.path}) {  // a frame that is not read yet is an input, too
    fs::create_hard_link(input, svg);
    refuses(ask + svg, "out.svg: is a file that this reads");
    fs::remove(svg);
  }
  r.put("out.svg", "old");
  const auto left = [&] {
    std::ifstream in(svg);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  std::string many;
  for (int k = 0; k < 200; ++k) many += "1.xyz\n";
  r.put("list", many);
  const std::string still = "run --backend host --model triangles --robot " + r.urdf.path +
                            " --joint slide=0 --joint turn=0 --frames " + (r.folder / "list").string();
  const outcome full = run_command(still + " --svg " + svg, {}, "ulimit -f 1; ");
  CHECK(full.code == 1);
  CHECK(full.err.find("out.svg: cannot be written") != std::string::npos);
  CHECK(left() == "old");
  r.put("3.xyz", "0 0 zero\n");
  CHECK(run_command(ask + svg).code == 1);  // a frame is damaged: what is not whole is not written
  CHECK(left() == "old");
  CHECK(run_command(still + " --svg " + svg).code == 0);
  CHECK(left().starts_with("<?xml"));
}

}  // namespace run_command_test

// SPDX-License-Identifier: BSD-3-Clause
// The command's output files are complete or absent, and never one of its inputs.
#include "io/scratch_file.hpp"
#include "tools/run_command.hpp"

#include <clearance/io/error.hpp>

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

namespace written_files_test {

namespace {

namespace fs = std::filesystem;

/// A folder with a robot that is a mesh, a cloud, and all that can be asked to write into it.
struct workplace {
  fs::path folder = fs::path(scratch_file("").path + "_written");

  workplace() {
    fs::create_directories(folder);
    std::string cube =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    put("cube.obj", cube);
    put("robot.urdf",
        R"(<robot name="r"><link name="a"><collision><geometry><mesh filename="cube.obj"/></geometry></collision></link></robot>)");
    std::string points;
    for (int i = 0; i < 300; ++i) points += "3 0.1 " + std::to_string(i) + "\n";
    put("cloud.xyz", points);
  }
  ~workplace() { fs::remove_all(folder); }

  void put(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
  }
  std::string at(const std::string& name) const { return (folder / name).string(); }
  std::string read(const std::string& name) const {
    std::ifstream in(folder / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  }
  /// Everything that writes, by the end of its file's name.
  std::vector<std::pair<std::string, std::string>> writers() const {
    const std::string pack = "pack " + at("cube.obj") + " --spheres 60 --no-cache --out ";
    const std::string query =
        "query --model triangles --backend host --robot " + at("robot.urdf") + " --cloud " + at("cloud.xyz");
    return {{".glb", query + " --scene "},
            {".ply", query + " --distances "},
            {".ist", pack},
            {".yaml", pack},
            {".csv", pack},
            {".glb", pack}};
  }
  std::size_t files() const {
    return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }
};

/// What a command that gets SIGINT had printed until then, and its status as wait() tells it. It comes once the command
/// has printed a line, or after a time.
struct interrupted {
  int status = 0;
  std::string out;

  interrupted(const std::string& arguments, std::chrono::duration<double> after) {
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    const auto own = std::signal(SIGINT, SIG_DFL);  // Catch2 has its own handler, which a child would have, too
    const ::pid_t child = ::fork();
    if (child == 0) {
      ::dup2(ends[1], 1), ::close(ends[0]), ::close(ends[1]);
      const std::string line = "CLEARANCE_CACHE= exec \"" + testing::command() + "\" " + arguments + " 2>/dev/null";
      ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      ::_exit(127);
    }
    std::signal(SIGINT, own);
    ::close(ends[1]);
    const auto begin = std::chrono::steady_clock::now();
    bool sent = false;
    for (char piece[4096];;) {
      if (!sent && (out.find('\n') != out.npos || std::chrono::steady_clock::now() - begin >= after))
        sent = ::kill(child, SIGINT) == 0;
      ::pollfd wait{ends[0], POLLIN, 0};
      if (!sent && ::poll(&wait, 1, 1) == 0) continue;
      const ::ssize_t n = ::read(ends[0], piece, sizeof piece);
      if (n <= 0) break;
      out.append(piece, std::size_t(n));
    }
    ::close(ends[0]);
    ::waitpid(child, &status, 0);
  }
  bool ended() const { return WIFSIGNALED(status) && WTERMSIG(status) == SIGINT; }
};

}  // namespace

TEST_CASE("a recording that is interrupted has printed whole answers, and the old picture stays") {
  const workplace w;
  std::string frames;
  for (int k = 0; k < 5000; ++k) frames += "cloud.xyz\n";
  w.put("frames.txt", frames);
  w.put("out.svg", "old");
  const std::string run = "run --model triangles --backend host --robot " + w.at("robot.urdf") + " --frames " +
                          w.at("frames.txt") + " --svg " + w.at("out.svg");
  const std::size_t before = w.files();
  for (const bool csv : {false, true}) {
    const interrupted i(run + (csv ? " --csv" : ""), std::chrono::hours(1));
    CHECK(i.ended());
    REQUIRE(i.out.ends_with('\n'));
    std::istringstream in(i.out);
    std::size_t answers = 0, commas = 0;
    for (std::string line; std::getline(in, line); ++answers) {
      if (!csv) CHECK(nlohmann::json::parse(line).at("frame") == answers);
      const auto its = std::size_t(std::count(line.begin(), line.end(), ','));
      CHECK((!csv || answers == 0 || its == commas));
      commas = its;
    }
    CHECK(answers < 5000);
    CHECK(w.read("out.svg") == "old");
    CHECK(w.files() == before);
  }
}

TEST_CASE("whenever a question is interrupted, files are old or whole, nothing is half printed") {
  const workplace w;
  std::string rows = "\n";
  for (int k = 0; k < 3000; ++k) rows += "\n";
  w.put("rows.csv", rows);
  const std::string ask =
      " --model triangles --backend host --robot " + w.at("robot.urdf") + " --cloud " + w.at("cloud.xyz");
  std::size_t ended = 0;
  for (const std::string& line : {"query" + ask + " --scene " + w.at("out") + ".glb",
                                  "query" + ask + " --json --distances " + w.at("out") + ".ply",
                                  "plan" + ask + " --csv --configurations " + w.at("rows.csv")}) {
    const std::string name = line.ends_with(".glb") ? "out.glb" : "out.ply";
    const auto begin = std::chrono::steady_clock::now();
    const outcome all = run_command(line);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    INFO(line << ": " << all.err);
    CHECK(all.code == 0);
    const std::string whole = line.starts_with("plan") ? "" : w.read(name);
    w.put(name, "old");
    const std::size_t before = w.files();
    for (const double share : {0.0, 0.2, 0.5, 0.8, 1.0}) {
      const interrupted i(line, share * time);
      ended += i.ended();
      CHECK((i.ended() || i.status == 0));
      const std::string is = w.read(name);
      CHECK((is == "old" || is == whole));
      CHECK(w.files() == before);
      CHECK((i.out.empty() || i.out.size() == all.out.size() || i.out.ends_with('\n')));
      w.put(name, "old");
    }
  }
  CHECK(ended > 0);
}

TEST_CASE("a file is replaced as a whole, with its permissions, and nothing is left beside it") {
  const workplace w;
  for (const auto& [ending, write] : w.writers()) {
    const std::string name = "out" + ending;
    INFO(write << name);
    w.put(name, "old");
    fs::permissions(w.folder / name, fs::perms(0640));
    const std::size_t before = w.files();
    const outcome o = run_command(write + w.at(name));
    INFO(o.err);
    CHECK(o.code == 0);
    CHECK(w.read(name).size() > 1000);
    CHECK(fs::status(w.folder / name).permissions() == fs::perms(0640));
    CHECK(w.files() == before);
    fs::remove(w.folder / name);
  }
}

TEST_CASE("where the disk is full, the old file stays, and one sentence says so") {
  const workplace w;
  for (const auto& [ending, write] : w.writers())
    for (const bool there : {true, false}) {
      const std::string name = "out" + ending;
      INFO(write << name);
      if (there) w.put(name, "old");
      const std::size_t before = w.files();
      const outcome o =
          run_command(write + w.at(name), {}, "ulimit -f 1; ");  // a block, which is smaller than any of them
      INFO(o.err);
      CHECK(o.code == 1);
      CHECK(o.out.empty());
      CHECK(o.err.find(w.at(name) + ": cannot be written") != std::string::npos);
      CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
      CHECK(w.files() == before);
      CHECK(fs::exists(w.folder / name) == there);
      if (there) CHECK(w.read(name) == "old");
      fs::remove(w.folder / name);
    }
}

TEST_CASE("a real file system that is full costs nothing but the new file") {
  const workplace w;
  const std::string small = w.at("small");
  fs::create_directory(small);
  if (std::system(("unshare -rm mount -t tmpfs none " + small + " 2>/dev/null").c_str()) != 0) {
    WARN("SKIPPED: no file system can be mounted here");
    return;
  }
  for (const auto& [ending, write] : w.writers()) {
    const scratch_file script(".sh", "mount -t tmpfs -o size=4k none " + small + " && cd " + small +
                                         " && echo old >out" + ending + " && CLEARANCE_CACHE= " + testing::command() +
                                         " " + write + small + "/out" + ending + "; code=$?; cat out" + ending +
                                         "; ls -A; exit $code\n");
    const outcome o = [&] {
      outcome made;
      FILE* pipe = ::popen(("unshare -rm sh " + script.path + " 2>/dev/null").c_str(), "r");
      REQUIRE(pipe);
      char piece[4096];
      for (std::size_t n; (n = std::fread(piece, 1, sizeof piece, pipe)) > 0;) made.out.append(piece, n);
      made.code = WEXITSTATUS(::pclose(pipe));
      return made;
    }();
    INFO(write);
    CHECK(o.code == 1);
    CHECK(o.out == "old\nout" + ending + "\n");
  }
}

TEST_CASE("nothing is written onto an input, whatever name it goes by, nor through a link, nor onto what is no file") {
  const workplace w;
  for (const auto& [ending, write] : w.writers()) {
    const bool query = write.starts_with("query");
    for (const std::string& input : query ? std::vector<std::string>{"robot.urdf", "cube.obj", "cloud.xyz"}
                                          : std::vector<std::string>{"cube.obj"}) {
      const std::string before = w.read(input), hard = w.at("hard" + ending);
      fs::create_hard_link(w.folder / input, hard);
      refuses(write + hard, "hard" + ending + ": is a file that this reads");
      if (query && ending == ".glb")
        refuses(write + w.at("../" + w.folder.filename().string() + "/./" + input), "is a file that this reads");
      fs::remove(hard);
      const std::string soft = w.at("soft" + ending);
      fs::create_symlink(w.folder / input, soft);
      refuses(write + soft, "soft" + ending + ": is a symbolic link");
      fs::remove(soft);
      CHECK(w.read(input) == before);
    }
    const std::string away = w.at("away" + ending);
    w.put("target", "kept");
    fs::create_symlink(w.folder / "target", away);
    refuses(write + away, "is a symbolic link");
    CHECK(w.read("target") == "kept");
    fs::remove(away);
    fs::create_symlink("/dev/full", away);
    refuses(write + away, "is a symbolic link");
    fs::remove(away);
    fs::create_directory(away);
    refuses(write + away, "is a folder");
    fs::remove(away);
    REQUIRE(::mkfifo(away.c_str(), 0600) == 0);
    refuses(write + away, "is no regular file");
    CHECK(fs::is_fifo(away));
    fs::remove(away);
    refuses(write + w.at("none/out" + ending), "cannot be written");
  }
  refuses(w.writers()[0].second + "/dev/full", "/dev/full: is no regular file");
}

TEST_CASE("an answer that cannot be printed is exit code 1, whatever prints it") {
  const workplace w;
  const std::string ask = w.writers()[0].second.substr(0, w.writers()[0].second.find(" --scene"));
  const std::string run =
      "run --model triangles --backend host --robot " + w.at("robot.urdf") + " --frames " + w.at("frames.txt");
  w.put("frames.txt", "cloud.xyz\n");
  const std::string plan = "plan" + ask.substr(5) + " --configurations " + w.at("rows.csv");
  w.put("rows.csv", "\n");
  for (const std::string& line :
       {ask, ask + " --json", ask + " --zones 0.1", run, plan, plan + " --csv",
        "pack " + w.at("cube.obj") + " --spheres 5", std::string("info"), std::string("info --json"),
        std::string("--version"), std::string("--help"), std::string("query --help")}) {
    INFO(line);
    CHECK(run_command(line).code == 0);
    for (const char* nowhere : {" >/dev/full", " >&-"}) {
      const outcome o = run_command(line + nowhere);
      CHECK(o.code == 1);
      CHECK(o.err.find("the output cannot be written") != std::string::npos);
    }
  }
  // A closed stdout is not taken for the file that is opened next.
  CHECK(run_command(ask + " --json --scene " + w.at("out.glb") + " >&-").code == 1);
  CHECK(w.read("out.glb").starts_with("glTF"));
  CHECK(w.read("out.glb").find("\"distance\"") == std::string::npos);
}

}  // namespace written_files_test

// SPDX-License-Identifier: BSD-3-Clause
// A file has no name until it is completely written.
#include "io/file_beside.hpp"
#include "io/robot_folder.hpp"
#include "support/catch.hpp"

#include <clearance/io/write_file.hpp>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>

namespace write_file_test {

using namespace clearance;

namespace {

namespace fs = std::filesystem;

std::size_t files(const robot_folder& folder) {
  return std::size_t(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()));
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Can files without a name be made here, and get one?
bool nameless(const robot_folder& folder) {
  const int at = ::open(folder.path.c_str(), O_WRONLY | O_TMPFILE, 0600);
  if (at >= 0) ::close(at);
  return at >= 0 && fs::exists("/proc/self/fd");
}

}  // namespace

TEST_CASE("whatever ends a program that writes a file leaves nothing, and the file as it was") {
  const robot_folder folder;
  if (!nameless(folder)) {
    WARN("SKIPPED: no file without a name can be made in " << folder.path);
    return;
  }
  for (const bool there : {false, true}) {
    const std::string file = (folder.path / (there ? "old" : "new")).string();
    if (there) folder.put("old", "old");
    const std::size_t before = files(folder);
    {
      io::file_beside made(file, 0600);
      made.write("half");
      CHECK(files(folder) == before);
    }
    CHECK(files(folder) == before);
    const ::pid_t child = ::fork();
    if (child == 0) {
      io::file_beside made(file, 0600);
      made.write("half");
      std::raise(SIGKILL);
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status));
    CHECK(files(folder) == before);
    if (there) CHECK(content(file) == "old");
    io::write_bytes(file, "whole");
    CHECK(content(file) == "whole");
    CHECK(files(folder) == before + !there);
  }
}

TEST_CASE("interrupted before any write, or on a disk that is full at any byte, the old file stays as it was, alone") {
  const robot_folder folder;
  if (!nameless(folder)) {
    WARN("SKIPPED: no file without a name can be made in " << folder.path);
    return;
  }
  const std::string file = folder.put("f", "old").string(), piece(100, 'x');
  constexpr int pieces = 4;
  /// Calls `before(n)` before the n-th write, and before the file is put in place.
  const auto write = [&](auto before) {
    int n = 0;
    io::write_pieces(file, [&] {
      before(n);
      return n++ < pieces ? piece : std::string();
    });
  };
  for (const int signal : {SIGINT, SIGTERM, SIGKILL})
    for (int k = 0; k <= pieces; ++k) {
      const ::pid_t child = ::fork();
      if (child == 0) {
        std::signal(signal, SIG_DFL);
        write([&](int n) {
          if (n == k) std::raise(signal);
        });
        ::_exit(0);
      }
      int status = 0;
      REQUIRE(::waitpid(child, &status, 0) == child);
      CHECK((WIFSIGNALED(status) && WTERMSIG(status) == signal));
      CHECK(content(file) == "old");
      CHECK(files(folder) == 1);
    }
  const auto xfsz = std::signal(SIGXFSZ, SIG_IGN);
  ::rlimit usual{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &usual) == 0);
  for (::rlim_t most = 0; most < pieces * piece.size(); most += 7) {
    const ::rlimit little{most, usual.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &little) == 0);
    const std::string told = sentence([&] { write([](int) {}); });
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &usual) == 0);
    CHECK(told == file + ": cannot be written: File too large");
    CHECK(content(file) == "old");
    CHECK(files(folder) == 1);
  }
  std::signal(SIGXFSZ, xfsz);
  // What gives the bytes may throw, too.
  for (int k = 0; k <= pieces; ++k) {
    CHECK(sentence([&] {
            write([&](int n) {
              if (n == k) throw std::runtime_error("no more bytes");
            });
          }) == "no more bytes");
    CHECK(content(file) == "old");
    CHECK(files(folder) == 1);
  }
  write([](int) {});
  CHECK(content(file).size() == pieces * piece.size());
}

TEST_CASE("a file that appears while another of its name is written is replaced, and a folder that does is not") {
  const robot_folder folder;
  const std::string file = (folder.path / "f").string();
  {
    io::file_beside made(file, 0600);
    made.write("mine");
    folder.put("f", "another's");
    made.put_in_place();
  }
  CHECK(content(file) == "mine");
  fs::remove(file);
  {
    io::file_beside made(file, 0600);
    fs::create_directory(file);
    CHECK(says(sentence([&] { made.put_in_place(); }), "cannot take its place"));
  }
  CHECK(files(folder) == 1);
}

}  // namespace write_file_test

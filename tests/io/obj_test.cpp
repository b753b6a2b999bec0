// SPDX-License-Identifier: BSD-3-Clause
// The statements of an OBJ file, and which of them contain geometry.
#include "io/robot_folder.hpp"
#include "support/catch.hpp"

#include <clearance/io/mesh.hpp>

namespace obj_test {

using namespace clearance;
using io::load_mesh;

namespace {

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

struct obj_file {
  robot_folder folder;
  triangle_mesh mesh(const std::string& text) const { return load_mesh(folder.put("m.obj", text)); }
  std::string refusal(const std::string& text) const {
    return sentence([&] { mesh(text); });
  }
};

}  // namespace

TEST_CASE("a backslash ends no comment and no name of an OBJ file, and joins the lines of all other statements") {
  const obj_file file;
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const auto with = [&](std::string text) {
      for (std::size_t at = 0; (at = text.find('\n', at)) != text.npos; at += end.size()) text.replace(at, 1, end);
      return text;
    };
    for (const char* before :
         {"# from C:\\robots\\", "#\\", "  # \\", "usemtl steel\\", "mtllib C:\\robots\\", "o arm\\", "g a b\\",
          "usemap x\\", "maplib a b\\", "shadow_obj x\\", "trace_obj x\\", "f 1 2 3 # from C:\\"})
      for (const char* after : {"f 1 3 4", "# steel\nf 1 3 4", "\nf 1 3 4", "usemtl b\\\nf 1 3 4"}) {
        const std::string text = with(square + "f 1 2 3\n" + before + "\n" + after + "\n");
        INFO(text);
        const auto mesh = file.mesh(text);
        REQUIRE(mesh.triangles.size() == (before[0] == 'f' ? 3 : 2));
        CHECK(mesh.triangles.back() == std::array<std::uint32_t, 3>{0, 2, 3});
      }
    CHECK(file.mesh(with(square + "f 1 \\\n2 \\\n3\ng a \\\n b \\\n c\nf 1 3\\\n 4\n")).triangles.size() == 2);
    CHECK(file.mesh(with("v 0 \\\n0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")).triangles.size() == 1);
    CHECK(says(file.refusal(with("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\")), ":4: "));  // cut short
    // A face that a lost line end joins to the next one is still none, and a line's number is that of its first.
    CHECK(says(file.refusal(with(square + "f 1 2 3 \\\nf 1 3 4\n")), ":5: \"f\" is no vertex"));
    CHECK(says(file.refusal(with(square + "f 1 \\\n2 \\\n3\nf 1 2 9\n")), ":8: a face has vertex 9"));
  }
}

TEST_CASE("what an OBJ file has beside polygons and would be lost is refused by its line") {
  const obj_file file;
  const std::string surface = "cstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nparm u 0 1\nparm v 0 1\nend\n";
  CHECK(says(file.refusal(square + "f 1 2 3\n" + surface), ":8: \"surf\" brings geometry"));
  for (const std::string more : {"surf 0 1 0 1 1 2 3 4", "curv 0 1 1 2", "curv2 1 2", "bsp 1 2", "bzp 1 2 3 4",
                                 "cdc 1 2", "cdp 1 2", "call other.obj", "csh cat other.obj"})
    for (const std::string& text : {square + "f 1 2 3\n" + more + "\n", more + "\n" + square + "f 1 2 3\n"}) {
      INFO(text);
      CHECK(says(file.refusal(text), "\"" + more.substr(0, more.find(' ')) + "\" brings geometry"));
    }
  // Before the first vertex only counts may stand that are no statement: a vertex whose word is damaged shifts all
  // faces.
  CHECK(file.mesh("4 1\n" + square + "f 1 2 3\n").triangles.size() == 1);
  for (const std::string first : {"V 0 0 0", "w 0 0 0", "0 0 0", "v0 0 0", "solid x", "4.5 1", "-4 1"}) {
    INFO(first);
    CHECK(says(file.refusal(first + "\n" + square + "f -1 -2 -3\n"), ":1: "));
  }
}

TEST_CASE("a face whose hole is joined by a bridge covers all but the hole, by equal corners and by equal places") {
  const obj_file file;
  const std::string outer = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\n", hole = "v 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n";
  for (const std::string more : {"f 1 2 3 4 1 5 6 7 8 5\n", "v 0 0 0\nv 1 1 0\nf 1 2 3 4 9 5 6 7 8 10\n"}) {
    INFO(more);
    const auto mesh = file.mesh(outer + hole + more);
    double area = 0;
    for (const auto& t : mesh.triangles) {
      const auto& v = mesh.vertices;
      const double its = (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]).z() / 2;
      const Eigen::Vector3d middle = (v[t[0]] + v[t[1]] + v[t[2]]) / 3;
      CHECK(its >= 0);
      if (its > 0) CHECK((middle.x() < 1 || middle.x() > 3 || middle.y() < 1 || middle.y() > 3));
      area += its;
    }
    CHECK(area == Approx(12));
  }
}

TEST_CASE("edges that an OBJ file has as faces are triangles without area, beside others") {
  const obj_file file;
  const auto mesh = file.mesh(square + "f 1 2 3\nf 3 4\nf 2/1/1\nf 1 3 4\n");
  REQUIRE(mesh.triangles.size() == 4);
  CHECK(mesh.triangles[1] == std::array<std::uint32_t, 3>{2, 3, 3});
  CHECK(mesh.triangles[2] == std::array<std::uint32_t, 3>{1, 1, 1});
  CHECK(mesh.triangles[3] == std::array<std::uint32_t, 3>{0, 2, 3});
  CHECK(says(file.refusal(square + "f 1 2 3\nf\n"), ":6: a face has fewer than three"));
  CHECK(says(file.refusal(square + "f 1 2\nf 3 4\n"), "fewer than three"));                 // no surface at all
  CHECK(says(file.refusal(square + "f 1 2 3\nf 1 3"), ":6: a face has fewer than three"));  // cut short
  CHECK(says(file.refusal(square + "f 1 2 3\nf 1 9\n"), ":6: a face has vertex 9"));
}

TEST_CASE("a text mesh may begin with a byte order mark, and is the same mesh") {
  const robot_folder folder;
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n", mark = "\xEF\xBB\xBF";
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const std::string head =
      "property float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  const std::pair<std::string, std::string> files[] = {
      {"m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf -4 -3 -2\n"},
      {"m.off", "OFF\n3 1 0\n" + vertices + "3 0 1 2\n"},
      {"m.stl", "solid\n" + facet + "endsolid\n"},
      {"m", "solid\n" + facet + "endsolid\n"},
      {"m.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + head + vertices + "3 0 1 2\n"},
      {"m", "ply\nformat ascii 1.0\nelement vertex 3\n" + head + vertices + "3 0 1 2\n"},
      {"m", "OFF\n3 1 0\n" + vertices + "3 0 1 2\n"}};
  for (const auto& [name, text] : files) {
    INFO(text);
    const auto plain = load_mesh(folder.put(name, text)), marked = load_mesh(folder.put(name, mark + text));
    CHECK(plain.vertices == marked.vertices);
    CHECK(plain.triangles == marked.triangles);
    CHECK_FALSE(sentence([&] { load_mesh(folder.put(name, mark + mark + text)); }).empty());
  }
}

}  // namespace obj_test

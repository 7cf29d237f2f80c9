// SPDX-License-Identifier: MIT
// The OBJ reader: indices, polygons, materials, textures, real files, and what it says of files that are wrong.
#include <catch2/catch.hpp>
#include <chrono>

#include "scenes/error.h"
#include "scenes/image_file.h"
#include "scenes/read.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

Scene read_text(const std::string& text) {
  const TemporaryFolder folder;
  return read_scene(folder.write("test.obj", text));
}

std::string error_of(const std::string& text) {
  const TemporaryFolder folder;
  try {
    read_scene(folder.write("test.obj", text));
  } catch (const InputError& error) {
    const std::string message = error.what();
    return message.substr(message.find("test.obj"));
  }
  return {};
}

bool has_warning(const Scene& scene, const std::string& part) {
  for (const std::string& warning : scene.warnings) {
    if (warning.find(part) != warning.npos) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("OBJ faces: negative indices, indices of later vertices, all forms of corners, continued lines") {
  const Scene scene = read_text(
      "v 0 0 0 # a comment\r\nv 1 0 0\nvt 0.25 0.75\nvn 0 0 1\nv 0 1 0\nf -3/-1/-1 -2/1/1 \\\n 3/1/1\nf 1//1 2//1 3//1 "
      "# 9\nf 1/1 2/1 "
      "3/1\nf 2 1 4\n"
      "v 0 0 7\n");
  REQUIRE(scene.triangles.size() == 4);
  CHECK(scene.source.patches == 2);
  CHECK(scene.source.polygons == 2);
  CHECK(scene.corners(0)[2] == glm::vec3(0, 1, 0));
  CHECK(scene.triangles[0].normal[0] == 0);
  CHECK(scene.triangles[0].texcoord[2] == 0);
  CHECK(scene.texcoords[0] == glm::vec2(0.25f, 0.75f));
  CHECK(scene.triangles[1].texcoord[0] == kNone);
  CHECK(scene.triangles[2].normal[0] == kNone);
  CHECK(scene.corners(3)[2] == glm::vec3(0, 0, 7));
  CHECK_FALSE(scene.has_camera);
  CHECK(scene.camera.from != scene.camera.at);
  CHECK(scene.warnings.empty());
}

TEST_CASE("OBJ polygons of any size and shape become triangles") {
  // Concave: the fan from the first corner would leave the polygon.
  const Scene scene = read_text("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1 5//1\n");
  REQUIRE(scene.triangles.size() == 3);
  double area = 0.0;
  for (std::uint32_t t = 0; t < 3; ++t) {
    const auto c = scene.corners(t);
    area += 0.5 * glm::cross(c[1] - c[0], c[2] - c[0]).z;
    CHECK(scene.triangles[t].normal[1] == 0);
  }
  CHECK(area == 10.0);
  CHECK(scene.source.patches == 1);
}

TEST_CASE("OBJ that is wrong is refused with file and line") {
  CHECK(error_of(kTriangle + "f 1 2 4\n") == "test.obj:4: the index 4 is out of range: there are 3 vertices");
  CHECK(error_of(kTriangle + "f 1 2 -4\n") == "test.obj:4: the index -4 is out of range: there are 3 vertices so far");
  CHECK(error_of(kTriangle + "f 1 2 2147483648\n").find("test.obj:4: the index 2147483648 is out of range") == 0);
  CHECK(error_of(kTriangle + "f 1 2 -2147483648\n").find("test.obj:4: the index -2147483648") == 0);
  CHECK(error_of(kTriangle + "f 1 2 99999999999999999999\n").find("test.obj:4:") == 0);
  CHECK(error_of(kTriangle + "f 0 1 2\n").find("test.obj:4: the index 0") == 0);
  CHECK(error_of(kTriangle + "f 1/1 2/1 3/1\n") ==
        "test.obj:4: the index 1 is out of range: there are 0 texture coordinates");
  CHECK(error_of(kTriangle + "f 1//2 2//1 3//1\nvn 0 0 1\n")
            .find("test.obj:4: the index 2 is out of range: there are 1 normals") == 0);
  CHECK(error_of(kTriangle + "f 1 2 x\n").find("test.obj:4:") == 0);
  CHECK(error_of(kTriangle + "f 1 2 3/\v\n").find("test.obj:4:") == 0);
  CHECK(error_of(kTriangle + "f 1/1/1/1 2 3\n").find("test.obj:4:") == 0);
  CHECK(error_of("v 0 0\n").find("test.obj:1: v (vertex) takes 3 numbers") == 0);
  CHECK(error_of("\n\nv 0 0 nan\n").find("test.obj:3: expected a finite number, found 'nan'") == 0);
  CHECK(error_of("v 0 0 1e39\n").find("test.obj:1:") == 0);
  CHECK(error_of("v 0 0 -0.:99\n").find("test.obj:1:") == 0);
  CHECK(error_of("vn 0 0\n").find("test.obj:1:") == 0);
  CHECK(error_of("# nothing\n").find("nothing to trace") != std::string::npos);
  CHECK(error_of(kTriangle + "f\nf 1 2\nf 1 2 2\n").find("a face with fewer than 3 corners") != std::string::npos);
}

TEST_CASE("OBJ that can be mended is read with a warning that names the line") {
  const Scene scene = read_text(
      "mtllib nothere.mtl\nusemtl stone\n" + kTriangle +
      "f 1 2 3\nf 1 2\nf 1 1 2\nf\nl 1 2\nwhat is this\nf 3 2 1\nvn 0 0 1\nf 1//1 2 3\nv 1 2 3 0.5 0.5 0.5\nusemtl \n");
  CHECK(scene.triangles.size() == 3);
  CHECK(scene.source.total() == 4);  // the one without area counts, those with less than 3 corners are no faces
  CHECK(scene.materials.size() == 1);
  CHECK(has_warning(scene, "test.obj:1: the material file"));
  CHECK(has_warning(scene, "test.obj:2: a material that no MTL file has"));
  CHECK(has_warning(scene, "test.obj:7: a face with fewer than 3 corners"));
  CHECK(has_warning(scene, "test.obj:8: a face without area"));
  CHECK(has_warning(scene, "test.obj:9: a face without corners"));
  CHECK(has_warning(scene, "test.obj:10: statements 'l' are not read"));
  CHECK(has_warning(scene, "test.obj:11: statements 'what' are not read"));
  CHECK(has_warning(scene, "test.obj:14: a face has normals or texture coordinates at some corners only"));
  CHECK(has_warning(scene, "test.obj:15: a vertex has a weight or a colour"));
  CHECK(has_warning(scene, "test.obj:16: a usemtl or mtllib statement without a name"));
}

TEST_CASE("MTL materials are mapped, with textures decoded from sRGB and heights as they are") {
  const TemporaryFolder folder;
  const std::uint8_t pixels[] = {255, 188, 0, 128, 128, 128};
  write_png(folder.path() / "a b.png", 2, 1, pixels);
  folder.write(
      "my materials.mtl",
      "newmtl textured \n\tKs 0.25\n map_Kd a b.png\nmap_bump -bm 0.5 a b.png\n"
      "newmtl glass # not part of the name for others\nKd 0.5 0.25 1 # blue\nTf 0.5 0.5 0.5\nNi 1.5\nNs 200\nillum 7\n"
      "newmtl thin\nKd 1 1 1\nd 0.25\nKe 1 1 1\nmap_Ks a.png\nnewmtl late\nmap_Kd missing.png\nKa 1 1 1\n");
  const Scene scene =
      read_scene(folder.write("test.obj", "mtllib my materials.mtl\n" + kTriangle +
                                              "usemtl textured\nf 1 2 3\nusemtl glass # not part of the name for "
                                              "others\nf 1 2 3\nusemtl  thin \nf 1 2 3\nusemtl late\nf 1 2 3\n"));
  REQUIRE(scene.materials.size() == 4);
  REQUIRE(scene.triangles.size() == 4);
  for (std::uint32_t i = 0; i < 4; ++i) CHECK(scene.triangles[i].material == i);
  const Material &textured = scene.materials[0], &glass = scene.materials[1], &thin = scene.materials[2],
                 &late = scene.materials[3];
  CHECK(textured.name == "textured");
  CHECK(textured.color == glm::vec3(1.0f));
  CHECK(textured.specular == 0.25f);
  REQUIRE(textured.diffuse_texture < scene.textures.size());
  REQUIRE(textured.bump_texture < scene.textures.size());
  const Texture &color = scene.textures[textured.diffuse_texture], &height = scene.textures[textured.bump_texture];
  CHECK(color.width == 2);
  CHECK(color.height == 1);
  CHECK(color.texels[0].r == 1.0f);
  CHECK(color.texels[0].g == Approx(0.5029f).epsilon(1e-3));  // sRGB 188
  CHECK(color.texels[1].b == Approx(0.2159f).epsilon(1e-3));  // sRGB 128
  CHECK(textured.bump_scale == 0.5f);
  CHECK(height.texels[1].r == Approx(128.0f / 255.0f));
  CHECK(height.texels[0].b == 1.0f);
  CHECK(glass.bump_scale == 1.0f);
  CHECK(glass.glossy < 0.0f);
  CHECK(glass.transmittance == 0.5f);
  CHECK(glass.refraction_index == 1.5f);
  CHECK(glass.shine == 200.0f);
  CHECK(glass.color == glm::vec3(0.5f, 0.25f, 1.0f));
  CHECK(thin.transmittance == 0.75f);
  CHECK(late.diffuse_texture == kNone);
  CHECK(late.color == glm::vec3(1.0f));  // not the black of a material without Kd, nor the one before's
  CHECK(has_warning(scene, "my materials.mtl:17: the texture 'missing.png' is left out"));
  CHECK(has_warning(scene, "my materials.mtl:14: statements 'Ke' are not used"));
  CHECK(has_warning(scene, "my materials.mtl:15: statements 'map_Ks' are not used"));
}

TEST_CASE("MTL that is wrong is refused with file and line") {
  const auto error_of_mtl = [](const std::string& text) -> std::string {
    const TemporaryFolder folder;
    folder.write("test.mtl", text);
    try {
      read_scene(folder.write("test.obj", "mtllib test.mtl\n" + kTriangle + "f 1 2 3\n"));
    } catch (const InputError& error) {
      const std::string message = error.what();
      return message.substr(message.find("test.mtl"));
    }
    return {};
  };
  CHECK(error_of_mtl("newmtl a\nKd 1 x 1\n") == "test.mtl:2: expected a finite number, found 'x'");
  CHECK(error_of_mtl("newmtl a\nKd 1 1\n") == "test.mtl:2: Kd takes 1 number or 3");
  CHECK(error_of_mtl("newmtl a\nNs inf\n").find("test.mtl:2:") == 0);
  CHECK(error_of_mtl("newmtl a\nd\n").find("test.mtl:2:") == 0);
  CHECK(error_of_mtl("newmtl a\nmap_Kd\n").find("test.mtl:2:") == 0);
  CHECK(error_of_mtl("newmtl a\n" + std::string(1, '\0') + "\n").find("test.mtl:2: a NUL byte") == 0);
  CHECK(error_of_mtl("newmtl a\nKd spectral x.rfl\n").empty());
}

TEST_CASE("Real OBJ files have the published numbers of faces, and only the warnings that they deserve") {
  PLUMBLINE_NEEDS_DATA();
  struct Expected {
    const char* name;
    std::size_t faces, triangles, materials, textures;
    std::vector<std::string> warnings;
  };
  const Expected expected[] = {
      {"spot_mtl/spot", 5856, 5856, 1, 1, {"'bsdf'"}},
      {"bunny/stanford-bunny", 69451, 69451, 1, 0, {}},
      // 112 faces name a vertex twice or lie on a line, and 29 of 91 materials repeat a name.
      {"medieval/Medieval_building",
       16715,
       16715 - 112,
       91 - 29,
       7,
       {"name that was there before is left out (29", "without area is left out (112"}},
      {"cornell_mcguire_akuna/CornellBox-Original", 18, 36, 8, 0, {"'Ke'"}},
      {"cornell_wallisc/CornellBox-Sphere", 2188, 2188, 8, 0, {"'Ke'", "'v'"}},
      {"cornell_wallisc/CornellBox-Water", 7088, 7088, 9, 0, {"'Ke'"}},
      {"bullet/banana", 1100, 1100, 1, 1, {}},
      // Its MTL file bears another name. 864 quadrilaterals and 64 triangles.
      {"bullet/textured_sphere_smooth",
       928,
       2 * 864 + 64,
       1,
       0,
       {"'textured_sphere_smooth.mtl' is missing", "no MTL file has"}},
  };
  for (const Expected& e : expected) {
    INFO(e.name);
    const auto start = std::chrono::steady_clock::now();
    const Scene scene = read_scene(data_folder() / "obj" / (std::string(e.name) + ".obj"));
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
    CHECK(scene.source.total() == e.faces);
    CHECK(scene.triangles.size() == e.triangles);
    CHECK(scene.materials.size() == e.materials);
    CHECK(scene.textures.size() == e.textures);
    CHECK(scene.warnings.size() == e.warnings.size());
    for (const std::string& warning : e.warnings) CHECK(has_warning(scene, warning));
  }
}

TEST_CASE("Every kind of texture that is used is found") {
  PLUMBLINE_NEEDS_DATA();
  const TemporaryFolder folder;
  const auto source = data_folder() / "obj/ufbx_textures";
  std::filesystem::copy(source, folder.path(), std::filesystem::copy_options::recursive);
  const Scene scene = read_scene(folder.write("test.obj", "mtllib synthetic_simple_textures_0_mtl.mtl\n" + kTriangle +
                                                              "usemtl RGB\nf 1 2 3\nusemtl NonMap\nf 1 2 3\n"));
  const Material &rgb = scene.materials[scene.triangles[0].material],
                 &other = scene.materials[scene.triangles[1].material];
  REQUIRE(rgb.diffuse_texture != kNone);
  REQUIRE(rgb.bump_texture != kNone);
  CHECK(rgb.diffuse_texture != rgb.bump_texture);
  CHECK(other.diffuse_texture == kNone);
  CHECK(other.bump_texture == rgb.bump_texture);
  CHECK(
      scene.textures[rgb.diffuse_texture].texels.size() ==
      static_cast<std::size_t>(scene.textures[rgb.diffuse_texture].width * scene.textures[rgb.diffuse_texture].height));
}

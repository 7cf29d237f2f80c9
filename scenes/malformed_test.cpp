// SPDX-License-Identifier: MIT
// Broken files: each gives one error that names the file, or a scene that can be traced, in time, and never silence.
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>

#include "scenes/error.h"
#include "scenes/random.h"
#include "scenes/read.h"
#include "scenes/test_files.h"

using namespace plumbline;

namespace {

struct Outcome {
  std::string error;  // empty where a scene came out
  std::size_t warnings = 0;
  double seconds = 0.0;
};

/// Whether what came out can be traced: indices in range, numbers finite, sizes positive.
bool is_sound(const Scene& scene) {
  if (scene.primitive_count() == 0 || scene.materials.empty()) return false;
  for (const Triangle& t : scene.triangles) {
    if (t.material >= scene.materials.size()) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      if (t.position[i] >= scene.positions.size()) return false;
      if ((t.normal[i] == kNone) != (t.normal[0] == kNone) || (t.texcoord[i] == kNone) != (t.texcoord[0] == kNone))
        return false;
      if (t.normal[i] != kNone && t.normal[i] >= scene.normals.size()) return false;
      if (t.texcoord[i] != kNone && t.texcoord[i] >= scene.texcoords.size()) return false;
    }
  }
  for (const glm::vec3& p : scene.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
  }
  for (const Sphere& sphere : scene.spheres) {
    if (!(sphere.radius > 0.0f) || sphere.material >= scene.materials.size()) return false;
  }
  for (const Material& material : scene.materials) {
    if (material.diffuse_texture != kNone && material.diffuse_texture >= scene.textures.size()) return false;
    if (material.bump_texture != kNone && material.bump_texture >= scene.textures.size()) return false;
    if (!std::isfinite(material.bump_scale)) return false;
    if (!std::isfinite(material.shine) || !(material.transmittance >= 0.0f && material.transmittance <= 1.0f))
      return false;
  }
  return true;
}

/// Reads a file that may be broken; a scene must be sound, an error must name `named` and be one line.
Outcome read_broken(const std::filesystem::path& path, const std::string& named) {
  Outcome outcome;
  const auto start = std::chrono::steady_clock::now();
  try {
    const Scene scene = read_scene(path);
    CHECK(is_sound(scene));
    outcome.warnings = scene.warnings.size();
    for (const std::string& warning : scene.warnings) CHECK(warning.find('\n') == warning.npos);
  } catch (const InputError& error) {
    outcome.error = error.what();
    CHECK(outcome.error.find(named) != std::string::npos);
    CHECK(outcome.error.find('\n') == std::string::npos);
    CHECK(outcome.error.size() < 20000);
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  CHECK(outcome.seconds < 2.0);
  return outcome;
}

std::vector<std::filesystem::path> files_of(const char* folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / "malformed" / folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

TEST_CASE("Malformed OBJ files of other projects: an error with a line, or a sound scene") {
  PLUMBLINE_NEEDS_DATA();
  std::size_t errors = 0, scenes = 0;
  for (const auto& path : files_of("obj")) {
    INFO(path);
    const Outcome outcome = read_broken(path, path.filename().string());
    ++(outcome.error.empty() ? scenes : errors);
    // The line stands after the name, but where the whole file holds nothing to trace.
    if (!outcome.error.empty() && outcome.error.find("nothing to trace") == std::string::npos) {
      const std::size_t colon = outcome.error.find(".obj:") + 5;
      CHECK(std::isdigit(static_cast<unsigned char>(outcome.error[colon])));
    }
  }
  CHECK(errors + scenes == 131);
  CHECK(errors > 0);
}

TEST_CASE("Malformed MTL files: an error with a line, or a sound scene") {
  PLUMBLINE_NEEDS_DATA();
  for (const auto& path : files_of("mtl")) {
    INFO(path);
    const TemporaryFolder folder;
    std::filesystem::copy_file(path, folder.path() / "broken.mtl");
    read_broken(folder.write("whole.obj", "mtllib broken.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"),
                "broken.mtl");
  }
}

TEST_CASE("NFF of another program: what is not of the format is named, with its line") {
  PLUMBLINE_NEEDS_DATA();
  const std::pair<const char*, const char*> expected[] = {
      {"cone.nff", "cone.nff:6: unknown keyword 'tess'"},
      {"cylinder.nff", "cylinder.nff:5: unknown keyword 'tess'"},
      {"dodecahedron.nff", "dodecahedron.nff:1: unknown keyword 'dod'"},
      {"hexahedron.nff", "hexahedron.nff:2: f: Kd: expected a finite number, found 'hex'"},
      {"octahedron.nff", "octahedron.nff:1: unknown keyword 'oct'"},
      {"positionTest.nff", "positionTest.nff:3: unknown keyword 'tess'"},
      {"spheres.nff", "spheres.nff:11: f: index of refraction: expected a finite number, found 's'"},
      {"tetrahedron.nff", "tetrahedron.nff:1: unknown keyword 'tet'"},
      {"ManyEarthsNotJustOne.nff", ""},
      {"WithCamera.nff", ""},
  };
  for (const auto& [name, message] : expected) {
    INFO(name);
    const Outcome outcome = read_broken(data_folder() / "malformed" / "nff" / name, name);
    if (*message != '\0') {
      CHECK(outcome.error.find(message) != std::string::npos);
    } else {
      CHECK(outcome.error.empty());
    }
  }
  CHECK(read_scene(data_folder() / "malformed/nff/ManyEarthsNotJustOne.nff").warnings.size() == 2);
  CHECK(read_scene(data_folder() / "malformed/nff/ManyEarthsNotJustOne.nff").spheres.size() == 10);
}

TEST_CASE("Paths that are no scene files are told apart") {
  const TemporaryFolder folder;
  const auto error_of = [](const std::filesystem::path& path) -> std::string {
    try {
      read_scene(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  for (const char* ending : {".nff", ".obj"}) {
    const std::string name = std::string("x") + ending;
    CHECK(error_of(folder.path() / name).find("no such file") != std::string::npos);
    CHECK(error_of(folder.write(name, "")).find(name + ":1: the file is empty") != std::string::npos);
    CHECK(error_of(folder.write(name, std::string("\n\nv 0 \0", 8))).find(name + ":3: a NUL byte") !=
          std::string::npos);
    std::filesystem::create_directory(folder.path() / ("folder" + std::string(ending)));
    CHECK(error_of(folder.path() / ("folder" + std::string(ending))).find("this is a folder") != std::string::npos);
  }
  CHECK(error_of("/dev/null").find("no reader") != std::string::npos);
  CHECK(error_of(folder.path()).find("this is a folder") != std::string::npos);
  CHECK(error_of(folder.write("x.ply", "ply\n")).find("there are readers for .nff, .obj") != std::string::npos);
}

TEST_CASE("Lines of 10 MB, binary junk, and files cut short end in time") {
  const TemporaryFolder folder;
  constexpr std::size_t kSize = 10'000'000;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto repeated = [](const std::string& start, const std::string& part) {
    std::string text = start;
    while (text.size() < kSize) text += part;
    return text;
  };
  CHECK(read_broken(folder.write("a.obj", repeated(triangle + "f", " 1 2 3") + "\n"), "a.obj")
            .error.find("a.obj:4: a face of") != std::string::npos);
  CHECK(read_broken(folder.write("b.obj", repeated("v", " 1") + "\n"), "b.obj").error.find("b.obj:1:") !=
        std::string::npos);
  CHECK(read_broken(folder.write("c.obj", repeated(triangle + "f 1 2 3\n#", "x") + "\n"), "c.obj").error.empty());
  CHECK(read_broken(folder.write("d.obj", repeated("v 1", "1") + "\n"), "d.obj").error.find("d.obj:1:") !=
        std::string::npos);
  CHECK(read_broken(folder.write("e.obj", repeated(triangle + "f 1 2 3\nusemtl ", "x") + "\n"), "e.obj").error.empty());
  CHECK(read_broken(folder.write("f.obj", repeated(triangle + "f 1 2 3\n", "f 1 2\n") + "\n"), "f.obj").error.empty());
  CHECK(
      read_broken(folder.write("g.obj", repeated(triangle + "f 1 2 3\nmtllib ", "x ") + "\n"), "g.obj").error.empty());
  CHECK(read_broken(folder.write("h.nff", repeated("f 1 1 1 1 0 1 0 1\np 3000000", " 0 1 1 1 0 0") + "\n"), "h.nff")
            .error.find("h.nff:2:") != std::string::npos);
  CHECK(read_broken(folder.write("i.nff", repeated("s 0 0 0 1 #", "x") + "\n"), "i.nff").error.empty());
  CHECK(read_broken(folder.write("j.nff", repeated("", "xyz")), "j.nff").error.find("j.nff:1: unknown keyword") !=
        std::string::npos);
  CHECK(read_broken(folder.write("k.obj", repeated("", "x y z\n")), "k.obj").error.find("nothing to trace") !=
        std::string::npos);

  std::string junk;
  for (std::uint64_t i = 0; i < 100'000; ++i) junk += static_cast<char>(1 + Random(1, 2, i).below(255));
  CHECK_FALSE(read_broken(folder.write("junk.obj", junk), "junk.obj").error.empty());
  CHECK_FALSE(read_broken(folder.write("junk.nff", junk), "junk.nff").error.empty());
  folder.write("junk.mtl", junk);
  CHECK_FALSE(
      read_broken(folder.write("junky.obj", "mtllib junk.mtl\n" + triangle + "f 1 2 3\n"), "junk.mtl").error.empty());
}

TEST_CASE("A file cut short anywhere, or with any byte changed, is read or refused") {
  const TemporaryFolder folder;
  const std::string nff =
      "b 0.1 0.2 0.3\nv\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 0.1\nresolution 64 32\nl 1 2 3\nf 1 1 1 1 0 "
      "1 0 1\n"
      "s 0 0 0 1\nc 0 0 0 1 0 0 2 1\np 5 0 0 0 4 0 0 4 4 0 2 1 0 0 4 0\npp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 2\n";
  const std::string obj =
      "mtllib m.mtl\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nvt 0.5 0.5\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3/1/1 "
      "4/1/1 5/1/1\nf -1 -2 -3\n";
  const std::string mtl =
      "newmtl a\nKd 0.5 0.5 0.5\nNs 10\nd 0.5\nillum 7\nTf 1 1 1\nmap_Kd -bm 0.5 x.png\nbump -bm 2 y.png\n";
  const auto try_text = [&](const std::string& name, const std::string& text, const std::string& scene) {
    if (scene.empty()) return read_broken(folder.write(name, text), name);
    folder.write(name, text);
    return read_broken(folder.write("host.obj", scene), name);
  };
  for (const auto& [name, text, scene] :
       {std::tuple{"t.nff", nff, std::string()}, {"t.obj", obj, std::string()}, {"m.mtl", mtl, obj}}) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      INFO(name << " cut at " << i);
      try_text(name, text.substr(0, i), scene);
    }
    for (std::uint64_t i = 0; i < 500; ++i) {
      Random random(7, name_hash(name), i);
      std::string changed = text;
      // Half of the changes are of the kind that still parses.
      const char* const likely = "0123456789 -./\n#efpslv";
      for (int n = 0; n < 3; ++n) {
        changed[random.below(static_cast<std::uint32_t>(text.size()))] =
            random.below(2) == 0 ? static_cast<char>(random.below(256)) : likely[random.below(22)];
      }
      INFO(name << " changed, " << i);
      try_text(name, changed, scene);
    }
  }
}

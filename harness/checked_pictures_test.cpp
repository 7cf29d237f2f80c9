// SPDX-License-Identifier: GPL-3.0-or-later
// `check` compares pictures of a user's own scene: a right tracer passes, a broken one fails, and what would take too
// long is skipped with its reason.
#include "harness/checked_pictures.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "scenes/test_files.h"

using namespace plumbline;

namespace {

/// A tetrahedron on a plate, as a modeller saves it: no camera, no light.
constexpr const char* kMesh =
    "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0.3 1 0.3\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n"
    "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 5 8 7 6\n";

CaseRecord checked(const CheckedPictures& settings, const std::string& scene = "scene of mine.obj") {
  const TemporaryFolder folder;
  const auto path = folder.write(scene, kMesh);
  const Case c = checked_picture_case({"mine", path.string()}, settings);
  Session session;
  CaseContext context{session, 5, folder.path()};
  CaseRecord record;
  record.name = c.name;
  c.run(context, c, record);
  for (const PictureRecord& picture : record.pictures) CHECK(std::filesystem::exists(folder.path() / picture.path));
  return record;
}

CheckedPictures small() {
  CheckedPictures settings;
  settings.width = 24, settings.height = 18;
  settings.frames = 64;
  return settings;
}

}  // namespace

TEST_CASE("A picture of one's own scene passes, and says how to ask again", "[checked]") {
  const CaseRecord record = checked(small());
  CHECK(record.status == CaseStatus::passed);
  for (const char* what : {".tested.", ".truth.", ".difference.", ".z.", ".histogram.", ".quantiles."})
    CHECK(std::count_if(record.pictures.begin(), record.pictures.end(), [&](const PictureRecord& picture) {
            return picture.path.find(what) != std::string::npos;
          }) == 1);
  CHECK_THAT(record.replay, Catch::Contains("--picture-size 24x18 --picture-frames 64"));
  RunRecord run;
  run.cases = {record};
  CHECK_THAT(pictures_text(run), Catch::Contains("drt.picture.mine: passed, no difference"));
}

TEST_CASE("A shader that is wrong fails the picture of one's own scene", "[checked]") {
  CheckedPictures settings;
  settings.frames = 256;
  settings.patches = {{"camera.frag.glsl", "(used.xy - 0.5)", "used.xy"}};  // half a pixel off
  const CaseRecord record = checked(settings);
  CHECK(record.status == CaseStatus::failed);
  RunRecord run;
  run.cases = {record};
  CHECK_THAT(pictures_text(run), Catch::Contains("drt.picture.mine: failed, "));
}

TEST_CASE("A picture that would take too long is skipped, and the reason told", "[checked]") {
  CheckedPictures settings = small();
  settings.frames = 0, settings.seconds = 1e-9;
  const CaseRecord record = checked(settings);
  CHECK(record.status == CaseStatus::skipped);
  CHECK_THAT(record.message, Catch::Contains("--picture-frames 64 asks for it all the same"));
}

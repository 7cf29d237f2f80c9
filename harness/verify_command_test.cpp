// SPDX-License-Identifier: GPL-3.0-or-later
// The command `verify` from end to end: sound and broken images, the JSON that it writes, files that are none.
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "harness/command_line.h"
#include "reports/files.h"
#include "tracer/broken_trees.h"

using namespace plumbline;

namespace {

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("plumbline_verify_test_" + std::to_string(::getpid()));
  Folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directory(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string file(const char* name) const { return (path / name).string(); }
};

int run(std::vector<std::string> words) {
  words.insert(words.begin(), "plumbline");
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  return run_command_line(static_cast<int>(argv.size()), argv.data());
}

nlohmann::json valid(const std::string& file) {
  const nlohmann::json json = nlohmann::json::parse(read_text(file)),
                       schema_text = nlohmann::json::parse(read_text("reports/certificate.schema.json"));
  valijson::Schema schema;
  valijson::SchemaParser parser;
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_text), schema);
  valijson::Validator validator;
  CHECK(validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(json), nullptr));
  return json;
}

}  // namespace

TEST_CASE("verify passes a sound scene, and a file with or without its scene") {
  const Folder folder;
  CHECK(run({"verify", "sphereflake:2", "--json", folder.file("c.json")}) == 0);
  const nlohmann::json json = valid(folder.file("c.json"));
  CHECK(json["sound"] == true);
  for (const auto& rule : json["rules"]) CHECK(rule["judged"] == true);
  CHECK(run({"bake", "sphereflake:2", "-o", folder.file("t.exr"), "--layout", "paper", "--links", "threaded"}) == 0);
  CHECK(run({"verify", folder.file("t.exr")}) == 0);
  CHECK(run({"verify", folder.file("t.exr"), "--scene", "sphereflake:2"}) == 0);
}

TEST_CASE("verify names the cell of a broken image, and what belongs to another scene") {
  const Folder folder;
  std::size_t tried = 0;
  for (const char* name : {"sphere_too_small.leaf", "link.swapped", "transform.way_out_place"}) {
    for (const TreeFault& fault : tree_faults()) {
      if (fault.name != name || fault.finder != TreeFault::Finder::image) continue;
      const BrokenTree tree = break_tree(fault, 5);
      ++tried;
      write_geometry_image(tree.broken, folder.file("t.exr"));
      CHECK(run({"verify", folder.file("t.exr"), "--json", folder.file("c.json")}) == 1);
      const nlohmann::json json = valid(folder.file("c.json"));
      INFO(name);
      CHECK(std::any_of(json["findings"].begin(), json["findings"].end(), [&](const nlohmann::json& f) {
        return f["rule"] == std::string(fault.rule) && f.value("x", -1) == tree.x && f.value("y", -1) == tree.y;
      }));
    }
  }
  CHECK(tried == 3);
  CHECK(run({"bake", "sphereflake:2", "-o", folder.file("t.exr")}) == 0);
  CHECK(run({"verify", folder.file("t.exr"), "--scene", "creature"}) == 1);
}

TEST_CASE("verify refuses what is no geometry image") {
  const Folder folder;
  CHECK(run({"verify", folder.file("none.exr")}) == 2);
  std::ofstream(folder.file("empty.exr"));
  CHECK(run({"verify", folder.file("empty.exr")}) == 2);
  std::ofstream(folder.file("text.exr")) << "this is no image";
  CHECK(run({"verify", folder.file("text.exr")}) == 2);
  CHECK(run({"bake", "sphereflake:2", "-o", folder.file("t.exr")}) == 0);
  std::filesystem::resize_file(folder.file("t.exr"), std::filesystem::file_size(folder.file("t.exr")) / 2);
  CHECK(run({"verify", folder.file("t.exr")}) == 2);
  CHECK(run({"verify", "sphereflake:2", "--scene", "creature"}) == 2);
}

// SPDX-License-Identifier: MIT
// The XML is read back by a parser that is not ours, also where names hold what XML forbids.
#include "reports/junit.h"

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <catch2/catch.hpp>
#include <sstream>

#include "reports/example_run.h"
#include "reports/files.h"
#include "reports/format.h"
#include "reports/summary.h"

namespace plumbline {
namespace {

using Tree = boost::property_tree::ptree;

Tree parsed(const std::string& xml) {
  std::istringstream in(xml);
  Tree tree;
  boost::property_tree::read_xml(in, tree);
  return tree;
}

double number(const Tree& tree, const char* path) { return std::stod(tree.get<std::string>(path)); }

}  // namespace

TEST_CASE("junit: a suite per feature, counts that add up") {
  const RunRecord run = example_run();
  const Tree tree = parsed(junit_xml(run));
  const Tree& all = tree.get_child("testsuites");
  CHECK(number(all, "<xmlattr>.tests") == 25);
  CHECK(number(all, "<xmlattr>.failures") == 2);
  CHECK(number(all, "<xmlattr>.errors") == 1);
  CHECK(number(all, "<xmlattr>.skipped") == 1);
  std::vector<std::string> suites;
  int cases = 0, failures = 0, errors = 0, skipped = 0, attachments = 0;
  for (const auto& [tag, suite] : all) {
    if (tag != "testsuite") continue;
    suites.push_back(suite.get<std::string>("<xmlattr>.name"));
    CHECK(suite.get<std::string>("<xmlattr>.timestamp") == "2026-11-22T03:00:00");
    CHECK(suite.get_child("properties").front().second.get<std::string>("<xmlattr>.value") == "0.1.0");
    for (const auto& [inner, test] : suite) {
      if (inner != "testcase") continue;
      ++cases;
      failures += static_cast<int>(test.count("failure"));
      errors += static_cast<int>(test.count("error"));
      skipped += static_cast<int>(test.count("skipped"));
      CHECK(number(test, "<xmlattr>.time") >= 0.0);
      attachments += test.get<std::string>("system-out").find("[[ATTACHMENT|") != std::string::npos;
      if (test.get<std::string>("<xmlattr>.name") != "hits.random_chords.balls_4") continue;
      CHECK(test.get<std::string>("failure.<xmlattr>.type") == "tracer_wrong");
      CHECK_THAT(test.get<std::string>("failure.<xmlattr>.message"), Catch::StartsWith("3 rays are tracer_wrong"));
      CHECK_THAT(test.get<std::string>("failure"),
                 Catch::Contains("replay: plumbline run hits.random_chords.balls_4 --seed"));
    }
  }
  CHECK(suites == std::vector<std::string>{"driver", "bench", "hits"});
  CHECK(cases == 25);
  CHECK(failures == 2);
  CHECK(errors == 1);
  CHECK(skipped == 1);
  CHECK(attachments == 0);
}

TEST_CASE("junit: a case whose rays lack a verdict is a failure") {
  RunRecord run = example_run({.failing = false});
  CHECK(number(parsed(junit_xml(run)), "testsuites.<xmlattr>.failures") == 0);
  run.cases.back().rays += 1;
  CHECK(number(parsed(junit_xml(run)), "testsuites.<xmlattr>.failures") == 1);
}

TEST_CASE("junit: what XML forbids does not get out") {
  RunRecord run = example_run();
  CaseRecord& record = run.cases.back();
  for (std::string* text :
       {&run.command, &run.driver_renderer, &record.name, &record.feature, &record.message, &record.replay})
    *text = kNastyText;
  record.status = CaseStatus::failed;
  const std::string xml = junit_xml(run);
  for (const char c : xml) {
    const auto byte = static_cast<unsigned char>(c);
    REQUIRE((byte >= 0x20 || byte == '\n' || byte == '\t'));
  }
  CHECK(valid_utf8(xml) == xml);
  CHECK(xml.find("<b a=") == std::string::npos);
  const Tree tree = parsed(xml);
  bool found = false;
  for (const auto& [tag, suite] : tree.get_child("testsuites"))
    if (tag == "testsuite" && suite.get<std::string>("<xmlattr>.name").find("</script><b a=\"1\" c='2'>&amp;") == 0)
      found = true;
  CHECK(found);
}

TEST_CASE("junit: pictures are named from the working directory, or from the root") {
  TemporaryFolder folder;
  RunRecord run = example_run({.families = 1, .scenes = 1});
  run.cases.back().pictures = {{"pictures/a.png", "A", "", 1, 1, {}, {}, "", ""}};
  write_junit(run, folder.path / "junit.xml");
  CHECK_THAT(read_text(folder.path / "junit.xml"),
             Catch::Contains("[[ATTACHMENT|" + (folder.path / "pictures/a.png").string() + "]]"));
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path);
  write_junit(run, "out/./junit.xml");
  write_junit(run, folder.path / "junit.xml");
  std::filesystem::current_path(before);
  CHECK_THAT(read_text(folder.path / "out" / "junit.xml"), Catch::Contains("[[ATTACHMENT|out/pictures/a.png]]"));
  CHECK_THAT(read_text(folder.path / "junit.xml"), Catch::Contains("[[ATTACHMENT|pictures/a.png]]"));
}

}  // namespace plumbline

// SPDX-License-Identifier: MIT
// A killed run keeps its finished cases and goes on from there.
#include "reports/journal.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "reports/example_run.h"
#include "reports/files.h"
#include "reports/json.h"
#include "scenes/error.h"

namespace plumbline {

TEST_CASE("journal: cases can be read while the run goes on") {
  TemporaryFolder folder;
  const RunRecord run = example_run();
  Journal journal = Journal::begin(folder.path / "new", run);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(read_journal(folder.path / "new").cases.size() == i);
    journal.append(run.cases[i]);
  }
  const RunRecord back = read_journal(folder.path / "new");
  CHECK(back.seed == run.seed);
  CHECK(back.findings.size() == run.findings.size());
  CHECK(back.planned_cases == run.planned_cases);
  CHECK(case_to_json(back.cases[2]) == case_to_json(run.cases[2]));
}

TEST_CASE("journal: a torn last line is passed over, and cut off before going on") {
  TemporaryFolder folder;
  const RunRecord run = example_run();
  {
    Journal journal = Journal::begin(folder.path, run);
    for (std::size_t i = 0; i < 4; ++i) journal.append(run.cases[i]);
  }
  const auto file = folder.path / kJournalName;
  const std::string whole = read_text(file);
  const std::size_t last_line = whole.rfind('\n', whole.size() - 2) + 1;
  for (const std::size_t length : {last_line + 1, last_line + 40, whole.size() - 1}) {
    write_text(file, whole.substr(0, length));
    CHECK(read_journal(folder.path).cases.size() == 3);
    RunRecord resumed;
    {
      Journal journal = Journal::resume(folder.path, resumed);
      CHECK(resumed.cases.size() == 3);
      journal.append(run.cases[3]);
    }
    CHECK(read_text(file) == whole);
  }
}

TEST_CASE("journal: a case written twice counts as written last, a new run begins anew") {
  TemporaryFolder folder;
  RunRecord run = example_run();
  {
    Journal journal = Journal::begin(folder.path, run);
    journal.append(run.cases[0]);
    journal.append(run.cases[1]);
    run.cases[0].message = "again";
    journal.append(run.cases[0]);
  }
  const RunRecord back = read_journal(folder.path);
  REQUIRE(back.cases.size() == 2);
  CHECK(back.cases[0].message == "again");
  Journal::begin(folder.path, run);
  CHECK(read_journal(folder.path).cases.empty());
}

TEST_CASE("journal: two runs cannot write into one folder") {
  TemporaryFolder folder;
  const Journal journal = Journal::begin(folder.path, example_run());
  CHECK_THROWS_AS(Journal::begin(folder.path, example_run()), InputError);
  RunRecord run;
  CHECK_THROWS_AS(Journal::resume(folder.path, run), InputError);
}

TEST_CASE("journal: what is not a journal is refused, with file and line") {
  TemporaryFolder folder;
  RunRecord run;
  CHECK_THROWS_AS(Journal::resume(folder.path, run), InputError);
  CHECK_FALSE(std::filesystem::exists(folder.path / kJournalName));
  CHECK_THROWS_AS(read_journal(folder.path), InputError);
  const auto refused = [&](const std::string& text, const std::string& place) {
    write_text(folder.path / kJournalName, text);
    CHECK_THROWS_WITH(read_journal(folder.path), Catch::Contains(place));
    CHECK_THROWS_AS(Journal::resume(folder.path, run), InputError);
    CHECK(read_text(folder.path / kJournalName) == text);  // what is refused is not touched
  };
  const std::string header = run_header_to_json(example_run()), record = case_to_json(example_run().cases[0]);
  refused("", "cases.jsonl:1");
  refused(header, "cases.jsonl:1");  // torn before it was whole
  refused("hello\n", "cases.jsonl:1");
  refused(run_to_json(example_run()), "cases.jsonl:1");
  refused(header + "\n" + record + "\n" + record.substr(0, 60) + "\n" + record + "\n", "cases.jsonl:3");
  refused(header + "\n{}\n", "cases.jsonl:2");
}

TEST_CASE("journal: a full disk is said") {
  if (!std::filesystem::exists("/dev/full")) {
    WARN("no /dev/full on this machine");
    return;
  }
  TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/full", folder.path / kJournalName);
  CHECK_THROWS_AS(Journal::begin(folder.path, example_run()), EnvironmentError);
}

}  // namespace plumbline

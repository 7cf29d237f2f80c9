// SPDX-License-Identifier: MIT
// See journal.h.
#include "reports/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "reports/files.h"
#include "reports/json.h"
#include "scenes/error.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const char* what) {
  throw EnvironmentError(file.string() + ": " + what + ": " + std::strerror(errno));
}

RunRecord parse_journal(std::string_view text, const std::string& file) {
  RunRecord run;
  std::unordered_map<std::string, std::size_t> position;
  std::size_t line_number = 0;
  for (std::size_t start = 0, end; (end = text.find('\n', start)) != std::string_view::npos; start = end + 1) {
    const std::string_view line = text.substr(start, end - start);
    if (++line_number == 1) {
      run = run_header_from_json(line, file, line_number);
      continue;
    }
    CaseRecord record = case_from_json(line, file, line_number);
    const auto [found, is_new] = position.emplace(record.name, run.cases.size());
    if (is_new)
      run.cases.push_back(std::move(record));
    else
      run.cases[found->second] = std::move(record);
  }
  if (line_number == 0) throw InputError(file, 1, "the journal is empty: nothing to resume; run without --resume");
  return run;
}

}  // namespace

Journal::Journal(const fs::path& file) : file_(file) {
  make_folder(file.parent_path());
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) refuse(file_, "cannot open the journal");
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const bool taken = errno == EWOULDBLOCK;
    ::close(std::exchange(descriptor_, -1));
    if (taken)
      throw InputError(file.string() + ": another run is writing into this folder; give another one with --out");
    refuse(file_, "cannot lock the journal");
  }
}

Journal::Journal(Journal&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

Journal& Journal::operator=(Journal&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

Journal::~Journal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Journal Journal::begin(const fs::path& folder, const RunRecord& header) {
  Journal journal(folder / kJournalName);
  if (::ftruncate(journal.descriptor_, 0) != 0) refuse(journal.file_, "cannot empty the journal");
  journal.write_line(run_header_to_json(header));
  return journal;
}

Journal Journal::resume(const fs::path& folder, RunRecord& run) {
  const fs::path file = folder / kJournalName;
  read_text(file);  // where there is none, resuming must not make one
  Journal journal(file);
  const std::string text = read_text(file);
  run = parse_journal(text, file.string());
  const auto whole_lines = static_cast<off_t>(text.rfind('\n') + 1);
  if (::ftruncate(journal.descriptor_, whole_lines) != 0) refuse(file, "cannot cut the torn last line off the journal");
  return journal;
}

void Journal::append(const CaseRecord& record) { write_line(case_to_json(record)); }

void Journal::write_line(std::string line) {
  line += '\n';
  std::string_view rest = line;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) refuse(file_, "cannot write to the journal");
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
}

bool has_journal(const fs::path& folder) {
  std::error_code error;
  const fs::path file = folder / kJournalName;
  return fs::exists(file, error) && read_text(file).find('\n') != std::string::npos;
}

RunRecord read_journal(const fs::path& folder) {
  const fs::path file = folder / kJournalName;
  return parse_journal(read_text(file), file.string());
}

}  // namespace plumbline

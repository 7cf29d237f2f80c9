// SPDX-License-Identifier: MIT
// The run as JUnit XML, in the dialect that GitLab and Jenkins both read: a test suite per feature, a test case per
// case.
#pragma once

#include <filesystem>
#include <string>

#include "reports/record.h"

namespace plumbline {

/// A failed case carries `failure`, one that ended in an error `error`; each names the message, the counts and the
/// replay command. A case whose rays did not all get a verdict is a failure whatever its status says. GitLab and Jenkins
/// take pictures by marks in system-out, GitLab the first of a case: `folder` is put before their paths, as GitLab
/// looks for them from the root of the checkout.
std::string junit_xml(const RunRecord& run, const std::filesystem::path& folder = {});

/// Writes through a temporary file, pictures named from the working directory where the file lies below it, else from
/// the root. Throws EnvironmentError.
void write_junit(const RunRecord& run, const std::filesystem::path& file);

}  // namespace plumbline

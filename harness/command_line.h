// SPDX-License-Identifier: GPL-3.0-or-later
// The command line: subcommands, options, exit statuses.
#pragma once

namespace plumbline {

/// 0 all passed, 1 a case failed, 2 usage or input, 3 environment.
int run_command_line(int argc, char** argv);

}  // namespace plumbline

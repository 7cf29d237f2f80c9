// SPDX-License-Identifier: GPL-3.0-or-later
// The program: everything is in command_line.cpp.
#include "harness/command_line.h"

int main(int argc, char** argv) { return plumbline::run_command_line(argc, argv); }

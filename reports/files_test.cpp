// SPDX-License-Identifier: MIT
// What is written replaces plain files alone: links, pipes and descriptors stay what they are.
#include "reports/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>

#include "reports/example_run.h"
#include "scenes/error.h"
#include "scenes/image_file.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// What lies in a pipe, at most 64 bytes.
std::string from_pipe(int descriptor) {
  std::array<char, 64> bytes{};
  const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
  return std::string(bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
}

}  // namespace

TEST_CASE("files: a symbolic link stays one, what it names is replaced as a whole") {
  TemporaryFolder folder;
  fs::create_directory(folder.path / "deep");
  write_text(folder.path / "deep" / "file.txt", "old");
  fs::create_symlink("deep/file.txt", folder.path / "one");
  fs::create_symlink("one", folder.path / "two");
  write_text(folder.path / "two", "new");
  CHECK(fs::is_symlink(folder.path / "two"));
  CHECK(fs::is_symlink(folder.path / "one"));
  CHECK(read_text(folder.path / "deep" / "file.txt") == "new");
  CHECK(files_in(folder.path / "deep") == 1);
  fs::create_symlink("deep/made.txt", folder.path / "dangling");
  write_text(folder.path / "dangling", "made");
  CHECK(read_text(folder.path / "deep" / "made.txt") == "made");

  const std::array<std::uint8_t, 3> red = {255, 0, 0};
  write_png(folder.path / "deep" / "a.png", 1, 1, red);
  fs::create_symlink("deep/a.png", folder.path / "b.png");
  write_png(folder.path / "b.png", 1, 1, red);
  CHECK(fs::is_symlink(folder.path / "b.png"));

  fs::create_symlink("circle", folder.path / "circle");
  CHECK_THROWS_AS(write_text(folder.path / "circle", "x"), InputError);
  CHECK_THROWS_AS(write_text(folder.path / "deep", "x"), InputError);
}

TEST_CASE("files: a pipe is written in place and stays a pipe, images refuse it") {
  TemporaryFolder folder;
  const fs::path pipe = folder.path / "pipe.png";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  REQUIRE(reader >= 0);
  write_text(pipe, "through");
  CHECK(from_pipe(reader) == "through");
  CHECK(fs::is_fifo(pipe));
  CHECK(files_in(folder.path) == 1);
  const std::array<std::uint8_t, 3> red = {255, 0, 0};
  CHECK_THROWS_AS(write_png(pipe, 1, 1, red), InputError);
  CHECK(fs::is_fifo(pipe));
  ::close(reader);
}

TEST_CASE("files: a path that names an open descriptor writes to it where it stands") {
  TemporaryFolder folder;
  const fs::path file = folder.path / "log";
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT, 0600);
  REQUIRE(descriptor >= 0);
  REQUIRE(::write(descriptor, "before ", 7) == 7);
  fs::create_symlink("/proc/self/fd/" + std::to_string(descriptor), folder.path / "stdout");
  write_text(folder.path / "stdout", "within ");
  REQUIRE(::write(descriptor, "after", 5) == 5);
  CHECK(read_text(file) == "before within after");
  CHECK(fs::is_symlink(folder.path / "stdout"));
  ::close(descriptor);
}

TEST_CASE("files: a write that fails is said") {
  TemporaryFolder folder;
  // A descriptor that cannot be written; the pipe's full disk, without a device.
  const fs::path file = folder.path / "read_only";
  write_text(file, "kept");
  const int descriptor = ::open(file.c_str(), O_RDONLY);
  CHECK_THROWS_AS(write_text("/proc/self/fd/" + std::to_string(descriptor), "x"), EnvironmentError);
  ::close(descriptor);
  CHECK(read_text(file) == "kept");
  CHECK_THROWS_AS(write_text(file / "inside", "x"), EnvironmentError);
  if (const int full = ::open("/dev/full", O_WRONLY); full >= 0) {
    CHECK_THROWS_WITH(write_text("/proc/self/fd/" + std::to_string(full), "x"), Catch::Contains("No space left"));
    ::close(full);
  }
}

}  // namespace plumbline

#include "libvpm/file/stream.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <thread>

#include "libvpm/core/error.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm::file {
namespace {

using test::kind_of_fault;
using test::text_of;

namespace fs = std::filesystem;
using Stream = test::InTemporaryFolder;
using Names = std::vector<std::string>;

constexpr std::size_t kLimit = 1 << 16;  // bytes, in children that must fail

// Runs `action` in a child process whose files may not grow beyond kLimit, with `handler` for the
// signal of that limit. Returns the child's exit status.
int in_limited_child(void (*handler)(int), const std::function<int()>& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit limit{kLimit, kLimit};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, handler);
    ::_exit(action());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(Stream, FilesComeBackAsWritten) {
  const std::string text("line\r\n\0\xff", 8);
  write_all(path("file"), text);
  EXPECT_EQ(text_of(path("file")), text);
  write_all(path("file"), std::string_view("shorter"));
  EXPECT_EQ(text_of(path("file")), "shorter");
  write_all(path("file"), std::string_view());
  EXPECT_EQ(text_of(path("file")), "");
  EXPECT_EQ(names(), Names{"file"});
}

TEST_F(Stream, TheUmaskSaysWhoMayRead) {
  const mode_t before = ::umask(027);
  write_all(path("file"), std::string_view("x"));
  ::umask(before);
  struct stat status {};
  ASSERT_EQ(::stat(path("file").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640U);
}

TEST_F(Stream, WhoMayReadAFileStaysAsItWas) {
  write_all(path("file"), std::string_view("old"));
  fs::permissions(path("file"), fs::perms::owner_read | fs::perms::owner_write);
  write_all(path("file"), std::string_view("new"));
  EXPECT_EQ(text_of(path("file")), "new");
  EXPECT_EQ(fs::status(path("file")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Stream, ALinkStaysALink) {
  write_all(path("target"), std::string_view("old"));
  fs::create_symlink("target", path("link"));
  fs::create_symlink("later", path("dangling"));
  write_all(path("link"), std::string_view("new"));
  write_all(path("dangling"), std::string_view("made"));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(text_of(path("target")), "new");
  EXPECT_EQ(text_of(path("later")), "made");
}

TEST_F(Stream, APipeIsWrittenStraight) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = text_of(path("pipe")); });
  const std::string text(200000, 'x');  // more than a pipe holds at once
  write_all(path("pipe"), text);
  reader.join();
  EXPECT_EQ(read, text);
  EXPECT_EQ(names(), Names{"pipe"});
}

TEST_F(Stream, PartsAppearAsOneFile) {
  write_all(path("file"), std::string_view("old"));
  std::string all;
  Output output(path("file"));
  for (int k = 0; k < 3000; ++k) {  // more parts than wait at once
    const std::string part(static_cast<std::size_t>(k % 100), static_cast<char>('a' + k % 26));
    output.append(part);
    all += part;
  }
  const std::string large(200000, 'x');
  output.append(large);
  output.append("end");
  EXPECT_EQ(text_of(path("file")), "old");
  output.finish();
  EXPECT_EQ(text_of(path("file")), all + large + "end");
  EXPECT_EQ(names(), Names{"file"});
}

TEST_F(Stream, WhatIsNotFinishedLeavesTheOldFile) {
  write_all(path("file"), std::string_view("old"));
  {
    Output output(path("file")), other(path("other"));
    output.append(std::string(200000, 'x'));
    other.append("y");
  }
  EXPECT_EQ(text_of(path("file")), "old");
  EXPECT_EQ(names(), Names{"file"});
}

TEST_F(Stream, AnInterruptedRunLeavesNoneOfItsOutputs) {
  const pid_t child = ::fork();
  if (child == 0) {
    Output first(path("first")), second(path("second"));
    write_all(path("third"), std::string_view("done"));
    remove_unfinished_output();
    ::_exit(names() == Names{"third"} ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(names(), Names{"third"});
}

// A reader of the pipe sees each part before the next is written.
TEST_F(Stream, APipeHasEachPartAtOnce) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  Output output(path("pipe"));
  for (const std::string_view part : {"first\n", "second\n"}) {
    output.append(part);
    char read[16] = {};
    EXPECT_EQ(::read(reader, read, sizeof read), static_cast<ssize_t>(part.size()));
    EXPECT_EQ(read, part);
  }
  output.finish();
  ::close(reader);
}

TEST_F(Stream, AFullDiskLeavesTheOldFile) {
  write_all(path("file"), std::string_view("old"));
  const int status = in_limited_child(SIG_IGN, [&] {
    try {
      write_all(path("file"), std::string(2 * kLimit, 'x'));
    } catch (const Error& fault) {
      return fault.kind() == ErrorKind::cannot_write ? 4 : 1;
    }
    return 0;
  });
  EXPECT_EQ(status, 4);
  EXPECT_EQ(text_of(path("file")), "old");
  EXPECT_EQ(names(), Names{"file"});
}

// Sends the signal in the middle of the write, as ctrl-C would.
TEST_F(Stream, AnInterruptedRunLeavesTheOldFile) {
  write_all(path("file"), std::string_view("old"));
  const auto clean_up = [](int) {
    remove_unfinished_output();
    ::_exit(99);
  };
  const int status = in_limited_child(clean_up, [&] {
    write_all(path("file"), std::string(2 * kLimit, 'x'));
    return 0;
  });
  EXPECT_EQ(status, 99);
  EXPECT_EQ(text_of(path("file")), "old");
  EXPECT_EQ(names(), Names{"file"});
}

TEST_F(Stream, AClosedPipeIsAFailedWrite) {
  std::signal(SIGPIPE, SIG_IGN);
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  EXPECT_EQ(kind_of_fault(
                [&] { write_all("/dev/fd/" + std::to_string(ends[1]), std::string_view("x")); }),
            ErrorKind::cannot_write);
  ::close(ends[1]);
}

TEST_F(Stream, WhatCannotBeWrittenIsSaid) {
  const std::string_view text = "x";
  EXPECT_EQ(kind_of_fault([&] { write_all(path("missing/file"), text); }), ErrorKind::cannot_write);
  EXPECT_EQ(kind_of_fault([&] { write_all(path("."), text); }), ErrorKind::cannot_write);
  EXPECT_EQ(kind_of_fault([&] { write_all("", text); }), ErrorKind::cannot_write);
  EXPECT_EQ(kind_of_fault([&] { write_all("/dev/full", text); }), ErrorKind::cannot_write);
  EXPECT_EQ(kind_of_fault([&] { write_all(path(std::string(300, 'x')), text); }),
            ErrorKind::cannot_write);
}

TEST_F(Stream, WhatCannotBeReadIsSaid) {
  EXPECT_EQ(kind_of_fault([&] { read_all(path("missing")); }), ErrorKind::refused);
  EXPECT_EQ(kind_of_fault([&] { read_all(path(".")); }), ErrorKind::refused);
}

TEST_F(Stream, AnEndlessInputIsReadToItsLimit) {
  constexpr std::size_t kMost = 100'000;
  const std::optional<Error> fault = test::fault_of([&] { read_all("/dev/zero", kMost); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->kind(), ErrorKind::refused);
  EXPECT_NE(std::string(fault->what()).find("100000 bytes"), std::string::npos) << fault->what();
}

TEST_F(Stream, APipeMayBeAsLongAsTheLimitAndAFileLonger) {
  constexpr std::size_t kMost = 1000;
  write_all(path("file"), std::string(kMost + 1, 'x'));
  EXPECT_EQ(read_all(path("file"), kMost).size(), kMost + 1);
  for (const std::size_t size : {kMost, kMost + 1}) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    write_all("/dev/fd/" + std::to_string(ends[1]), std::string(size, 'x'));
    ::close(ends[1]);
    const std::string from = "/dev/fd/" + std::to_string(ends[0]);
    EXPECT_EQ(test::kind_of_fault([&] { read_all(from, kMost); }).has_value(), size > kMost);
    ::close(ends[0]);
  }
}

TEST_F(Stream, ThreadsMayWriteAtOnce) {
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k) {
    threads.emplace_back(
        [this, k] { write_all(path("same"), std::string(10000, static_cast<char>('a' + k))); });
  }
  for (std::thread& thread : threads) thread.join();
  const std::string text = text_of(path("same"));
  EXPECT_EQ(text, std::string(10000, text.at(0)));
  EXPECT_EQ(names(), Names{"same"});
}

}  // namespace
}  // namespace vpm::file

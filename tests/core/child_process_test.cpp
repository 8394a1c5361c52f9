#include "haptolith/core/platform/child_process.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include "haptolith/core/error.h"
#include "haptolith/core/stop_asked.h"

namespace haptolith {
namespace {

using namespace std::chrono_literals;

const std::function<bool()> kNever;

ChildProcess::Command shell(const std::string& script) {
  return {.arguments = {"sh", "-c", script}, .package = "dash", .environment = {"GREETING=hello"}, .most_cpu = 300s};
}

TEST(ChildProcess, ReadsAndWritesWhatItIsGivenAndKnowsWhatItIsTold) {
  Pipe to;
  Pipe from;
  ChildProcess child(shell("read line <&5; echo \"$GREETING $line\" >&6; ls /proc/self/fd | wc -l >&6"),
                     {{to.to_read, 5}, {from.to_write, 6}});
  to.to_read.close();
  from.to_write.close();
  ASSERT_TRUE(writeAll(to.to_write, "world\n", {.stopped = kNever}));
  std::string answer;
  while (readSome(from.to_read, answer, {.stopped = kNever})) {
  }
  EXPECT_THAT(answer, testing::StartsWith("hello world\n"));
  EXPECT_TRUE(child.wait());
}

TEST(ChildProcess, FindsEachVariableOnceAndAsItWasGiven) {
  setenv("GREETING", "good morning", 1);
  const Descriptor words = temporaryFile();
  ChildProcess child(shell("tr '\\0' '\\n' < /proc/$$/environ | grep ^GREETING="), {{words, STDOUT_FILENO}});
  EXPECT_TRUE(child.wait());
  unsetenv("GREETING");
  EXPECT_EQ(contentOf(words), "GREETING=hello\n");
}

TEST(ChildProcess, ItsFailureIsSeenAndItsWordsAreKept) {
  const Descriptor words = temporaryFile();
  ChildProcess child(shell("echo no >&2; exit 3"), {{words, STDERR_FILENO}});
  EXPECT_FALSE(child.wait());
  EXPECT_EQ(contentOf(words), "no\n");
}

TEST(ChildProcess, IsKilledWithAllItHasStarted) {
  Pipe from;
  {
    ChildProcess child(shell("sleep 100 & echo >&6; sleep 100"), {{from.to_write, 6}});
    from.to_write.close();
    std::string started;
    ASSERT_TRUE(readSome(from.to_read, started, {.stopped = kNever}));
    EXPECT_FALSE(child.endsWithin(1ms));
  }
  std::string rest;
  EXPECT_FALSE(readSome(from.to_read, rest, {.until = std::chrono::steady_clock::now() + 10s, .stopped = kNever}))
      << "nobody holds the other end any more";
}

TEST(ChildProcess, EndsWithUsHoweverWeEnd) {
  Pipe from;
  const pid_t parent = fork();
  if (parent == 0) {  // another one of us, to be killed
    const ChildProcess child(shell("echo >&6; while :; do :; done"), {{from.to_write, 6}});
    from.to_write.close();
    pause();
    _exit(0);
  }
  from.to_write.close();
  std::string started;
  const Deadline deadline{.until = std::chrono::steady_clock::now() + 60s, .stopped = kNever};
  ASSERT_TRUE(readSome(from.to_read, started, deadline));
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  std::string rest;
  EXPECT_FALSE(readSome(from.to_read, rest, deadline)) << "nobody holds the other end any more";
}

TEST(ChildProcess, TakesNoMoreOfAProcessorThanItMay) {
  ChildProcess::Command command = shell("while :; do :; done");
  command.most_cpu = 1s;
  ChildProcess child(command, {});
  EXPECT_FALSE(child.wait());
}

TEST(ChildProcess, IsNotWaitedForWithoutEnd) {
  ChildProcess child(shell("sleep 100"), {});
  EXPECT_THROW(child.wait(1ms), Failure);
  const std::jthread stops([] {
    std::this_thread::sleep_for(200ms);
    stopAsked() = true;
  });
  EXPECT_THROW(child.wait(), Failure);
  stopAsked() = false;
}

TEST(ChildProcess, IsWaitedForByWorkThatWasStoppedBefore) {
  stopAsked() = true;
  ChildProcess child(shell("sleep 0.3"), {});
  EXPECT_TRUE(child.wait()) << "the figure of what was done before Ctrl-C";
  stopAsked() = false;
}

TEST(ChildProcess, SeesNoDescriptorThatItIsNotGiven) {
  const int ours = open("/dev/null", O_RDONLY);  // not closed by exec
  const Descriptor words = temporaryFile();
  ChildProcess child(shell("ls /proc/self/fd | tr '\\n' ' '"), {{words, STDOUT_FILENO}});
  EXPECT_TRUE(child.wait());
  close(ours);
  EXPECT_EQ(contentOf(words), "0 1 2 3 ") << "3 is that of the listing itself";
}

TEST(ChildProcess, OneThatIsNotInstalledIsToldWithItsPackage) {
  try {
    const ChildProcess child(
        {.arguments = {"no-such-program"}, .package = "its-package", .environment = {}, .most_cpu = 300s}, {});
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(), "no-such-program is not installed: apt install its-package");
  }
}

TEST(Pipes, WaitNoLongerThanTheyAreTold) {
  const Pipe pipe;
  std::string nothing;
  EXPECT_THROW((void)readSome(pipe.to_read, nothing, {.until = {}, .stopped = kNever}), Failure);
  EXPECT_THROW((void)readSome(pipe.to_read, nothing, {.stopped = [] { return true; }}), Failure);
  const std::string more_than_fits(1 << 20, 'x');
  EXPECT_THROW((void)writeAll(pipe.to_write, more_than_fits, {.stopped = [] { return true; }}), Failure);
}

TEST(Pipes, TellWhenNobodyReadsAnyMore) {
  std::signal(SIGPIPE, SIG_IGN);
  Pipe pipe;
  pipe.to_read.close();
  EXPECT_FALSE(writeAll(pipe.to_write, "anybody?", {.stopped = kNever}));
}

}  // namespace
}  // namespace haptolith

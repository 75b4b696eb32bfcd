#include "daemon/line_reader.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/support/hand_driven_loop.h"
#include "tests/unit/daemon/descriptor.h"

namespace gateway {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class LineReaderTest : public testing::Test {
 protected:
  LineReaderTest() : reader_(loop_.executor(), [this](std::string_view line) { lines_.emplace_back(line); }) {}
  ~LineReaderTest() override {
    reader_.stop();
    loop_.settle();
  }

  /// Reads from what stands for standard input just now.
  void start() {
    reader_.start();
    loop_.settle();
  }
  void type(std::string_view text) {
    ASSERT_EQ(::write(keyboard_.in.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
    loop_.settle();
  }

  support::HandDrivenLoop loop_;
  test::Pipe keyboard_ = test::make_pipe();
  std::vector<std::string> lines_;
  LineReader reader_;
};

TEST_F(LineReaderTest, HandsOnEachLineWhenItIsComplete) {
  const test::Redirected input(STDIN_FILENO, keyboard_.out);
  start();
  type("3 fau");
  EXPECT_THAT(lines_, IsEmpty());
  type("lt 4\n\n5 show\n9 re");
  EXPECT_THAT(lines_, ElementsAre("3 fault 4", "", "5 show"));
  type("boot\n");
  EXPECT_THAT(lines_, ElementsAre("3 fault 4", "", "5 show", "9 reboot"));
}

TEST_F(LineReaderTest, EndsWithItsInputWithoutTheLineThatIsNotComplete) {
  const test::Redirected input(STDIN_FILENO, keyboard_.out);
  start();
  type("list\nhel");
  keyboard_.in.close();
  loop_.settle();
  EXPECT_THAT(lines_, ElementsAre("list"));
  EXPECT_EQ(loop_.context().poll(), 0U) << "nothing is waited for any more";
}

TEST_F(LineReaderTest, TakesTheLongestLineAndEndsWithALongerOne) {
  const test::Redirected input(STDIN_FILENO, keyboard_.out);
  start();
  const std::string longest(LineReader::kLongestLine - 1, 'x');  // and its end
  type(longest + "\n");
  EXPECT_THAT(lines_, ElementsAre(longest));
  type(longest + "x\nlist\n");
  EXPECT_EQ(lines_.size(), 1U);
  type("list\n");
  EXPECT_EQ(lines_.size(), 1U);
}

TEST_F(LineReaderTest, HandsOnNothingAfterItWasStopped) {
  const test::Redirected input(STDIN_FILENO, keyboard_.out);
  start();
  type("list\n");
  ASSERT_THAT(lines_, ElementsAre("list"));
  reader_.stop();
  type("help\n");
  EXPECT_THAT(lines_, ElementsAre("list"));
}

TEST_F(LineReaderTest, LeavesStandardInputOpen) {
  const test::Redirected input(STDIN_FILENO, keyboard_.out);
  start();
  reader_.stop();
  loop_.settle();
  EXPECT_GE(::fcntl(STDIN_FILENO, F_GETFD), 0);
}

TEST_F(LineReaderTest, InputThatCannotBeWaitedForIsNoError) {
  const test::Redirected input(STDIN_FILENO, test::Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC)));
  start();
  EXPECT_THAT(lines_, IsEmpty());
}

}  // namespace
}  // namespace gateway

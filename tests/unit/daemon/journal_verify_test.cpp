// `journal verify` as a process: what it says and its exit code.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "bridges/journal/store.h"
#include "tests/unit/daemon/program.h"

namespace gateway {
namespace {

using test::Program;
using test::TemporaryFile;
using testing::HasSubstr;
using testing::Not;

class VerifyJournal : public testing::Test {
 protected:
  VerifyJournal() {
    std::string name = (std::filesystem::temp_directory_path() / "gateway-state.XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("no temporary directory");
    }
    state_ = name;
  }
  ~VerifyJournal() override {
    std::error_code ignored;
    std::filesystem::remove_all(state_, ignored);
  }

  [[nodiscard]] std::string site(const std::string& state) const {
    return "[gateway]\nstate_dir = \"" + state +
           "\"\n[[bus]]\nname = \"can0\"\n[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"veichi-ac310\"\n";
  }
  // What it says; its exit code in `code`.
  [[nodiscard]] std::string say(const std::string& state, int& code) const {
    const TemporaryFile file(site(state));
    Program program(
        {"journal", "verify", "--config", file.path(), "--profile-dir", GATEWAY_SOURCE_DIR "/config/profiles"});
    code = program.exit_code();
    return program.output();
  }
  void write_lines(int count) const {
    journal::Store store(state_ / "journal", 1'000'000, journal::FileCalls::real());
    for (int i = 0; i < count; ++i) {
      const auto wall = std::chrono::sys_days(std::chrono::year(2026) / 1 / 2) + std::chrono::hours(i);
      ASSERT_FALSE(store.append({wall, canopen::TimePoint(), "\"phase\":\"done\""}));
    }
  }
  [[nodiscard]] std::filesystem::path file() const { return state_ / "journal" / "2026-01-02.jsonl"; }

  std::filesystem::path state_;
  int code_ = -1;
};

TEST_F(VerifyJournal, OfOneThatIsWholeIsDone) {
  write_lines(3);
  const std::string said = say(state_, code_);
  EXPECT_EQ(code_, 0) << said;
  EXPECT_THAT(said, HasSubstr("ok: 3 lines of 1 file, 2026-01-02T00:00:00.000Z to 2026-01-02T02:00:00.000Z\n"));
  EXPECT_THAT(said, HasSubstr("newest: line 3, SHA-256 "));
}

TEST_F(VerifyJournal, OfOneWithATornLastLineIsDoneAndSaysSo) {
  write_lines(2);
  std::ofstream(file(), std::ios::app) << "{\"n\":3,";
  const std::string said = say(state_, code_);
  EXPECT_EQ(code_, 0) << said;
  EXPECT_THAT(said, HasSubstr(file().string() + ":3: torn: "));
}

TEST_F(VerifyJournal, OfOneThatWasChangedFailsAndNamesTheLine) {
  write_lines(3);
  std::fstream stream(file(), std::ios::in | std::ios::out);
  stream.seekp(30);
  stream << 'x';
  stream.close();
  const std::string said = say(state_, code_);
  EXPECT_EQ(code_, 1) << said;
  EXPECT_THAT(said, HasSubstr(file().string() + ":1: changed: "));
  EXPECT_THAT(said, Not(HasSubstr("ok: ")));
}

TEST_F(VerifyJournal, OfNoneFails) {
  const std::string said = say(state_, code_);
  EXPECT_EQ(code_, 1) << said;
  EXPECT_THAT(said, HasSubstr("journal: No such file or directory"));
}

}  // namespace
}  // namespace gateway

// Every case of this folder through the real command `check`; README.md says what a case is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/commands.h"
#include "tests/unit/daemon/program.h"

namespace gateway {
namespace {

namespace fs = std::filesystem;

/// So many there are at least; fewer mean that the folder was not found as a whole.
constexpr std::size_t kFewest = 120;

/// Relative to the folder of the cases, so that no finding has a path of this machine.
const fs::path kShipped = "../../config/profiles";

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    lines.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return lines;
}

/// What is only in one of both: `-` expected, `+` written.
std::string difference(const std::string& expected, const std::string& written) {
  const auto before = lines_of(expected);
  const auto after = lines_of(written);
  const auto lacks = [](const std::vector<std::string>& lines, const std::string& line) {
    return std::find(lines.begin(), lines.end(), line) == lines.end();
  };
  std::string text;
  for (const std::string& line : before) {
    text += lacks(after, line) ? "- " + line + "\n" : "";
  }
  for (const std::string& line : after) {
    text += lacks(before, line) ? "+ " + line + "\n" : "";
  }
  return text.empty() ? "the same lines, but in another order or number, or without the last line break:\n" + written
                      : text;
}

std::string with_exit(std::string output, int code) {
  return std::move(output) + "exit " + std::to_string(code) + "\n";
}

/// In the folder of the cases; the directory before is restored.
class CasesTest : public testing::Test {
 protected:
  CasesTest() : before_(fs::current_path()) { fs::current_path(GATEWAY_SOURCE_DIR "/tests/cases"); }
  ~CasesTest() override { fs::current_path(before_); }

  /// Names of the entries that end so, without that end.
  static std::set<std::string> names_with(std::string_view extension) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(".")) {
      if (entry.path().extension() == extension) {
        names.insert(entry.path().stem().string());
      }
    }
    return names;
  }

  static std::vector<fs::path> profile_dirs(const std::string& name) { return {name + ".profiles", kShipped}; }

  /// What `check` writes and returns, in this process.
  static std::string checked_here(const std::string& name) {
    Options options;
    options.config = name + ".toml";
    options.config_given = true;
    options.profile_dirs = profile_dirs(name);
    testing::internal::CaptureStdout();
    const int code = check(options);
    return with_exit(testing::internal::GetCapturedStdout(), code);
  }

  /// The same from the program.
  static std::string checked_by_program(const std::string& name) {
    std::vector<std::string> arguments{"check", "--config", name + ".toml"};
    for (const fs::path& directory : profile_dirs(name)) {
      if (fs::exists(directory)) {
        arguments.insert(arguments.end(), {"--profile-dir", directory.string()});
      }
    }
    test::Program program(arguments);
    const int code = program.exit_code();
    return with_exit(program.output(), code);
  }

 private:
  fs::path before_;
};

TEST_F(CasesTest, AreWholeAndMany) {
  const auto cases = names_with(".toml");
  EXPECT_GE(cases.size(), kFewest);
  for (const std::string& name : cases) {
    EXPECT_TRUE(fs::exists(name + ".expected")) << name << ".toml has no " << name << ".expected";
  }
  for (const std::string_view extension : {".expected", ".profiles"}) {
    for (const std::string& name : names_with(extension)) {
      EXPECT_TRUE(cases.contains(name)) << name << extension << " has no " << name << ".toml";
    }
  }
}

TEST_F(CasesTest, SayWhatIsExpected) {
  const bool rewrite = std::getenv("GATEWAY_REWRITE_CASES") != nullptr;  // NOLINT(concurrency-mt-unsafe): one thread
  for (const std::string& name : names_with(".toml")) {
    const fs::path file = name + ".expected";
    const std::string expected = content_of(file);
    const std::string written = checked_here(name);
    if (written == expected) {
      continue;
    }
    ADD_FAILURE() << name << (rewrite ? " (rewritten)" : "") << ":\n" << difference(expected, written);
    if (rewrite) {
      std::ofstream(file, std::ios::binary) << written;
    }
  }
  ASSERT_FALSE(rewrite) << "GATEWAY_REWRITE_CASES is set: look at what changed in tests/cases, and unset it";
}

/// One of each kind: several findings in the site's file, one in a profile of its own, a warning, no TOML, nothing to
/// say.
TEST_F(CasesTest, SayTheSameWhenTheProgramRuns) {
  for (const std::string name : {"place-five-mistakes", "profile-typo-in-it", "heartbeat-timeout-below-twice",
                                 "toml-missing-quote", "good-all-four-systems"}) {
    EXPECT_EQ(checked_by_program(name), content_of(name + ".expected")) << name;
  }
}

}  // namespace
}  // namespace gateway

// The boot letters: the manual says what the alarm says.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <string>

#include "canopen/node/boot_result.h"

namespace canopen {
namespace {

constexpr std::array kAllHeldBack{HeldBack::no, HeldBack::left_operational, HeldBack::found_stopped,
                                  HeldBack::start_ignored};

std::set<std::string> letters_of_the_code() {
  std::set<std::string> rows;
  for (unsigned number = 1; number < 255; ++number) {
    for (const HeldBack held_back : kAllHeldBack) {
      const auto result = static_cast<BootResult>(number);
      if (!text_of(result, held_back).empty()) {
        rows.insert("| " + std::string(1, static_cast<char>(number)) + " | " + std::string(text_of(result, held_back)) +
                    " | " + std::string(first_steps(result, held_back)) + " |");
      }
    }
  }
  return rows;
}

std::set<std::string> letters_of_the_manual() {
  std::ifstream manual(GATEWAY_SOURCE_DIR "/docs/CANOPEN.md");
  std::set<std::string> rows;
  bool there = false;
  for (std::string line; std::getline(manual, line);) {
    if (line.starts_with("#")) {
      there = line == "### Boot letters";
    } else if (there && line.starts_with("| ") && !line.starts_with("| letter |")) {
      rows.insert(line);
    }
  }
  return rows;
}

TEST(BootLetters, TheManualHasTheTableOfTheCode) {
  EXPECT_EQ(letters_of_the_manual(), letters_of_the_code());
}

TEST(BootLetters, EachHasATextAndFirstSteps) {
  std::string letters;
  for (unsigned number = 0; number <= 255; ++number) {
    const auto result = static_cast<BootResult>(number);
    EXPECT_EQ(text_of(result).empty(), first_steps(result).empty()) << number;
    if (!text_of(result).empty()) {
      letters += static_cast<char>(number);
      EXPECT_TRUE(is_letter(result)) << number;
    }
  }
  EXPECT_EQ(letters, "BCDEFJKLMNO") << "those of CiA 302-2 that occur";
}

// A drive that is started with a run command may run: whoever follows the steps takes it away first.
TEST(BootLetters, NoFirstStepLeadsToAStartWithARunCommand) {
  int starts = 0;
  for (unsigned number = 1; number < 255; ++number) {
    for (const HeldBack held_back : kAllHeldBack) {
      const std::string_view steps = first_steps(static_cast<BootResult>(number), held_back);
      const std::size_t start = std::min(steps.find("NMT start"), steps.find("NMT pre-operational"));
      if (start == std::string_view::npos) {
        continue;
      }
      ++starts;
      EXPECT_LT(steps.find("take its run command away where it comes from"), start) << steps;
      const std::size_t stop =
          std::min({steps.find("send a stop"), steps.find("stop the motor"), steps.find("switch it off and on")});
      EXPECT_LT(stop, start) << steps;
    }
  }
  EXPECT_EQ(starts, 3 + static_cast<int>(kAllHeldBack.size())) << "three of J; L whatever holds it";
}

TEST(BootLetters, OnlyLetterJDependsOnWhatHoldsTheDriveBack) {
  std::set<std::string_view> texts;
  for (const HeldBack held_back : kAllHeldBack) {
    texts.insert(text_of(BootResult::not_configured, held_back));
    EXPECT_EQ(text_of(BootResult::left_alone, held_back), text_of(BootResult::left_alone));
    EXPECT_EQ(first_steps(BootResult::left_alone, held_back), first_steps(BootResult::left_alone));
  }
  EXPECT_EQ(texts.size(), kAllHeldBack.size());
}

}  // namespace
}  // namespace canopen

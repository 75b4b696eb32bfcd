#include "canopen/error.h"

#include <gtest/gtest.h>

namespace canopen {
namespace {

TEST(Errors, TellWhatWhereAndWhy) {
  const Error refused{.kind = ErrorKind::refused, .node = 5, .object = {0x2001, 0}, .abort = 0x06020000};
  EXPECT_EQ(to_string(refused),
            "refused: node 5, object 0x2001:00, SDO abort 0x06020000 (Object does not exist in the object dictionary)");
  const Error unknown{.kind = ErrorKind::timeout, .node = 3, .outcome_unknown = true, .detail = "no echo"};
  EXPECT_EQ(to_string(unknown), "timeout, outcome unknown: node 3, no echo");
  EXPECT_EQ(to_string(Error{.kind = ErrorKind::read_only}), "read-only");
}

TEST(Errors, AbortTextsAreThoseOfCia301) {
  EXPECT_EQ(abort_text(0x06090030), "Invalid value for parameter (download)");
  EXPECT_EQ(abort_text(0x08000024), "No data available");
  EXPECT_EQ(abort_text(0x12345678), "unknown abort code");
  EXPECT_EQ(abort_text(0), "unknown abort code");
}

TEST(Errors, Abort08000020ShowsTheMakersTextToo) {
  const std::string text(abort_text(0x08000020));
  EXPECT_NE(text.find("cannot be transferred or stored to the application"), std::string::npos) << text;
  EXPECT_NE(text.find("AC300CAN1: cannot be changed in the current device state"), std::string::npos) << text;
}

TEST(Errors, AbortsOfStateAndLocalControlNameTheOtherCauseToo) {
  for (const std::uint32_t code : {0x08000020U, 0x08000021U, 0x08000022U}) {
    const std::string text(abort_text(code));
    EXPECT_NE(text.find("only by PDO: write the fields together"), std::string::npos) << text;
  }
  EXPECT_NE(abort_text(0x08000021).find("local control"), std::string_view::npos);
  EXPECT_NE(abort_text(0x08000022).find("device state"), std::string_view::npos);
}

TEST(Errors, AResultWithoutValueThrowsItsText) {
  const Result<int> result = Error{.kind = ErrorKind::offline, .node = 7};
  try {
    (void)result.value();
    FAIL() << "no exception";
  } catch (const std::exception& thrown) {
    EXPECT_EQ(std::string(thrown.what()), "offline: node 7");
  }
}

}  // namespace
}  // namespace canopen

#include "bridges/trace/filter.h"

#include <gmock/gmock.h>

#include <string>

#include "tests/unit/trace/site.h"

namespace trace {
namespace {

using test::Listener;
using testing::HasSubstr;

class TraceFilter : public testing::Test {
 protected:
  bool shows(const FilterWords& words, std::string_view frame) {
    const auto filter = make_filter(bus_.model(), words);
    EXPECT_TRUE(filter.has_value()) << words.names;
    return filter.has_value() && passes(bus_.model(), filter.value(), bus_.hear(frame));
  }
  std::string refusal(const FilterWords& words) {
    const auto filter = make_filter(bus_.model(), words);
    return filter.has_error() ? filter.error().detail : "";
  }

  Listener bus_;
};

TEST_F(TraceFilter, OfADriveIsWhatItSendsAndWhatIsForIt) {
  for (const std::string_view frame : {"185#01", "205#01", "705#05", "585#6017100000000000", "605#4017100000000000",
                                       "085#0000000000000000", "000#0105", "000#8100"}) {
    EXPECT_TRUE(shows({.names = "pump1"}, frame)) << frame;
    EXPECT_TRUE(shows({.names = "fan1,pump1"}, frame)) << frame;
    EXPECT_TRUE(shows({}, frame)) << frame;
    EXPECT_TRUE(shows({.names = "can0"}, frame)) << frame;
    EXPECT_FALSE(shows({.names = "winder1"}, frame)) << frame;
    EXPECT_FALSE(shows({.names = "can1"}, frame)) << frame;
  }
  for (const std::string_view frame : {"182#01", "000#0102", "080#", "77F#05", "20000040#"}) {
    EXPECT_FALSE(shows({.names = "pump1"}, frame)) << frame;
  }
}

TEST_F(TraceFilter, KindsAndIdentifiers) {
  EXPECT_TRUE(shows({.kinds = "sdo,emcy"}, "085#0000000000000000"));
  EXPECT_FALSE(shows({.kinds = "sdo,emcy"}, "185#01"));
  EXPECT_TRUE(shows({.cob_ids = "0x185,285"}, "185#01"));
  EXPECT_FALSE(shows({.cob_ids = "0x185"}, "285#01"));
  EXPECT_FALSE(shows({.cob_ids = "0x185"}, "00000185#01")) << "29 bits are another identifier";
  EXPECT_FALSE(shows({.cob_ids = "0x040"}, "20000040#")) << "it has no identifier";
  EXPECT_FALSE(shows({.names = "pump1", .kinds = "sdo"}, "185#01"));
  EXPECT_FALSE(shows({.names = "pump1", .kinds = "pdo"}, "182#01"));
  EXPECT_TRUE(shows({.kinds = "error"}, "20000040#"));
}

// A list as long as a line may be: to look for a frame's identifier in it costs no more than in one of two.
TEST_F(TraceFilter, IdentifiersAreASet) {
  std::string cob_ids;
  for (int i = 0; i < 4000; ++i) {
    cob_ids += "0,7FF,";
  }
  const Filter filter = make_filter(bus_.model(), {.cob_ids = cob_ids}).value();
  ASSERT_TRUE(filter.cob_ids);
  EXPECT_EQ(filter.cob_ids->count(), 2U);
  EXPECT_TRUE(passes(bus_.model(), filter, bus_.hear("7FF#01")));
  EXPECT_TRUE(passes(bus_.model(), filter, bus_.hear("000#0105")));
  EXPECT_FALSE(passes(bus_.model(), filter, bus_.hear("7FE#01")));
}

TEST_F(TraceFilter, LostFramesMayHaveBeenOfAnyDriveOfTheirBus) {
  const Entry lost = bus_.decoder().lose(3, canopen::WallTime{});
  const auto of = [&](const FilterWords& words) {
    return passes(bus_.model(), make_filter(bus_.model(), words).value(), lost);
  };
  EXPECT_TRUE(of({.names = "pump1", .kinds = "sdo"}));
  EXPECT_TRUE(of({.cob_ids = "185"}));
  EXPECT_FALSE(of({.names = "winder1"}));
}

TEST_F(TraceFilter, WhatThereIsNotIsNamedWithWhatThereIs) {
  EXPECT_EQ(refusal({.names = "pump2"}),
            "no drive or bus \"pump2\"; there are fan1, hoist1, mixer1, pump1, winder1, and the buses can0, can1");
  EXPECT_THAT(refusal({.kinds = "sdo,tpdo"}), HasSubstr("no kind of frames \"tpdo\"; there are nmt, heartbeat"));
  EXPECT_THAT(refusal({.cob_ids = "0x800"}), HasSubstr("no COB-ID \"0x800\""));
  EXPECT_THAT(refusal({.cob_ids = "x"}), HasSubstr("no COB-ID \"x\""));
}

}  // namespace
}  // namespace trace

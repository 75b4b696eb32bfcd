#include "daemon/control/bus_table.h"

#include <gtest/gtest.h>

namespace gateway::control {
namespace {

TEST(ControlBusTable, ShowsEachBusWithWhatIsKnownOfIt) {
  const std::string buses =
      R"([{"name":"can0","interface":"can0","suspicion":{"kind":"wiring","since":"2026-01-02T03:04:05.678Z",)"
      R"("text":"wiring may be bad","seen":"","look":""},"load":{"least":0.012,"most":0.3456},)"
      R"("transmit_errors":{"least":0,"most":8},"receive_errors":{"least":0,"most":40},)"
      R"("error_frames":{"least":0,"most":12},"burst":{"frames":12,"time":0.01312},)"
      R"("nodes":[{"node":5,"drive":"pump1","timeout":1.5,"longest_gap":0.512,"margin":{"least":0.6587,"most":0.7},)"
      R"("sdo":{"count":210,"p50":0.0012,"p99":0.0345}},)"
      R"({"node":103,"drive":null,"timeout":null,"longest_gap":null,"margin":null,"sdo":null}],)"
      R"("cob_ids":[{"cob_id":"0x185","count":200,"p50":0.1,"p99":0.11,"worst":0.2041}]},)"
      R"({"name":"can1","interface":"can1","suspicion":null,"load":null,"transmit_errors":null,)"
      R"("receive_errors":null,"error_frames":{"least":0,"most":0},"burst":null,"nodes":[],"cob_ids":[]}])";
  EXPECT_EQ(bus_table(buses),
            "bus can0, can0\n"
            "  suspicion since 2026-01-02T03:04:05.678Z: wiring may be bad\n"
            "  load 1.2 to 34.6 %, transmit errors 0 to 8, receive errors 0 to 40, error frames 0 to 12 of 10000\n"
            "  longest burst 12 frames, 13.1 ms\n"
            "  node  drive  time-out   longest gap  margin  SDO p50  SDO p99  answers\n"
            "  5     pump1  1500.0 ms  512.0 ms     66 %    1.2 ms   34.5 ms  210\n"
            "  103   -      -          -            -       -        -        -\n"
            "  COB-ID  p50       p99       worst     periods\n"
            "  0x185   100.0 ms  110.0 ms  204.1 ms  200\n"
            "bus can1, can1\n"
            "  suspicion: none\n"
            "  load -, transmit errors -, receive errors -, error frames 0 to 0 of 10000\n");
}

TEST(ControlBusTable, IsNothingOfWhatIsNoListOfBuses) {
  EXPECT_EQ(bus_table("hello"), std::nullopt);
  EXPECT_EQ(bus_table("{}"), std::nullopt);
  EXPECT_EQ(bus_table("[]"), std::nullopt);
}

}  // namespace
}  // namespace gateway::control

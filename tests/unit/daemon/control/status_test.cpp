#include <gtest/gtest.h>

#include "daemon/control/status_table.h"

namespace gateway::control {
namespace {

TEST(ControlStatusTable, ShowsDrivesAndBelowWhatIsWrong) {
  const std::string status =
      R"({"ts":"2026-01-02T03:04:05.678Z","gateway":"line3","version":"0.1.0","uptime":12.3,)"
      R"("buses":[{"name":"can0","up":true,"state":"error-active","load":27.3,)"
      R"("suspicion":"wiring may be bad: it crackles","heartbeat_margin":{"node":5,"drive":"pump1","least":0.4123}},)"
      R"({"name":"can1","up":false,"state":"down","load":null,"suspicion":null,"heartbeat_margin":null}],)"
      R"("drives":[{"name":"pump1","bus":"can0","node":5,"online":true,"nmt":"operational",)"
      R"("boot":"ok","boot_text":"","heartbeat_age":0.2,"fresh":true,)"
      R"("values":{"running":true,"output_frequency":39.20},)"
      R"("commanded":{"frequency_command":39.20,"control_command":"forward"},)"
      R"("control":{"holder":"modbus 192.0.2.7","timeout":false},"alarms":[]},)"
      R"({"name":"fan1","bus":"can1","node":103,"online":false,"nmt":"unknown","boot":"B",)"
      R"("boot_text":"no SDO answer","heartbeat_age":null,"fresh":false,"values":{},)"
      R"("commanded":{},"control":{"holder":null},"alarms":[{"kind":"heartbeat",)"
      R"("code":"0x0000","reason":"lost","text":"it is gone","since":"2026-01-02T03:04:05.678Z","first":true},)"
      R"({"kind":"emcy","code":"0x0005","reason":"","text":"Overcurrent",)"
      R"("since":"2026-01-02T03:04:06.000Z","first":false}]}]})";
  EXPECT_EQ(status_table(status),
            "gateway line3 0.1.0, up 12.3 s\n"
            "bus can0  error-active  load 27.3 %  heartbeat margin 41 % (pump1)\n"
            "bus can0  suspicion: wiring may be bad: it crackles\n"
            "bus can1  down\n"
            "drive  bus   node  state        boot  heartbeat  fresh  running  commanded\n"
            "pump1  can0  5     operational  ok    0.2 s      yes    yes      frequency_command 39.2, control_command "
            "forward\n"
            "fan1   can1  103   offline      B                no\n"
            "pump1: held by modbus 192.0.2.7\n"
            "fan1: boot: no SDO answer\n"
            "fan1: alarm heartbeat, first: lost: it is gone (since 2026-01-02T03:04:05.678Z)\n"
            "fan1: alarm emcy: 0x0005 Overcurrent (since 2026-01-02T03:04:06.000Z)\n");
}

TEST(ControlStatusTable, ADriveOutOfServiceIsNotOffline) {
  EXPECT_EQ(
      status_table(
          R"({"gateway":"line3","version":"1","uptime":2.0,"drives":[{"name":"p","enabled":false,"online":false}]})"),
      "gateway line3 1, up 2 s\n"
      "drive  bus  node  state           boot  heartbeat  fresh  running  commanded\n"
      "p                 not in service\n");
}

TEST(ControlStatusTable, IsNothingOfWhatIsNoStatus) {
  EXPECT_EQ(status_table("hello"), std::nullopt);
  EXPECT_EQ(status_table("[]"), std::nullopt);
}

}  // namespace
}  // namespace gateway::control

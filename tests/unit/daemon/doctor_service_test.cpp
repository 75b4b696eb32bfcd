// What doctor makes of the units: files of systemd in directories of this test, and those of this project.

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "daemon/doctor/service.h"
#include "daemon/temporary_directory.h"
#include "tests/unit/daemon/doctor_lines.h"

namespace gateway::doctor {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

class DoctorServiceTest : public testing::Test {
 protected:
  DoctorServiceTest() {
    fs::create_directories(ours());
    for (const char* const unit : {"canopen-gateway.service", "canopen-gateway.socket"}) {
      fs::copy_file(fs::path(GATEWAY_SOURCE_DIR) / "systemd" / unit, ours() / unit);
    }
  }

  [[nodiscard]] fs::path site() const { return root_.path() / "etc"; }
  [[nodiscard]] fs::path ours() const { return root_.path() / "lib"; }
  [[nodiscard]] ServiceFacts look() const { return look_at_service({site(), ours()}); }

  static void write(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  void enable_socket() const {
    fs::create_directories(site() / "canopen-gateway.service.wants");
    fs::create_symlink(ours() / "canopen-gateway.socket",
                       site() / "canopen-gateway.service.wants/canopen-gateway.socket");
  }

 private:
  TemporaryDirectory root_;
};

TEST_F(DoctorServiceTest, ThePackagedUnits) {
  ServiceFacts facts = look();
  EXPECT_TRUE(facts.installed);
  EXPECT_THAT(facts.sockets, IsEmpty()) << "it is not enabled";
  EXPECT_FALSE(facts.takes_any_port);
  EXPECT_TRUE(facts.sees_all_as_read_only);
  EXPECT_TRUE(facts.sees_no_homes);
  EXPECT_TRUE(facts.has_own_tmp);
  EXPECT_THAT(facts.writable, ElementsAre("/var/lib/canopen-gateway", "/run/canopen-gateway"));
  enable_socket();
  EXPECT_THAT(look().sockets, ElementsAre("0.0.0.0:502"));
}

TEST_F(DoctorServiceTest, WithoutUnitsNothingIsKnownAndNothingIsSaid) {
  const ServiceFacts facts = look_at_service({site()});
  EXPECT_FALSE(facts.installed);
  EXPECT_THAT(judge(facts, {{"/home/anna/gateway.toml", Wanted::Use::read}, {"/data", Wanted::Use::keep}}, "/data/c"),
              IsEmpty());
}

TEST_F(DoctorServiceTest, DropInsAddAndAnEmptyValueForgets) {
  enable_socket();
  write(site() / "canopen-gateway.socket.d/override.conf", "[Socket]\nListenStream=[::]:502\n");
  EXPECT_THAT(look().sockets, ElementsAre("0.0.0.0:502", "[::]:502"));
  write(site() / "canopen-gateway.socket.d/override.conf", "[Socket]\nListenStream=\n ListenStream = 127.0.0.1:502 \n");
  EXPECT_THAT(look().sockets, ElementsAre("127.0.0.1:502"));
  write(ours() / "canopen-gateway.socket.d/override.conf", "[Socket]\nListenStream=192.0.2.1:502\n");
  EXPECT_THAT(look().sockets, ElementsAre("127.0.0.1:502")) << "the site's of the same name stands in its place";
  write(site() / "canopen-gateway.service.d/port.conf",
        "[Service]\nCapabilityBoundingSet=\nAmbientCapabilities=CAP_NET_RAW \\\n CAP_NET_BIND_SERVICE\n");
  EXPECT_TRUE(look().takes_any_port);
  write(site() / "canopen-gateway.service.d/home.conf", "[Service]\nProtectHome=no\nProtectSystem=full\n");
  EXPECT_FALSE(look().sees_no_homes);
  EXPECT_FALSE(look().sees_all_as_read_only);
}

TEST_F(DoctorServiceTest, WhatTheSandboxKeepsFromTheServiceIsTold) {
  using Use = Wanted::Use;
  const ServiceFacts facts = look();
  EXPECT_THAT(judge(facts, {{"/etc/canopen-gateway/gateway.toml", Use::read}, {"/var/lib/canopen-gateway", Use::keep}},
                    "/run/canopen-gateway/control"),
              IsEmpty());
  EXPECT_EQ(find(judge(facts, {{"/data/gw", Use::keep}}, ""), "cannot write there"), "warning");
  EXPECT_EQ(find(judge(facts, {{"/var/lib/canopen-gateway-2", Use::keep}}, ""), "cannot write there"), "warning");
  EXPECT_EQ(find(judge(facts, {}, "/run/control"), "cannot write there"), "warning");
  EXPECT_EQ(find(judge(facts, {{"/home/anna/key.pem", Use::secret}}, ""), "does not see it: its unit has ProtectHome="),
            "warning");
  EXPECT_EQ(find(judge(facts, {{"/tmp/gateway.toml", Use::read}}, ""), "does not see it: its unit has PrivateTmp="),
            "warning");
  write(site() / "canopen-gateway.service.d/state.conf", "[Service]\nReadWritePaths=-/data /srv/x\n");
  EXPECT_THAT(judge(look(), {{"/data/gw", Use::keep}, {"/srv/x", Use::keep}}, "/data/control"), IsEmpty());
}

}  // namespace
}  // namespace gateway::doctor

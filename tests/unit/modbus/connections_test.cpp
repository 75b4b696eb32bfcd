#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::Bytes;
using modbus_test::example_model;
using modbus_test::frame;
using modbus_test::hex;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;
using std::chrono::minutes;
using std::chrono::seconds;

void send_all(TcpClient& client, const Bytes& bytes) {
  ASSERT_EQ(client.send(bytes), bytes.size());
}

bool is_closed(Site& site, TcpClient& client) {
  return site.settle_until([&client] {
    client.receive();
    return client.closed();
  });
}

TEST(Connections, AByteAtATimeHoldsNobodyElse) {
  Site site;
  const Bytes request = frame(kUnit, "03 0064 0002");
  TcpClient& slow = site.client();
  TcpClient quick(site.port());
  for (std::size_t i = 0; i < request.size(); ++i) {
    slow.receive();
    EXPECT_FALSE(slow.has_frame()) << i;
    send_all(slow, {request[i]});
    site.settle();
    EXPECT_EQ(site.ask(quick, kUnit, "03 0064 0001"), "03 02 0000");
  }
  EXPECT_EQ(site.answer(slow), "03 04 0000 0000");
}

TEST(Connections, PipelinedRequestsAreAnsweredInOrder) {
  Site site;
  Bytes many;
  for (std::uint16_t i = 0; i < 200; ++i) {
    const Bytes one = frame(kUnit, i % 3 == 0 ? "03 0064 0001" : i % 3 == 1 ? "03 03e9 0001" : "03 0834 0001", i);
    many.insert(many.end(), one.begin(), one.end());
  }
  TcpClient& client = site.client();
  send_all(client, many);
  for (std::uint16_t i = 0; i < 200; ++i) {
    ASSERT_TRUE(site.settle_until([&client] {
      client.receive();
      return client.has_frame();
    })) << i;
    const Bytes answer = client.take_frame();
    EXPECT_EQ(answer[0] << 8 | answer[1], i);
    EXPECT_EQ(answer[7], i % 3 == 2 ? 0x83 : 0x03);
  }
}

TEST(Connections, ARequestMayComeInAnyPieces) {
  Site site;
  const Bytes request = frame(kUnit, "10 0064 0002 04 0003 1388");
  TcpClient& client = site.client();
  for (std::size_t cut = 1; cut < request.size(); ++cut) {
    send_all(client, Bytes(request.begin(), request.begin() + static_cast<std::ptrdiff_t>(cut)));
    site.settle();
    send_all(client, Bytes(request.begin() + static_cast<std::ptrdiff_t>(cut), request.end()));
    EXPECT_EQ(site.answer(client), "90 0b") << cut;  // the drive is not there
  }
}

TEST(Connections, WhatIsNoModbusIsClosed) {
  for (const char* const garbage :
       {"474554202f20485454502f312e310d0a0d0a", "0001 0001", "0001 0000 0001 05", "0001 0000 00ff 05"}) {
    Site site;
    TcpClient& client = site.client();
    send_all(client, hex(garbage));
    EXPECT_TRUE(is_closed(site, client)) << garbage;
    EXPECT_EQ(site.server().clients(), 0U);
    EXPECT_EQ(site.server().counts().garbage, 1U) << garbage;
    EXPECT_EQ(site.server().refused(), 0U) << "it was let in";
  }
}

TEST(Connections, WhatCameBeforeTheGarbageIsAnswered) {
  Site site;
  TcpClient& client = site.client();
  Bytes bytes = frame(kUnit, "03 0064 0001");
  const Bytes garbage = hex("ffff ffff ffff");
  bytes.insert(bytes.end(), garbage.begin(), garbage.end());
  send_all(client, bytes);
  EXPECT_EQ(site.answer(client), "03 02 0000");
  EXPECT_TRUE(is_closed(site, client));
}

TEST(Connections, AWriteThatClaimsMoreThanItBringsIsRefused) {
  Site site;
  TcpClient& client = site.client();
  EXPECT_EQ(site.ask(client, kUnit, "10 0064 007b f6 0001"), "90 03");
  EXPECT_EQ(site.ask(client, kUnit, "0f 000a 07b0 f6 01"), "8f 03");
  EXPECT_EQ(site.ask(client, kUnit, "03 0064 0001"), "03 02 0000");
}

TEST(Connections, TheLastRequestIsAnsweredThoughTheClientSendsNoMore) {
  Site site;
  TcpClient& client = site.client();
  send_all(client, frame(kUnit, "03 0064 0001"));
  client.finish();
  EXPECT_EQ(site.answer(client), "03 02 0000");
  EXPECT_TRUE(is_closed(site, client));
}

TEST(Connections, NoMoreClientsThanConfigured) {
  config::Model model = example_model();
  model.modbus->max_clients = 2;
  Site site(model);
  auto first = std::make_unique<TcpClient>(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.1");
  TcpClient second(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.2");
  EXPECT_EQ(site.ask(*first, kUnit, "03 0064 0001"), "03 02 0000");
  EXPECT_EQ(site.ask(second, kUnit, "03 0064 0001"), "03 02 0000");
  EXPECT_EQ(site.server().clients(), 2U);
  TcpClient third(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.3");
  EXPECT_TRUE(is_closed(site, third));
  EXPECT_EQ(site.server().refused(), 1U);
  EXPECT_EQ(site.ask(second, 0, "03 0005 0002"), "03 04 0002 0001");
  first.reset();
  ASSERT_TRUE(site.settle_until([&site] { return site.server().clients() == 1; }));
  TcpClient fourth(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.4");
  EXPECT_EQ(site.ask(fourth, kUnit, "03 0064 0001"), "03 02 0000");
}

TEST(Connections, OnlyFromTheNetworksThatMayRead) {
  config::Model model = example_model();
  model.modbus->read_from = {{"192.0.2.0", 24}, {"::", 0}};
  Site site(model);
  EXPECT_TRUE(is_closed(site, site.client()));
  EXPECT_EQ(site.server().clients(), 0U);
  EXPECT_EQ(site.server().refused(), 1U);
}

TEST(Connections, IdleClientsAreClosed) {
  config::Model model = example_model();
  model.modbus->idle_timeout = minutes(10);
  Site site(model);
  TcpClient quiet(site.port());
  TcpClient busy(site.port());
  site.settle();
  for (int i = 0; i < 19; ++i) {
    site.loop().advance(seconds(30), seconds(5));
    EXPECT_EQ(site.ask(busy, kUnit, "03 0064 0001"), "03 02 0000");
  }
  site.loop().advance(seconds(29), seconds(1));
  EXPECT_EQ(site.server().clients(), 2U);
  site.loop().advance(seconds(2), seconds(1));
  EXPECT_TRUE(is_closed(site, quiet));
  EXPECT_EQ(site.ask(busy, kUnit, "03 0064 0001"), "03 02 0000");
  site.loop().advance(minutes(10), seconds(30));
  EXPECT_TRUE(is_closed(site, busy));
}

TEST(Connections, HalfARequestIsAwaitedForFiveSeconds) {
  Site site;
  TcpClient halfway(site.port());
  TcpClient dripping(site.port());
  TcpClient late(site.port());
  const Bytes request = frame(kUnit, "03 0064 0001");
  send_all(halfway, {0, 1, 0, 0});
  send_all(late, Bytes(request.begin(), request.end() - 1));
  site.settle();
  for (std::size_t i = 0; i < 4; ++i) {
    send_all(dripping, {request[i]});
    site.loop().advance(seconds(1), seconds(1));
  }
  EXPECT_EQ(site.server().clients(), 3U);
  send_all(late, {request.back()});
  EXPECT_EQ(site.answer(late), "03 02 0000");
  site.loop().advance(seconds(2), seconds(1));
  EXPECT_TRUE(is_closed(site, halfway));
  EXPECT_TRUE(is_closed(site, dripping));  // more bytes are no request
  site.loop().advance(seconds(10), seconds(1));
  EXPECT_EQ(site.ask(late, kUnit, "03 0064 0001"), "03 02 0000");
}

TEST(Connections, AFullServerMakesRoomForAClientThatMayWrite) {
  config::Model model = example_model();
  model.modbus->max_clients = 4;
  model.modbus->write_from = {{"127.0.0.9", 32}};
  Site site(model);
  const std::uint16_t port = site.port();
  TcpClient first(port, "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.1");
  TcpClient second(port, "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.1");
  TcpClient third(port, "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.2");
  TcpClient fourth(port, "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.2");
  ASSERT_TRUE(site.settle_until([&site] { return site.server().clients() == 4; }));
  site.loop().advance(seconds(1), seconds(1));
  for (TcpClient* const client : {&first, &third, &fourth}) {
    EXPECT_EQ(site.ask(*client, kUnit, "03 0064 0001"), "03 02 0000");
  }
  TcpClient reader(port, "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.3");
  EXPECT_TRUE(is_closed(site, reader));
  TcpClient scada(port, "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.9");
  EXPECT_EQ(site.ask(scada, kUnit, "03 0064 0001"), "03 02 0000");
  EXPECT_TRUE(is_closed(site, second));
  EXPECT_EQ(site.ask(scada, 0, "03 0005 0002"), "03 04 0004 0001");
}

TEST(Connections, ThirtyTwoSilentStrangersDoNotKeepOutWhoMayWrite) {
  config::Model model = example_model();
  model.modbus->write_from = {{"127.0.0.9", 32}};
  Site site(model);
  std::list<TcpClient> silent;
  for (int i = 0; i < 32; ++i) {
    silent.emplace_back(site.port(), "127.0.0.1", TcpClient::Buffers::usual, i < 16 ? "127.0.0.2" : "127.0.0.3");
    ASSERT_TRUE(site.settle_until([&] { return site.server().clients() == silent.size(); }));
  }
  TcpClient stranger(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.4");
  EXPECT_TRUE(is_closed(site, stranger));
  EXPECT_EQ(site.noticed("warning: Modbus: 127.0.0.4: refused: max_clients are connected"), 1U);
  TcpClient scada(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.9");
  EXPECT_EQ(site.ask(scada, kUnit, "03 0064 0001"), "03 02 0000");
  EXPECT_EQ(site.noticed("info: Modbus: 127.0.0.2: disconnected: made room for a client of write_from"), 1U);
  EXPECT_EQ(site.ask(scada, 0, "03 0005 0002"), "03 04 0020 0001");
}

TEST(Connections, AFullServerLeavesAloneWhoseCommandIsUnderWay) {
  config::Model model = example_model();
  model.modbus->max_clients = 2;
  model.modbus->write_from = {{"127.0.0.8", 31}};
  Site site(model);
  site.bring_up();
  site.puppet().mute = true;
  TcpClient commanding(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.8");
  TcpClient stranger(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.1");
  send_all(commanding, frame(kUnit, "06 012c 0001"));
  ASSERT_TRUE(site.settle_until([&site] { return site.server().clients() == 2; }));
  TcpClient scada(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.9");
  EXPECT_EQ(site.ask(scada, 0, "03 0005 0001"), "03 02 0002");
  EXPECT_TRUE(is_closed(site, stranger));
  TcpClient more(site.port(), "127.0.0.1", TcpClient::Buffers::usual, "127.0.0.1");
  EXPECT_TRUE(is_closed(site, more));
  site.loop().advance(seconds(2));
  EXPECT_EQ(site.answer(commanding), "86 0b") << "it was answered";
}

TEST(Connections, WithoutIdleTimeoutTheyStay) {
  config::Model model = example_model();
  model.modbus->idle_timeout = {};
  Site site(model);
  EXPECT_EQ(site.ask("03 0064 0001"), "03 02 0000");
  site.loop().advance(std::chrono::hours(25), minutes(30));
  EXPECT_EQ(site.ask("03 0064 0001"), "03 02 0000");
}

TEST(Connections, AClientThatDoesNotReadHoldsOnlyItself) {
  Site site;
  TcpClient lazy(site.port(), "127.0.0.1", TcpClient::Buffers::small);
  TcpClient other(site.port());
  constexpr std::size_t kAtOnce = 50;
  const Bytes request = frame(kUnit, "03 03e8 0064");
  Bytes requests;
  for (std::uint16_t i = 0; i < kAtOnce; ++i) {
    const Bytes one = frame(kUnit, "03 03e8 0064", i);
    requests.insert(requests.end(), one.begin(), one.end());
  }
  // The server stops taking requests once it can not hand over answers; then the client's socket fills.
  std::size_t sent = 0;
  for (std::size_t taken = requests.size(); taken == requests.size(); sent += taken) {
    ASSERT_LT(sent, std::size_t{50} << 20) << "the server takes requests without end";
    taken = lazy.send(requests);
    site.settle();
  }
  EXPECT_EQ(site.ask(other, kUnit, "03 0064 0001"), "03 02 0000");
  // Once it reads, it gets all its answers, whole and in order.
  std::size_t answered = 0;
  const auto next = [&lazy] {
    if (!lazy.has_frame()) {
      lazy.receive();
    }
    return lazy.has_frame() || lazy.closed();
  };
  while (answered < sent / request.size()) {
    ASSERT_TRUE(site.settle_until(next)) << answered;
    ASSERT_TRUE(lazy.has_frame()) << answered;
    const Bytes answer = lazy.take_frame();
    ASSERT_EQ(answer.size(), 209U);
    ASSERT_EQ(answer[0] << 8 | answer[1], static_cast<int>(answered % kAtOnce));
    ++answered;
  }
  EXPECT_FALSE(lazy.closed());
  EXPECT_EQ(site.ask(other, kUnit, "03 0064 0001"), "03 02 0000");
}

TEST(Stopping, EndsConnectionsAndListeners) {
  Site site;
  const std::uint16_t port = site.port();
  EXPECT_EQ(site.ask("03 0064 0001"), "03 02 0000");
  site.stop_server();
  EXPECT_TRUE(is_closed(site, site.client()));
  EXPECT_EQ(site.server().clients(), 0U);
  EXPECT_FALSE(TcpClient(port).connected());
}

TEST(Stopping, AwaitsACommandThatWasBegun) {
  Site site;
  site.bring_up();
  site.puppet().mute = true;
  TcpClient& client = site.client();
  send_all(client, frame(kUnit, "06 012c 0001"));
  site.settle();
  EXPECT_EQ(site.server().clients(), 1U);
  site.stop_server();
  EXPECT_EQ(site.server().clients(), 0U);
}

}  // namespace

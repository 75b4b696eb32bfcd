// What HTTP shows of records: the list, and files a piece at a time.
#include <gmock/gmock.h>

#include <boost/json/parse.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridges/recorder/record_reader.h"
#include "bridges/recorder/stored_records.h"
#include "daemon/http/server.h"
#include "daemon/http/waiting_bytes.h"
#include "daemon/http/wire.h"
#include "tests/unit/daemon/http/server_site.h"
#include "tests/unit/daemon/http/shown_plant.h"

namespace gateway::http {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kStem = "20260102T030405.678Z-pump1-emcy";

class HttpRecords : public test::ShownPlant {
 protected:
  void show(std::optional<recorder::StoredRecords> records) {
    records_ = std::move(records);
    site_.records = [this]() -> const std::optional<recorder::StoredRecords>& { return records_; };
    site_.read_record = [](std::string, std::uint64_t) -> boost::asio::awaitable<std::optional<std::string>> {
      co_return std::nullopt;
    };
  }
  static recorder::StoredRecords one(std::uint64_t json_size = 300) {
    recorder::StoredRecords records;
    records.add({.name = recorder::parse_record_name(kStem).value(),
                 .log_size = 5000,
                 .json_size = json_size,
                 .summary = {"can0", "pump1", true, 120, 2}});
    return records;
  }
  std::optional<recorder::StoredRecords> records_;
};

TEST_F(HttpRecords, AreListed) {
  show(one());
  EXPECT_EQ(text("/api/records"),
            R"([{"name":")" + kStem + R"(.log","json":")" + kStem +
                R"(.json","ts":"2026-01-02T03:04:05.678Z","bus":"can0","drive":"pump1","kind":"emcy","first":true,)"
                R"("size":5300,"frames":120,"commands":2}])");
  show(one(0));
  EXPECT_TRUE(json("/api/records").at(0).at("json").is_null());
  show(recorder::StoredRecords());
  EXPECT_EQ(text("/api/records"), "[]");
}

TEST_F(HttpRecords, ThatThereAreNoneIsSaid) {
  EXPECT_EQ(get("/api/records").status, 404U);
  EXPECT_THAT(get("/api/records").body, HasSubstr("has no [recorder]"));
  EXPECT_EQ(get("/records/" + kStem + ".log").status, 404U);
  show(std::nullopt);
  EXPECT_EQ(get("/api/records").status, 503U);
}

TEST_F(HttpRecords, AreFilesToSave) {
  show(one());
  const Answer log = get("/records/" + kStem + ".log");
  EXPECT_EQ(log.status, 200U);
  EXPECT_EQ(log.type, "text/plain; charset=utf-8");
  EXPECT_EQ(log.attachment, kStem + ".log");
  EXPECT_EQ(log.size(), 5000U);
  EXPECT_THAT(word_head(log, true), HasSubstr("Content-Length: 5000\r\n"));
  EXPECT_THAT(word_head(log, true), HasSubstr("Content-Disposition: attachment; filename=\"" + kStem + ".log\"\r\n"));
  const Answer beside = get("/records/" + kStem + ".json");
  EXPECT_EQ(beside.type, "application/json");
  EXPECT_EQ(beside.size(), 300U);
}

TEST_F(HttpRecords, OnlyThoseThatAreListed) {
  show(one(0));
  const std::vector<std::string> names{"",
                                       kStem,
                                       kStem + ".json",
                                       kStem + ".log.new",
                                       kStem + ".log/",
                                       "../alarms.json",
                                       "..%2Falarms.json",
                                       "%2e%2e/" + kStem + ".log",
                                       "./" + kStem + ".log",
                                       "x/../" + kStem + ".log",
                                       "20260102T030405.678Z-pump2-emcy.log",
                                       std::string(1000, 'x')};
  for (const std::string& name : names) {
    const Answer answer = get("/records/" + name);
    EXPECT_EQ(answer.status, 404U) << name;
    EXPECT_FALSE(answer.file) << name;
  }
  EXPECT_EQ(get("/records/" + kStem + ".log?x=1").status, 400U);
}

/// A server whose file `/file` is read as the test says.
class HttpRecordFile : public test::ServerSite {
 protected:
  void start_with(std::uint64_t size) {
    size_ = size;
    server_ = std::make_unique<Server>(
        loop_.executor(), settings_,
        [this](const Request&) {
          return Answer{.type = "text/plain",
                        .attachment = "x.log",
                        .file = FileBody{.size = size_, .read = [this](std::uint64_t offset) { return read(offset); }}};
        },
        LiveSource{.begin = [] { return Live::Place{}; }, .take = [](Live::Place&) { return std::string(); }},
        net::Notices{.info = [](const std::string&) {}, .warning = [](const std::string&) {}});
    server_->start();
    loop_.settle();
  }
  boost::asio::awaitable<std::optional<std::string>> read(std::uint64_t offset) {
    ++reads_;
    co_return offset < there_.size() ? std::optional(there_.substr(offset, 4)) : std::nullopt;
  }
  std::string there_ = "0123456789";
  std::uint64_t size_ = 0;
  int reads_ = 0;
};

TEST_F(HttpRecordFile, ComesInPiecesAndWhole) {
  start_with(10);
  const std::string answer = ask(connect(), test::kGet);
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("Content-Length: 10\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n0123456789"));
  EXPECT_EQ(reads_, 3);
}

TEST_F(HttpRecordFile, TheConnectionGoesOnBehindIt) {
  start_with(10);
  test::RawClient& client = connect();
  ask(client, test::kGet);
  EXPECT_THAT(ask(client, test::kGet), EndsWith("\r\n\r\n0123456789"));
  EXPECT_EQ(reads_, 6);
}

TEST_F(HttpRecordFile, OneThatHasGrownIsAsLongAsItWasSaid) {
  start_with(6);
  EXPECT_THAT(ask(connect(), test::kGet), EndsWith("\r\n\r\n012345"));
}

TEST_F(HttpRecordFile, OneThatIsGoneEndsTheConnectionShort) {
  start_with(20);
  const std::string answer = ask(connect(), test::kGet);
  EXPECT_THAT(answer, HasSubstr("Content-Length: 20\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n0123456789"));
  EXPECT_EQ(server_->figures().clients, 0U);
}

// Pieces are never refused, so all that there can be leave room for answers of others.
TEST(HttpRecordPieces, OfAllClientsLeaveRoomForOthers) {
  WaitingBytes waiting;
  const auto one = boost::asio::ip::make_address("192.168.1.1");
  const auto other = boost::asio::ip::make_address("192.168.1.2");
  ASSERT_LE(recorder::RecordReader::kPiece, WaitingBytes::kSmall);
  for (std::size_t i = 0; i < Server::kMaxClients / 2; ++i) {
    waiting.add(one, recorder::RecordReader::kPiece);
    waiting.add(other, recorder::RecordReader::kPiece);
  }
  EXPECT_TRUE(waiting.has_room(one, 0, WaitingBytes::kMostOfAddress / 2));
  EXPECT_TRUE(waiting.has_room(boost::asio::ip::make_address("192.168.1.3"), 0, WaitingBytes::kMost / 2));
}

TEST_F(HttpRecordFile, HeadReadsNothing) {
  start_with(10);
  const std::string answer = ask(connect(), "HEAD /x HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_THAT(answer, HasSubstr("Content-Length: 10\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n"));
  EXPECT_EQ(reads_, 0);
}

}  // namespace
}  // namespace gateway::http

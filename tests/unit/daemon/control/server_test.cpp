#include "daemon/control/server.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fstream>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "daemon/control/accounts.h"
#include "daemon/temporary_directory.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/control/raw_client.h"

namespace gateway::control {
namespace {

using namespace std::chrono_literals;
using test::RawClient;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

mode_t mode_of(const std::filesystem::path& path) {
  struct stat found{};
  return ::lstat(path.c_str(), &found) == 0 ? found.st_mode & 0777U : 0;
}

// Answers what it is asked, `nmt` only when it is let go; so a test has requests under way.
class ControlServer : public testing::Test {
 protected:
  ControlServer() : gate_(loop_.executor()) { gate_.expires_at(canopen::kNever); }
  ~ControlServer() override { end(); }

  void start() {
    server_ = std::make_unique<Server>(
        loop_.executor(), Place{path_, group_},
        Service{.is_stop = [](const Request& request) { return request.op == Op::stop; },
                .answer = [this](Asked asked) { return answer(std::move(asked)); }},
        Server::Notices{.warning = [this](const std::string& text) { warnings_.push_back(text); },
                        .info = [this](const std::string& text) { infos_.push_back(text); }});
    server_->start();
    loop_.settle();
  }
  void end() {
    gate_.cancel();
    if (server_) {
      const auto stopped = support::spawn(loop_.executor(), server_->stop(100ms));
      EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, 1s)) << "it does not end";
      server_.reset();
    }
  }
  RawClient& connect() {
    RawClient& client = clients_.emplace_back(path_);
    loop_.settle();
    return client;
  }
  std::vector<std::string> ask(RawClient& client, std::string_view text) {
    EXPECT_EQ(client.send(text), text.size());
    loop_.settle();
    return client.lines();
  }

  boost::asio::awaitable<std::string> answer(Asked asked) {
    if (asked.request.op == Op::nmt) {
      boost::system::error_code ignored;
      co_await gate_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
    }
    asked_.push_back(asked);
    co_return "{\"id\":" + asked.id + filling_ + "}";
  }

  support::HandDrivenLoop loop_;
  canopen::Timer gate_;
  TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_.path() / "control";
  std::string group_;
  std::vector<Asked> asked_;
  std::vector<std::string> warnings_;
  std::vector<std::string> infos_;
  std::string filling_;
  std::list<RawClient> clients_;
  std::unique_ptr<Server> server_;
};

const std::string kStatus = "{\"id\":1,\"op\":\"status\"}\n";
const std::string kWaits = R"({"id":"w","op":"nmt","drive":"pump1","command":"start"})"
                           "\n";
const std::string kStop = "{\"id\":\"s\",\"op\":\"stop\"}\n";

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) {
    all += text;
  }
  return all;
}

TEST_F(ControlServer, AnswersALineByALine) {
  start();
  EXPECT_THAT(warnings_, IsEmpty());
  RawClient& client = connect();
  EXPECT_THAT(ask(client, kStatus), ElementsAre("{\"id\":1}"));
  EXPECT_THAT(ask(client, "{\"id\":\"b\",\"op\":\"sta"), IsEmpty()) << "it is not at its end";
  EXPECT_THAT(ask(client, "tus\"}\r\n\n \n"), ElementsAre("{\"id\":\"b\"}"));
  ASSERT_THAT(asked_, SizeIs(2));
  EXPECT_EQ(asked_.front().user, name_of_user(::getuid()));
  EXPECT_EQ(asked_.front().received, canopen::Clock::now());
}

TEST_F(ControlServer, CarriesOutRequestsBesideEachOther) {
  start();
  RawClient& client = connect();
  RawClient& other = connect();
  EXPECT_THAT(ask(client, kWaits + kStatus + kWaits), ElementsAre("{\"id\":1}"));
  EXPECT_THAT(ask(other, kStatus), ElementsAre("{\"id\":1}"));
  gate_.cancel();
  loop_.settle();
  EXPECT_THAT(client.lines(), ElementsAre("{\"id\":\"w\"}", "{\"id\":\"w\"}"));
}

TEST_F(ControlServer, RefusesWhatIsNoRequestAndGoesOn) {
  start();
  RawClient& client = connect();
  EXPECT_THAT(ask(client, "hello\n" + kStatus),
              ElementsAre(AllOf(HasSubstr("{\"id\":null,\"ok\":false,\"code\":\"type\""), HasSubstr("not valid JSON")),
                          "{\"id\":1}"));
  EXPECT_THAT(ask(client, "{\"id\":4,\"op\":\"fly\"}\n"),
              ElementsAre(HasSubstr("{\"id\":4,\"ok\":false,\"code\":\"unknown\"")));
  const std::string bytes("\0\xff\x80{\n", 5);
  EXPECT_THAT(ask(client, bytes), ElementsAre(HasSubstr("\"ok\":false")));
}

TEST_F(ControlServer, RefusesALineThatIsTooLong) {
  start();
  RawClient& client = connect();
  EXPECT_THAT(ask(client, std::string(kMaxLine + 5000, 'x')),
              ElementsAre(AllOf(HasSubstr("\"code\":\"type\""), HasSubstr("longer than 16384 bytes"))));
  EXPECT_THAT(ask(client, std::string(100000, 'x')), IsEmpty()) << "the rest of the same line";
  EXPECT_THAT(ask(client, "\n" + kStatus), ElementsAre("{\"id\":1}"));
  const std::string longest = "{\"id\":1,\"op\":\"status\"" + std::string(kMaxLine - kStatus.size() + 1, ' ') + "}";
  ASSERT_EQ(longest.size(), kMaxLine);
  EXPECT_THAT(ask(client, longest + "\n"), ElementsAre("{\"id\":1}"));
  EXPECT_THAT(ask(client, longest + " \n"), ElementsAre(HasSubstr("longer than")));
}

TEST_F(ControlServer, RefusesTooManyRequestsOfAClientButNoStop) {
  start();
  RawClient& client = connect();
  EXPECT_THAT(ask(client, repeated(kWaits, Connection::kMaxUnderWay)), IsEmpty());
  EXPECT_THAT(ask(client, kWaits), ElementsAre(AllOf(HasSubstr("{\"id\":\"w\",\"ok\":false,\"code\":\"timeout\""),
                                                     HasSubstr("too many requests"))));
  EXPECT_THAT(ask(client, repeated(kStop, 3)), SizeIs(3));
  EXPECT_THAT(asked_, SizeIs(3));
  EXPECT_THAT(ask(connect(), kStatus), SizeIs(1)) << "another client";
  gate_.cancel();
  loop_.settle();
  EXPECT_THAT(client.lines(), SizeIs(Connection::kMaxUnderWay));
}

TEST_F(ControlServer, AnswersAClientThatOnlyCeasedToSend) {
  start();
  RawClient& client = connect();
  client.send(kWaits + "{\"id\":2,\"op\":\"status\"}");
  client.end();
  loop_.settle();
  EXPECT_THAT(client.lines(), ElementsAre("{\"id\":2}")) << "the last line goes without an end";
  EXPECT_FALSE(client.ended());
  gate_.cancel();
  loop_.settle();
  EXPECT_THAT(client.lines(), ElementsAre("{\"id\":\"w\"}"));
  EXPECT_TRUE(client.ended());
  EXPECT_EQ(server_->clients(), 0U);
}

TEST_F(ControlServer, OutlivesAClientThatGoesWithARequestUnderWay) {
  start();
  RawClient& client = connect();
  EXPECT_THAT(ask(client, kWaits + kStatus), SizeIs(1));
  client.close();
  loop_.settle();
  EXPECT_EQ(server_->clients(), 1U) << "its request is under way";
  gate_.cancel();
  loop_.settle();
  EXPECT_EQ(server_->clients(), 0U);
  EXPECT_THAT(asked_, SizeIs(2));
}

TEST_F(ControlServer, ClosesAClientThatDoesNotRead) {
  start();
  filling_ = ",\"x\":\"" + std::string(100000, 'x') + "\"";
  RawClient& slow = connect();
  RawClient& other = connect();
  // What the kernel holds, a megabyte that waits here, and no more.
  slow.send(repeated(kStatus, 30));
  loop_.settle();
  EXPECT_EQ(server_->clients(), 1U);
  EXPECT_LT(asked_.size(), 30U) << "what it sent behind is not carried out any more";
  EXPECT_GT(asked_.size(), 10U);
  EXPECT_THAT(ask(other, kStatus), SizeIs(1));
}

TEST_F(ControlServer, ATurnOfTheLoopTakesOneRequest) {
  start();
  RawClient& client = connect();
  client.send(repeated(kStatus, 100));
  std::size_t turns = 0;
  while (asked_.size() < 100) {
    const std::size_t before = asked_.size();
    ASSERT_NE(loop_.context().poll_one(), 0U);
    EXPECT_LE(asked_.size(), before + 1);
    ++turns;
  }
  EXPECT_GE(turns, 100U);
}

TEST_F(ControlServer, ANewClientTakesThePlaceOfTheIdlest) {
  start();
  RawClient& busy = connect();
  ask(busy, kWaits);
  RawClient& idlest = connect();
  loop_.advance(1s);
  while (server_->clients() < Server::kMaxClients) {
    connect();
  }
  RawClient& further = connect();
  EXPECT_THAT(ask(further, kStop), SizeIs(1));
  EXPECT_EQ(server_->clients(), Server::kMaxClients);
  EXPECT_THAT(idlest.lines(), IsEmpty());
  EXPECT_TRUE(idlest.ended());
  EXPECT_THAT(busy.lines(), IsEmpty());
  EXPECT_FALSE(busy.ended());
}

TEST_F(ControlServer, RefusesAClientWhereAllAreBusy) {
  start();
  for (std::size_t i = 0; i < Server::kMaxClients; ++i) {
    ask(connect(), kWaits);
  }
  RawClient& further = connect();
  EXPECT_THAT(further.lines(), IsEmpty());
  EXPECT_TRUE(further.ended());
  EXPECT_EQ(server_->clients(), Server::kMaxClients);
}

TEST_F(ControlServer, MakesASocketForOwnerAndGroupAndRemovesIt) {
  const mode_t before = ::umask(0077);
  start();
  ::umask(before);
  EXPECT_EQ(mode_of(path_), 0660U);
  end();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(ControlServer, GivesItToAGroupThatThereIs) {
  group_ = "no-such-group";
  start();
  EXPECT_THAT(warnings_, IsEmpty());
  end();
  group_ = "root";
  ASSERT_EQ(group_of(group_), gid_t{0});
  start();
  struct stat found{};
  ASSERT_EQ(::lstat(path_.c_str(), &found), 0);
  if (found.st_gid != 0) {  // who is not root may not, and everything else goes on
    EXPECT_THAT(warnings_, ElementsAre(HasSubstr("cannot be given to the group root")));
  }
  EXPECT_EQ(mode_of(path_), 0660U);
  EXPECT_THAT(ask(connect(), kStatus), SizeIs(1));
}

TEST_F(ControlServer, ReplacesTheSocketOfADeadProcess) {
  {
    boost::asio::io_context context;
    const boost::asio::local::stream_protocol::acceptor dead(
        context, boost::asio::local::stream_protocol::endpoint(path_.string()));
  }
  ASSERT_TRUE(std::filesystem::is_socket(path_));
  start();
  EXPECT_THAT(warnings_, IsEmpty());
  EXPECT_THAT(ask(connect(), kStatus), SizeIs(1));
}

TEST_F(ControlServer, LeavesTheSocketOfALivingProcessAndTriesAgain) {
  {
    boost::asio::io_context context;
    const boost::asio::local::stream_protocol::acceptor living(
        context, boost::asio::local::stream_protocol::endpoint(path_.string()));
    start();
    EXPECT_FALSE(server_->listening());
    loop_.advance(10 * Server::kRetry, 100ms);
    EXPECT_THAT(warnings_, ElementsAre(HasSubstr("another process listens there"))) << "told once";
    RawClient of_the_living(path_);
  }
  loop_.advance(Server::kRetry, 100ms);
  EXPECT_THAT(infos_, ElementsAre(HasSubstr("can be reached now")));
  EXPECT_THAT(ask(connect(), kStatus), SizeIs(1));
}

TEST_F(ControlServer, LeavesAFileThatIsNoSocket) {
  std::ofstream(path_) << "dear";
  start();
  EXPECT_FALSE(server_->listening());
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("no socket stands there")));
  end();
  EXPECT_EQ(std::filesystem::file_size(path_), 4U);
}

TEST_F(ControlServer, WaitsForItsDirectory) {
  path_ = directory_.path() / "later" / "control";
  start();
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("later is not there")));
  EXPECT_FALSE(std::filesystem::exists(path_.parent_path())) << "it is not made";
  std::filesystem::create_directory(path_.parent_path());
  loop_.advance(Server::kRetry, 100ms);
  EXPECT_THAT(ask(connect(), kStatus), SizeIs(1));
}

TEST_F(ControlServer, TellsOfAPathThatIsTooLong) {
  path_ = directory_.path() / std::string(sizeof(sockaddr_un::sun_path), 'x');
  start();
  EXPECT_FALSE(server_->listening());
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("longer than 107 bytes")));
}

TEST_F(ControlServer, AnswersWhatIsUnderWayAtItsEnd) {
  start();
  RawClient& client = connect();
  ask(client, kWaits);
  server_->close();
  loop_.settle();
  client.send(kStop);
  loop_.settle();
  end();
  EXPECT_THAT(client.lines(), ElementsAre("{\"id\":\"w\"}")) << "nothing new is taken";
  EXPECT_TRUE(client.ended());
  EXPECT_THAT(asked_, SizeIs(1));
}

TEST_F(ControlServer, EndsWithAClientThatDoesNotRead) {
  start();
  filling_ = ",\"x\":\"" + std::string(900000, 'x') + "\"";
  ask(connect(), "");
  clients_.front().send(kStatus);
  loop_.settle();
  EXPECT_EQ(server_->clients(), 1U);
  end();  // expects its end
}

}  // namespace
}  // namespace gateway::control

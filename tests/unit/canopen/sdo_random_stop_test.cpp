// Whatever a drive did not answer before, in whatever order and however late: a stop that is confirmed was carried out
// behind every older write, and none of those is carried out later.

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/canopen/sdo_stop_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class RandomStopTest : public SdoStopBench {
 protected:
  using milliseconds = std::chrono::milliseconds;

  /// 0 to `end` - 1. The same numbers with every library, unlike its distributions.
  int roll(int end) { return static_cast<int>(random_() % static_cast<unsigned>(end)); }

  /// A server that takes its time, serves in order, and loses requests and answers.
  void serve() {
    slave_.script([this](const Bytes& request) -> std::optional<Answers> {
      requests_.push_back(request);
      return Answers{};
    });
  }
  void pass(milliseconds time) {
    for (; time > 0ms; time -= 1ms) {
      loop_.advance(1ms);
      if (requests_.empty()) {
        continue;
      }
      if (Clock::now() >= next_) {
        const Bytes request = requests_.front();
        requests_.pop_front();
        carry_out(request);
        next_ = Clock::now() + milliseconds(1 + roll(roll(3) == 0 ? 300 : 20));
      }
    }
  }
  void carry_out(const Bytes& request) {
    const int fate = roll(10);
    if (fate < 2 || (request[0] & 0xE0U) == 0x80) {
      return;  // It was lost, or an abort.
    }
    const bool write = (request[0] & 0xE0U) == 0x20;
    const bool refused = fate == 2;
    if (write && !refused && request[3] == kCommand.sub) {
      does_ = request[4];
    }
    if (fate > 4 || refused) {
      slave_.send(0x585, {static_cast<std::uint8_t>(refused ? 0x80
                                                    : write ? 0x60
                                                            : 0x4B),
                          request[1], request[2], request[3], 0, 0, 0, static_cast<std::uint8_t>(refused ? 8 : 0)});
      loop_.settle();
    }
  }
  void do_something() {
    switch (roll(5)) {
      case 0:
      case 1:
        commands_.push_back(support::spawn(
            loop_.executor(),
            client_->write_command(kCommand, DataType::u16, kRun, Clock::now() + milliseconds(20 + roll(300)))));
        break;
      case 2:
        reads_.push_back(support::spawn(loop_.executor(), client_->probe(kCommand, DataType::u16)));
        break;
      case 3:
        reads_.push_back(read(kStatus, DataType::u16));
        break;
      default:
        client_->interrupt();
    }
    pass(milliseconds(roll(150)));
  }
  void another_runs_it() {
    static_cast<void>(other_->send(make_frame(0x605, Bytes{0x2B, 0x30, 0x20, 2, kRun, 0, 0, 0})));
    loop_.settle();
  }
  [[nodiscard]] bool may_run_later() const {
    return std::any_of(requests_.begin(), requests_.end(), [](const Bytes& request) {
      return (request[0] & 0xE0U) == 0x20 && request[3] == kCommand.sub && request[4] == kRun;
    });
  }
  /// Whether the stop was confirmed; where it was, the drive stands.
  bool run(unsigned seed) {
    random_.seed(seed);
    use({.retries = 1, .accept_upload_style_write_answer = roll(2) == 0});
    requests_.clear();
    does_.reset();
    for (int count = 1 + roll(6); count > 0; --count) {
      do_something();
    }
    client_->withdraw_commands();  // What waits is superseded.
    const auto stopping = stop(2s);
    const int foreign = roll(4) == 0 ? roll(200) : -1;
    for (int i = 0; i < 2010 && !stopping.done(); ++i) {
      if (i == foreign) {
        another_runs_it();
      }
      pass(1ms);
    }
    EXPECT_TRUE(stopping.done());
    const bool confirmed = stopping.done() && stopping.get().has_value();
    if (confirmed) {
      EXPECT_EQ(does_, std::optional<Raw>(kHalt)) << "seed " << seed;
      EXPECT_FALSE(may_run_later()) << "seed " << seed;
    }
    EXPECT_LE(stops_heard(), SdoClient::kStopsSent);
    slave_.forget_heard();
    client_->close();
    pass(5ms);
    return confirmed;
  }

 private:
  std::mt19937 random_;
  std::deque<Bytes> requests_;
  TimePoint next_{};
  std::optional<Raw> does_;
  std::vector<support::Spawned<Result<void>>> commands_;
  std::vector<support::Spawned<Result<Raw>>> reads_;
  std::unique_ptr<Link> other_ = wire_.connect();
};

TEST_F(RandomStopTest, AConfirmedStopIsTheLastThingTheDriveDid) {
  serve();
  int confirmed = 0;
  constexpr int kRuns = 300;
  for (unsigned seed = 0; seed < kRuns && !HasFailure(); ++seed) {
    confirmed += run(seed) ? 1 : 0;
  }
  EXPECT_GE(confirmed, kRuns / 4) << "a test of nothing";
}

}  // namespace
}  // namespace canopen

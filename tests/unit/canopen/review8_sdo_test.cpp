// Proofs of a review; each fails on what it shows.

#include <vector>

#include "tests/unit/canopen/sdo_stop_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class Review8SdoTest : public SdoStopBench {};

// Another node's SDO request of ours waits for its echo: the abort of the upload waits behind it, and the stop drops it.
TEST_F(Review8SdoTest, TheAbortOfAnUploadInSegmentsIsNotLostBeforeAStop) {
  slave_.set_bytes(kName, Bytes(250, 1));
  slave_.delay_answers(5ms);
  const auto reading = read(kName, DataType::u64);
  loop_.advance(17ms);
  ASSERT_FALSE(reading.done());
  slave_.forget_heard();
  const auto stopping = stop();
  loop_.advance(1ms);
  // The echo of a request to node 6 is late, as on a busy bus.
  closed_ = true;
  const Ticket other = bus_.send(TransmitClass::sdo, make_frame(0x606, Bytes{0x40, 0, 0x10, 0, 0, 0, 0, 0}),
                                 Clock::now() + 1s);
  loop_.advance(6ms);
  closed_ = false;
  loop_.advance(40ms);
  ASSERT_GT(stops_heard(), 0);
  bool aborted = false;
  for (const Frame& frame : slave_.heard_on(0x605)) {
    if (frame.data[0] == 0x2B) {
      break;
    }
    aborted = aborted || frame.data[0] == 0x80;
  }
  EXPECT_TRUE(aborted) << "a server that waits for a segment refuses the stop, naming the object of the upload";
}

// It is over, but the coroutine has not been resumed.
TEST_F(Review8SdoTest, AStopIsNotSentAgainOnceItIsClosed) {
  slave_.mute(kCommand);
  const auto older = command(kCommand, kRun, 50ms);
  loop_.advance(60ms);
  ASSERT_TRUE(older.done());
  const auto stopping = stop();
  loop_.advance(5ms);
  slave_.forget_heard();
  // Answer and end in the same turn of the loop.
  const auto subscription =
      bus_.subscribe(kSdoAnswerBase + kSdoNode, [this](const Received&) { client_->close(); });
  confirm(kCommand);
  loop_.advance(20ms);
  EXPECT_EQ(stops_heard(), 0) << "close() sends nothing";
  EXPECT_TRUE(stopping.done());
  loop_.advance(1s);
}

}  // namespace
}  // namespace canopen

#include "canopen/bus/transmit_queue.h"
#include "tests/support/transmit_queue_fixture.h"

namespace canopen {
namespace {

class Review8QueueTest : public support::TransmitQueueFixture {};

// The echo of a command was lost, and our heartbeat proves that it has gone.
TEST_F(Review8QueueTest, AStopGoesOnceTheCommandBeforeItIsProvenGone) {
  see_life();
  push(TransmitClass::command, support::frame(0x205, 1));
  advance(21ms);
  push(TransmitClass::stop, support::frame(0x205, 0));
  push(TransmitClass::control, support::frame(0x77F));
  echo(support::frame(0x77F));
  EXPECT_EQ(link.sent.back(), support::frame(0x205, 0));
  advance(78ms);
  EXPECT_EQ(link.sent.back(), support::frame(0x205, 0)) << "99 ms later";
}

}  // namespace
}  // namespace canopen

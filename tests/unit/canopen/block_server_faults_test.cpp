#include <gtest/gtest.h>

#include "tests/support/block_server.h"
#include "tests/unit/canopen/block_server_bench.h"

namespace support {
namespace {

using namespace block_server_bench;

/// An object of 30 bytes, five segments.
class BlockServerFaults : public testing::Test {
 protected:
  BlockServerFaults() { server_.objects[kObject] = counting(30); }

  void begin_upload() { EXPECT_EQ(say(server_, "A4 00 20 01 03 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"}); }
  Answers start() { return say(server_, "A3 00 00 00 00 00 00 00"); }
  void begin_download() { EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"}); }
  /// `123456789`.
  Answers download_segments() {
    EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), kNoAnswer);
    return say(server_, "82 38 39 00 00 00 00 00");
  }
  Answers end_download() { return say(server_, "D5 C3 31 00 00 00 00 00"); }

  BlockServer server_{5};
};

TEST_F(BlockServerFaults, ASegmentOfAnUploadIsLostOnce) {
  server_.faults.lose = {.sub_block = 2, .seqno = 1};
  begin_upload();
  EXPECT_EQ(start(), (Answers{"01 00 01 02 03 04 05 06", "02 07 08 09 0A 0B 0C 0D", "03 0E 0F 10 11 12 13 14"}));
  EXPECT_EQ(say(server_, "A2 03 03 00 00 00 00 00"), Answers{"82 1C 1D 00 00 00 00 00"});
  EXPECT_FALSE(server_.faults.lose);
  EXPECT_EQ(say(server_, "A2 00 03 00 00 00 00 00"), (Answers{"01 15 16 17 18 19 1A 1B", "82 1C 1D 00 00 00 00 00"}));
}

TEST_F(BlockServerFaults, ASegmentOfADownloadIsLostOnce) {
  server_.faults.lose = {.sub_block = 1, .seqno = 1};
  begin_download();
  EXPECT_EQ(download_segments(), Answers{"A2 00 7F 00 00 00 00 00"});
  EXPECT_FALSE(server_.faults.lose);
  EXPECT_EQ(download_segments(), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(end_download(), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("123456789"));
}

TEST_F(BlockServerFaults, ALostLastSegmentIsNotAcknowledgedUntilItComes) {
  server_.faults.lose = {.sub_block = 1, .seqno = 2};
  begin_download();
  EXPECT_EQ(download_segments(), kNoAnswer);
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"A2 02 7F 00 00 00 00 00"});
}

TEST_F(BlockServerFaults, ASegmentIsSentTwice) {
  server_.faults.send_twice = {.sub_block = 1, .seqno = 2};
  begin_upload();
  EXPECT_EQ(start(), (Answers{"01 00 01 02 03 04 05 06", "02 07 08 09 0A 0B 0C 0D", "02 07 08 09 0A 0B 0C 0D",
                              "03 0E 0F 10 11 12 13 14"}));
  EXPECT_FALSE(server_.faults.send_twice);
}

TEST_F(BlockServerFaults, LessIsAcknowledgedThanCame) {
  server_.faults.acknowledge = 1;
  begin_download();
  EXPECT_EQ(download_segments(), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_FALSE(server_.faults.acknowledge);
  EXPECT_EQ(say(server_, "81 38 39 00 00 00 00 00"), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_EQ(end_download(), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("123456789"));
}

TEST_F(BlockServerFaults, MoreIsAcknowledgedThanCame) {
  server_.faults.acknowledge = 9;
  begin_download();
  EXPECT_EQ(download_segments(), Answers{"A2 09 7F 00 00 00 00 00"});
  EXPECT_EQ(end_download(), Answers{"A1 00 00 00 00 00 00 00"});
}

TEST_F(BlockServerFaults, AGapIsAcknowledgedAtOnce) {
  server_.faults.acknowledge_at_gap = true;
  server_.faults.block_sizes = {127, 3};
  EXPECT_EQ(say(server_, "C6 00 20 01 1E 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "01 00 01 02 03 04 05 06"), kNoAnswer);
  EXPECT_EQ(say(server_, "03 0E 0F 10 11 12 13 14"), Answers{"A2 01 03 00 00 00 00 00"});
  // What the client sent before it heard.
  EXPECT_EQ(say(server_, "04 15 16 17 18 19 1A 1B"), kNoAnswer);
  EXPECT_EQ(say(server_, "85 1C 1D 00 00 00 00 00"), kNoAnswer);
  EXPECT_EQ(say(server_, "01 07 08 09 0A 0B 0C 0D"), kNoAnswer);
  EXPECT_EQ(say(server_, "02 0E 0F 10 11 12 13 14"), kNoAnswer);
  EXPECT_EQ(say(server_, "03 15 16 17 18 19 1A 1B"), Answers{"A2 03 03 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "81 1C 1D 00 00 00 00 00"), Answers{"A2 01 03 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 11 1F 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], counting(30));
}

TEST_F(BlockServerFaults, BlockSizesThatAreNone) {
  server_.faults.block_sizes = {0};
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"A4 00 20 01 00 00 00 00"});
  server_.faults.block_sizes = {1, 128};
  EXPECT_EQ(say(server_, "80 00 20 01 02 00 04 05"), kNoAnswer);
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"A4 00 20 01 01 00 00 00"});
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), Answers{"A2 01 80 00 00 00 00 00"});
}

TEST_F(BlockServerFaults, AWrongCrcInAnUpload) {
  server_.faults.wrong_crc = true;
  server_.objects[kObject] = letters("123456789");
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 09 00 00 00"});
  EXPECT_EQ(start().size(), 2U);
  EXPECT_EQ(say(server_, "A2 02 7F 00 00 00 00 00"), Answers{"D5 3C CE 00 00 00 00 00"});
}

TEST_F(BlockServerFaults, ARightCrcOfADownloadIsHeldToBeWrong) {
  server_.faults.wrong_crc = true;
  begin_download();
  EXPECT_EQ(download_segments(), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(end_download(), Answers{"80 00 20 01 04 00 04 05"});
  EXPECT_EQ(server_.objects[kObject], counting(30));
}

TEST_F(BlockServerFaults, AWrongN) {
  server_.faults.wrong_n = 2;
  server_.objects[kObject] = letters("123456789");
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 09 00 00 00"});
  EXPECT_EQ(start().size(), 2U);
  EXPECT_EQ(say(server_, "A2 02 7F 00 00 00 00 00"), Answers{"C9 C3 31 00 00 00 00 00"});
}

TEST_F(BlockServerFaults, NoCrc) {
  server_.faults.crc_supported = false;
  server_.objects[kObject] = letters("123456789");
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C2 00 20 01 09 00 00 00"});
  EXPECT_EQ(start().size(), 2U);
  EXPECT_EQ(say(server_, "A2 02 7F 00 00 00 00 00"), Answers{"D5 00 00 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "A1 00 00 00 00 00 00 00"), kNoAnswer);
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"A0 00 20 01 7F 00 00 00"});
  EXPECT_EQ(download_segments(), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 00 00 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
}

TEST_F(BlockServerFaults, NoSizeAndAWrongSize) {
  server_.faults.size_indicated = false;
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C4 00 20 01 00 00 00 00"});
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"40 00 20 01 00 00 00 00"});
  server_.faults.size_indicated = true;
  server_.faults.indicated_size = 0x12345678;
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 78 56 34 12"});
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"41 00 20 01 78 56 34 12"});
}

TEST_F(BlockServerFaults, NoBlockTransfersAtAll) {
  server_.faults.refuse_block = true;
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"41 00 20 01 1E 00 00 00"});
}

TEST_F(BlockServerFaults, AnAbortAmongTheSegmentsOfAnUpload) {
  server_.faults.abort = {.after_frames = 2, .code = 0x08000022};
  begin_upload();
  EXPECT_EQ(start(), (Answers{"01 00 01 02 03 04 05 06", "80 00 20 01 22 00 00 08"}));
  EXPECT_TRUE(server_.idle());
  EXPECT_FALSE(server_.faults.abort);
}

TEST_F(BlockServerFaults, AnAbortInPlaceOfTheLastConfirmationChangesNothing) {
  server_.faults.abort = {.after_frames = 2};
  begin_download();
  EXPECT_EQ(download_segments(), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(end_download(), Answers{"80 00 20 01 00 00 00 08"});
  EXPECT_EQ(server_.objects[kObject], counting(30));
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerFaults, AnAbortAmongTheSegmentsOfADownload) {
  server_.faults.abort_on = {.sub_block = 1, .seqno = 1};
  begin_download();
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), Answers{"80 00 20 01 00 00 00 08"});
  EXPECT_TRUE(server_.idle());
  // The client may have sent this one before it heard: no transfer, and ccs 4 with seqno 2 is no command.
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"80 00 00 00 01 00 04 05"});
}

TEST_F(BlockServerFaults, SilenceFromAFrameOn) {
  server_.faults.frames_until_silence = 2;
  begin_upload();
  EXPECT_EQ(start(), Answers{"01 00 01 02 03 04 05 06"});
  EXPECT_EQ(say(server_, "A2 01 03 00 00 00 00 00"), kNoAnswer);
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), kNoAnswer);
  server_.faults.frames_until_silence.reset();
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"41 00 20 01 1E 00 00 00"});
}

TEST_F(BlockServerFaults, AfterALostConfirmationTheDataAreThere) {
  server_.faults.frames_until_silence = 2;
  begin_download();
  EXPECT_EQ(download_segments(), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(end_download(), kNoAnswer);
  EXPECT_EQ(server_.objects[kObject], letters("123456789"));
}

TEST_F(BlockServerFaults, AForeignAbortChangesNothingHere) {
  server_.faults.foreign_abort = {.after_frames = 2, .abort = {.object = {0x1018, 4}, .code = 0x06020000}};
  begin_upload();
  EXPECT_EQ(start(), (Answers{"01 00 01 02 03 04 05 06", "80 18 10 04 00 00 02 06", "02 07 08 09 0A 0B 0C 0D",
                              "03 0E 0F 10 11 12 13 14"}));
  EXPECT_FALSE(server_.faults.foreign_abort);
  EXPECT_FALSE(server_.idle());
}

}  // namespace
}  // namespace support

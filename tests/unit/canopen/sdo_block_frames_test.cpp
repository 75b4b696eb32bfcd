// Block transfer as frames: what leaves is what CiA 301 §7.2.4.3.9 to §7.2.4.3.15 draws, byte for byte.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "canopen/hex.h"
#include "canopen/sdo/block_frames.h"
#include "canopen/sdo/block_upload.h"
#include "canopen/sdo/crc16.h"
#include "canopen/sdo/transfer.h"
#include "tests/unit/simulator/golden_trace.h"

namespace canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Step = SdoTransfer::Step;

constexpr ObjectAddress kReadFile{0x1021, 0};

SdoSettings with_blocks() {
  SdoSettings settings;
  settings.block = true;
  return settings;
}

Bytes counted(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

std::string text_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += (text.empty() ? "" : " ") + hex(byte, 2);
  }
  return text;
}

/// A transfer by hand: a step is compared with what is to be sent then.
class SdoBlockFramesTest : public testing::Test {
 protected:
  void begin_upload(std::size_t expected = 0) {
    transfer_.emplace(SdoTransfer::upload(with_blocks(), kReadFile, expected));
  }
  void begin_download(std::size_t size) {
    const Bytes data = counted(size);
    transfer_.emplace(SdoTransfer::download(with_blocks(), kReadFile, data));
  }
  [[nodiscard]] std::string request() const { return text_of(transfer_->request()); }
  Step hear(const Bytes& answer) { return transfer_->on_answer(answer, false); }
  /// Segments first..last of `data`, counted from 1 in the sub-block, which begins with byte `from`.
  Step hear_segments(unsigned first, unsigned last, const Bytes& data, std::size_t from = 0) {
    Step step = Step::ignored;
    for (unsigned number = first; number <= last; ++number) {
      const std::size_t begin = from + (number - 1) * kSegmentBytes;
      const std::size_t size = std::min(data.size() - begin, kSegmentBytes);
      const SdoFrame frame = block_segment(static_cast<std::uint8_t>(number), begin + size == data.size(),
                                           std::span<const std::uint8_t>(data).subspan(begin, size));
      step = transfer_->on_answer(frame, false);
    }
    return step;
  }
  std::optional<SdoTransfer> transfer_;
};

TEST_F(SdoBlockFramesTest, TheCheckSumIsThatOfXmodem) {
  const std::string digits = "123456789";
  EXPECT_EQ(crc16(Bytes(digits.begin(), digits.end())), 0x31C3U);
  EXPECT_EQ(crc16(Bytes{}), 0U);
}

TEST_F(SdoBlockFramesTest, AnUpload) {
  const Bytes data = counted(30);
  const std::uint16_t crc = crc16(data);
  begin_upload();
  EXPECT_EQ(request(), "A4 21 10 00 1F 1C 00 00");
  EXPECT_EQ(hear({0xC6, 0x21, 0x10, 0, 30, 0, 0, 0}), Step::more);
  EXPECT_EQ(request(), "A3 00 00 00 00 00 00 00");
  EXPECT_EQ(transfer_->on_departure(), Step::ignored);
  EXPECT_EQ(hear_segments(1, 4, data), Step::taken);
  EXPECT_EQ(hear_segments(5, 5, data), Step::more);
  EXPECT_EQ(request(), "A2 05 1F 00 00 00 00 00");
  EXPECT_EQ(transfer_->on_departure(), Step::ignored);
  EXPECT_EQ(hear({0xC1 | (5U << 2U), static_cast<std::uint8_t>(crc & 0xFFU), static_cast<std::uint8_t>(crc >> 8U), 0, 0,
                  0, 0, 0}),
            Step::more);
  EXPECT_EQ(request(), "A1 00 00 00 00 00 00 00");
  EXPECT_EQ(transfer_->on_departure(), Step::completed);
  EXPECT_EQ(transfer_->data(), data);
}

TEST_F(SdoBlockFramesTest, ADownload) {
  begin_download(30);
  EXPECT_EQ(request(), "C6 21 10 00 1E 00 00 00");
  EXPECT_EQ(transfer_->on_departure(), Step::ignored);
  EXPECT_EQ(hear({0xA4, 0x21, 0x10, 0, 3, 0, 0, 0}), Step::more);
  EXPECT_EQ(request(), "01 01 02 03 04 05 06 07");
  EXPECT_EQ(transfer_->on_departure(), Step::more);
  EXPECT_EQ(request(), "02 08 09 0A 0B 0C 0D 0E");
  EXPECT_EQ(transfer_->on_departure(), Step::more);
  EXPECT_EQ(request(), "03 0F 10 11 12 13 14 15");
  EXPECT_EQ(transfer_->on_departure(), Step::ignored) << "the sub-block is sent";
  EXPECT_EQ(hear({0xA2, 3, 127, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(request(), "01 16 17 18 19 1A 1B 1C");
  EXPECT_EQ(transfer_->on_departure(), Step::more);
  EXPECT_EQ(request(), "82 1D 1E 00 00 00 00 00");
  EXPECT_EQ(transfer_->on_departure(), Step::ignored);
  EXPECT_EQ(hear({0xA2, 2, 127, 0, 0, 0, 0, 0}), Step::more);
  const std::uint16_t crc = crc16(counted(30));
  EXPECT_EQ(request(), "D5 " + hex(crc & 0xFFU, 2) + " " + hex(crc >> 8U, 2) + " 00 00 00 00 00");
  EXPECT_EQ(transfer_->on_departure(), Step::ignored);
  EXPECT_EQ(hear({0xA1, 0, 0, 0, 0, 0, 0, 0}), Step::completed);
}

// The frames that any decoder can look at: of the traces the answers are played, and the requests compared.
TEST_F(SdoBlockFramesTest, TheGoldenTraces) {
  const std::string told = "Frequency inverter, 5.5 kW, firmware 1.07";
  const Bytes data(told.begin(), told.end());
  for (const char* name : {"sdo-block-upload", "sdo-block-download"}) {
    SCOPED_TRACE(name);
    const bool reads = std::string(name) == "sdo-block-upload";
    transfer_.emplace(reads ? SdoTransfer::upload(with_blocks(), {0x1008, 0}, 0)
                            : SdoTransfer::download(with_blocks(), {0x2000, 1}, data));
    Step step = Step::more;
    for (const simulator::TraceFrame& each : simulator::golden_trace(name)) {
      if (each.frame.id == 0x605) {
        ASSERT_EQ(step, Step::more);
        EXPECT_EQ(request(), text_of(each.frame.bytes()));
        step = transfer_->on_departure();
      } else {
        ASSERT_NE(step, Step::more) << "a request is missing";
        step = transfer_->on_answer(each.frame.bytes(), false);
      }
    }
    EXPECT_EQ(step, Step::completed);
    EXPECT_EQ(transfer_->data().size(), data.size());
    EXPECT_TRUE(!reads || transfer_->data() == data);
  }
}

TEST_F(SdoBlockFramesTest, AServerWithoutCheckSumIsSentNone) {
  begin_download(29);
  EXPECT_EQ(hear({0xA0, 0x21, 0x10, 0, 127, 0, 0, 0}), Step::more);
  while (transfer_->on_departure() == Step::more) {
  }
  EXPECT_EQ(hear({0xA2, 5, 127, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(request(), "D9 00 00 00 00 00 00 00");
}

TEST_F(SdoBlockFramesTest, WhatIsShortGoesTheUsualWay) {
  begin_upload(8);
  EXPECT_EQ(request(), "40 21 10 00 00 00 00 00");
  begin_upload(29);
  EXPECT_EQ(request(), "A4 21 10 00 1F 1C 00 00");
  begin_download(28);
  EXPECT_EQ(request(), "21 21 10 00 1C 00 00 00");
  begin_download(29);
  EXPECT_EQ(request(), "C6 21 10 00 1D 00 00 00");
}

TEST_F(SdoBlockFramesTest, WhatASubBlockMissesIsAskedForAgain) {
  const Bytes data = counted(31 * 7 + 3);
  begin_upload();
  EXPECT_EQ(hear({0xC4, 0x21, 0x10, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(hear_segments(1, 3, data), Step::taken);
  EXPECT_EQ(hear_segments(5, 30, data), Step::taken) << "the fourth is missing";
  EXPECT_EQ(hear_segments(31, 31, data), Step::more);
  EXPECT_EQ(request(), "A2 03 1F 00 00 00 00 00");
  EXPECT_EQ(hear_segments(1, 28, data, 21), Step::taken);
  EXPECT_EQ(hear_segments(29, 29, data, 21), Step::more) << "the last one of all";
  EXPECT_EQ(request(), "A2 1D 1F 00 00 00 00 00");
  const std::uint16_t crc = crc16(data);
  EXPECT_EQ(hear({0xC1 | (4U << 2U), static_cast<std::uint8_t>(crc & 0xFFU), static_cast<std::uint8_t>(crc >> 8U), 0, 0,
                  0, 0, 0}),
            Step::more);
  EXPECT_EQ(transfer_->on_departure(), Step::completed);
  EXPECT_EQ(transfer_->data(), data);
}

TEST_F(SdoBlockFramesTest, ASegmentThatComesTwiceCountsOnce) {
  const Bytes data = counted(31 * 7 + 1);
  begin_upload();
  EXPECT_EQ(hear({0xC4, 0x21, 0x10, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(hear_segments(1, 1, data), Step::taken);
  EXPECT_EQ(hear_segments(1, 1, data), Step::ignored);
  EXPECT_EQ(hear_segments(2, 31, data), Step::more);
  EXPECT_EQ(hear_segments(31, 31, data), Step::ignored) << "it ends no sub-block a second time";
  EXPECT_EQ(hear_segments(1, 1, data, 31 * 7), Step::more);
  EXPECT_EQ(request(), "A2 01 1F 00 00 00 00 00");
  EXPECT_EQ(hear_segments(1, 1, data, 31 * 7), Step::ignored) << "0x81 is no abort here";
}

TEST_F(SdoBlockFramesTest, OfADownloadOnlyWhatWasNotAcknowledgedIsSentAgain) {
  begin_download(35);
  EXPECT_EQ(hear({0xA4, 0x21, 0x10, 0, 4, 0, 0, 0}), Step::more);
  EXPECT_EQ(transfer_->on_departure(), Step::more);
  EXPECT_EQ(transfer_->on_departure(), Step::more);
  EXPECT_EQ(hear({0xA2, 1, 4, 0, 0, 0, 0, 0}), Step::more) << "a server that misses one may say so at once";
  EXPECT_EQ(request(), "01 08 09 0A 0B 0C 0D 0E");
  EXPECT_EQ(hear({0xA2, 1, 4, 0, 0, 0, 0, 0}), Step::ignored) << "doubled: that one is under way again";
  EXPECT_EQ(transfer_->on_departure(), Step::more);
  EXPECT_EQ(transfer_->on_departure(), Step::more);
  EXPECT_EQ(transfer_->on_departure(), Step::more);
  EXPECT_EQ(request(), "84 1D 1E 1F 20 21 22 23");
  EXPECT_EQ(hear({0xA2, 2, 1, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(request(), "01 16 17 18 19 1A 1B 1C");
  EXPECT_EQ(transfer_->on_departure(), Step::ignored) << "a sub-block is as long as the newest acknowledgement says";
  EXPECT_EQ(hear({0xA2, 1, 1, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(request(), "81 1D 1E 1F 20 21 22 23");
}

TEST_F(SdoBlockFramesTest, SegmentsOfAnUploadThatWasGivenUpPassForNothing) {
  const std::array<std::uint8_t, 4> value{1, 2, 3, 4};
  for (unsigned number = 1; number <= SdoBlockUpload::kSegments; ++number) {
    for (const unsigned last : {0U, 0x80U}) {
      SdoTransfer write = SdoTransfer::download({}, kReadFile, value);
      const auto first = static_cast<std::uint8_t>(number | last);
      EXPECT_EQ(write.on_answer(Bytes{first, 0x21, 0x10, 0, 0, 0, 0, 8}, true), Step::ignored) << number;
      EXPECT_EQ(write.on_answer(Bytes{0x60, 0x21, 0x10, 0, 0, 0, 0, 0}, true), Step::completed);
    }
  }
}

TEST_F(SdoBlockFramesTest, AnAbortWithoutObjectEndsAnUploadInSegmentsThatWasAccepted) {
  SdoTransfer read = SdoTransfer::upload({}, kReadFile, 0);
  const Bytes abort{0x80, 0, 0, 0, 0, 0, 0, 8};
  EXPECT_EQ(read.on_answer(abort, true), Step::ignored) << "it may be that of an older request";
  EXPECT_EQ(read.on_answer(Bytes{0x41, 0x21, 0x10, 0, 9, 0, 0, 0}, true), Step::more);
  EXPECT_EQ(read.on_answer(abort, true), Step::failed);
  EXPECT_EQ(read.error().abort, 0x08000000U);
}

struct Mistake {
  const char* name;
  Bytes answer;
  const char* abort;  ///< Empty: none.
};

TEST_F(SdoBlockFramesTest, MistakesOfADownloadsAnswers) {
  const std::vector<Mistake> mistakes{
      {"more is acknowledged than was sent", {0xA2, 5, 4, 0, 0, 0, 0, 0}, "80 21 10 00 03 00 04 05"},
      {"sub-blocks of no segment", {0xA2, 4, 0, 0, 0, 0, 0, 0}, "80 21 10 00 02 00 04 05"},
      {"sub-blocks of 128 segments", {0xA2, 4, 128, 0, 0, 0, 0, 0}, "80 21 10 00 02 00 04 05"},
      {"an end before the end", {0xA1, 0, 0, 0, 0, 0, 0, 0}, "80 21 10 00 01 00 04 05"},
      {"an answer to something else", {0x60, 0x21, 0x10, 0, 0, 0, 0, 0}, "80 21 10 00 01 00 04 05"},
      {"too short", {0xA2, 4, 4}, "80 21 10 00 10 00 07 06"},
      {"an abort without object", {0x80, 0, 0, 0, 0, 0, 0, 8}, ""},
      {"an abort without code", {0x80, 0x21, 0x10, 0}, ""},
  };
  for (const Mistake& each : mistakes) {
    SCOPED_TRACE(each.name);
    begin_download(35);
    EXPECT_EQ(hear({0xA4, 0x21, 0x10, 0, 4, 0, 0, 0}), Step::more);
    while (transfer_->on_departure() == Step::more) {
    }
    EXPECT_EQ(transfer_->on_answer(each.answer, true), Step::failed);
    ASSERT_EQ(transfer_->abort().has_value(), *each.abort != '\0');
    EXPECT_TRUE(!transfer_->abort() || text_of(*transfer_->abort()) == each.abort) << text_of(*transfer_->abort());
  }
}

TEST_F(SdoBlockFramesTest, MistakesOfAnUploadsAnswers) {
  const std::vector<Mistake> mistakes{
      {"a segment without number", {0x00, 1, 2, 3, 4, 5, 6, 7}, "80 21 10 00 03 00 04 05"},
      {"a segment beyond the sub-block", {0x20, 1, 2, 3, 4, 5, 6, 7}, "80 21 10 00 03 00 04 05"},
      {"too short", {0x02, 1, 2}, "80 21 10 00 10 00 07 06"},
      {"an abort without object", {0x80, 0, 0, 0, 0, 0, 0, 8}, ""},
      {"an abort without code", {0x80, 0x21, 0x10, 0}, ""},
  };
  for (const Mistake& each : mistakes) {
    SCOPED_TRACE(each.name);
    begin_upload();
    EXPECT_EQ(hear({0xC4, 0x21, 0x10, 0, 0, 0, 0, 0}), Step::more);
    EXPECT_EQ(hear_segments(1, 1, counted(40)), Step::taken);
    EXPECT_EQ(transfer_->on_answer(each.answer, true), Step::failed);
    ASSERT_EQ(transfer_->abort().has_value(), *each.abort != '\0');
    EXPECT_TRUE(!transfer_->abort() || text_of(*transfer_->abort()) == each.abort) << text_of(*transfer_->abort());
  }
}

TEST_F(SdoBlockFramesTest, MistakesOfAnUploadsEnd) {
  const std::vector<Mistake> mistakes{
      {"a wrong check sum", {0xC1, 0x12, 0x34, 0, 0, 0, 0, 0}, "80 21 10 00 04 00 04 05"},
      {"a segment more", {0x01, 1, 2, 3, 4, 5, 6, 7}, "80 21 10 00 01 00 04 05"},
      {"an abort", {0x80, 0x21, 0x10, 0, 0, 0, 0, 8}, ""},
  };
  for (const Mistake& each : mistakes) {
    SCOPED_TRACE(each.name);
    begin_upload();
    EXPECT_EQ(hear({0xC4, 0x21, 0x10, 0, 0, 0, 0, 0}), Step::more);
    EXPECT_EQ(hear_segments(1, 5, counted(35)), Step::more);
    EXPECT_EQ(hear(each.answer), Step::failed);
    ASSERT_EQ(transfer_->abort().has_value(), *each.abort != '\0');
    EXPECT_TRUE(!transfer_->abort() || text_of(*transfer_->abort()) == each.abort) << text_of(*transfer_->abort());
  }
}

TEST_F(SdoBlockFramesTest, ServersThatGetNowhereAreLeft) {
  begin_upload();
  EXPECT_EQ(hear({0xC4, 0x21, 0x10, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(hear({0x1F, 1, 2, 3, 4, 5, 6, 7}), Step::more);
  EXPECT_EQ(request(), "A2 00 1F 00 00 00 00 00");
  EXPECT_EQ(hear({0x1F, 2, 2, 3, 4, 5, 6, 7}), Step::more);
  EXPECT_EQ(hear({0x1F, 3, 2, 3, 4, 5, 6, 7}), Step::failed);
  begin_download(35);
  EXPECT_EQ(hear({0xA4, 0x21, 0x10, 0, 1, 0, 0, 0}), Step::more);
  EXPECT_EQ(hear({0xA2, 0, 1, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(request(), "01 01 02 03 04 05 06 07");
  EXPECT_EQ(hear({0xA2, 0, 1, 0, 0, 0, 0, 0}), Step::ignored) << "doubled, for the segment has not left";
  EXPECT_EQ(transfer_->on_departure(), Step::ignored);
  EXPECT_EQ(hear({0xA2, 0, 1, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(transfer_->on_departure(), Step::ignored);
  EXPECT_EQ(hear({0xA2, 0, 1, 0, 0, 0, 0, 0}), Step::failed);
}

TEST_F(SdoBlockFramesTest, ASubBlockThatRepeatsItsSegmentsForEverIsAborted) {
  begin_upload();
  EXPECT_EQ(hear({0xC4, 0x21, 0x10, 0, 0, 0, 0, 0}), Step::more);
  EXPECT_EQ(hear({1, 1, 2, 3, 4, 5, 6, 7}), Step::taken);
  EXPECT_EQ(hear({2, 1, 2, 3, 4, 5, 6, 7}), Step::taken);
  for (unsigned i = 0; i < SdoBlockUpload::kSegments; ++i) {
    ASSERT_EQ(hear({static_cast<std::uint8_t>(1 + i % 2), 1, 2, 3, 4, 5, 6, 7}), Step::taken) << i;
  }
  EXPECT_EQ(hear({2, 1, 2, 3, 4, 5, 6, 7}), Step::failed);
  ASSERT_TRUE(transfer_->abort());
  EXPECT_EQ(text_of(*transfer_->abort()), "80 21 10 00 03 00 04 05");
}

TEST_F(SdoBlockFramesTest, MoreThanIsTakenIsAborted) {
  begin_upload();
  EXPECT_EQ(hear({0xC6, 0x21, 0x10, 0, 0, 0, 1, 0}), Step::failed) << "announced";
  begin_upload();
  EXPECT_EQ(hear({0xC4, 0x21, 0x10, 0, 0, 0, 0, 0}), Step::more);
  std::size_t bytes = 0;
  Step step = Step::more;
  for (std::uint8_t number = 1; step != Step::failed; number = number == 31 ? 1 : number + 1, bytes += 7) {
    step = hear({number, 1, 2, 3, 4, 5, 6, 7});
    ASSERT_LE(bytes, SdoTransfer::kMaxBytes + 14);
  }
  EXPECT_EQ(text_of(*transfer_->abort()), "80 21 10 00 05 00 04 05");
}

TEST_F(SdoBlockFramesTest, AServerThatKnowsNoBlockTransferIsAskedTheUsualWay) {
  for (const Bytes& refusal : {Bytes{0x80, 0x21, 0x10, 0, 1, 0, 4, 5}, Bytes{0x80, 0x21, 0x10, 0}}) {
    begin_upload();
    EXPECT_EQ(hear(refusal), Step::more);
    EXPECT_TRUE(transfer_->block_refused());
    EXPECT_EQ(request(), "40 21 10 00 00 00 00 00");
    EXPECT_EQ(hear(refusal), Step::failed) << "once";
    begin_download(29);
    EXPECT_EQ(hear(refusal), Step::more);
    EXPECT_EQ(request(), "21 21 10 00 1D 00 00 00");
  }
  begin_upload();
  EXPECT_EQ(hear({0x80, 0x21, 0x10, 0, 0, 0, 2, 6}), Step::failed) << "the object is refused";
  EXPECT_EQ(transfer_->error().abort, 0x06020000U);
}

TEST_F(SdoBlockFramesTest, AServerMayAnswerABlockUploadAsAnyOther) {
  begin_upload();
  EXPECT_EQ(hear({0x43, 0x21, 0x10, 0, 1, 2, 3, 4}), Step::completed);
  EXPECT_EQ(transfer_->data(), counted(4));
  begin_upload();
  EXPECT_EQ(hear({0x41, 0x21, 0x10, 0, 7, 0, 0, 0}), Step::more);
  EXPECT_EQ(request(), "60 00 00 00 00 00 00 00");
  EXPECT_EQ(hear({0x01, 1, 2, 3, 4, 5, 6, 7}), Step::completed);
  EXPECT_EQ(transfer_->data(), counted(7));
  begin_download(29);
  EXPECT_EQ(hear({0x60, 0x21, 0x10, 0, 0, 0, 0, 0}), Step::failed) << "but no block download";
}

}  // namespace
}  // namespace canopen

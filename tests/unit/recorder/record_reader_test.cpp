#include "bridges/recorder/record_reader.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/journal/loop.h"
#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

class RecordReaderTest : public ::testing::Test {
 protected:
  std::optional<std::string> read(const std::string& name, std::uint64_t offset) {
    std::optional<std::string> text;
    const auto ended = loop_.start(into(text, name, offset));
    EXPECT_TRUE(loop_.run_until([&] { return *ended; }));
    return text;
  }
  boost::asio::awaitable<void> into(std::optional<std::string>& text, std::string name, std::uint64_t offset) {
    text = co_await reader_.read(std::move(name), offset);
  }

  RecordBench bench_;
  journal::LoopWithThread loop_;
  RecordReader reader_{loop_.executor(), bench_.records()};
};

TEST_F(RecordReaderTest, ReadsAPieceAtATime) {
  const std::string all = std::string(RecordReader::kPiece, 'a') + "the rest";
  bench_.put("x.log", all);
  EXPECT_EQ(read("x.log", 0), std::string(RecordReader::kPiece, 'a'));
  EXPECT_EQ(read("x.log", RecordReader::kPiece), "the rest");
  EXPECT_EQ(read("x.log", all.size()), "");
}

TEST_F(RecordReaderTest, WhatIsGoneIsNothing) {
  EXPECT_EQ(read("x.log", 0), std::nullopt);
}

TEST_F(RecordReaderTest, FollowsNoLink) {
  bench_.put("y.log", "y");
  std::filesystem::create_symlink("y.log", bench_.records() / "x.log");
  EXPECT_EQ(read("x.log", 0), std::nullopt);
}

TEST_F(RecordReaderTest, ManyReadersGetTheirPieces) {
  bench_.put("x.log", "0123456789");
  std::vector<std::optional<std::string>> texts(10);
  std::vector<std::shared_ptr<bool>> ended;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    ended.push_back(loop_.start(into(texts[i], "x.log", i)));
  }
  EXPECT_TRUE(loop_.run_until([&] { return std::ranges::all_of(ended, [](const auto& one) { return *one; }); }));
  for (std::size_t i = 0; i < texts.size(); ++i) {
    EXPECT_EQ(texts[i], std::string("0123456789").substr(i));
  }
}

// As a disk that hangs: the clock stands still, so nobody's patience ends.
TEST_F(RecordReaderTest, TheEndWaitsForNoDisk) {
  std::promise<void> go_on;
  RecordReader hanging(loop_.executor(), bench_.records(),
                       [goes_on = go_on.get_future().share()](const std::filesystem::path&, std::uint64_t) {
                         goes_on.wait();
                         return std::optional<std::string>("x");
                       });
  const auto read_by = [](RecordReader& reader, std::optional<std::string>& text) -> boost::asio::awaitable<void> {
    text = co_await reader.read("x.log", 0);
  };
  std::vector<std::optional<std::string>> texts(3, "y");
  std::vector<std::shared_ptr<bool>> ended;
  for (std::size_t i = 0; i < 2; ++i) {
    ended.push_back(loop_.start(read_by(hanging, texts[i])));
  }
  EXPECT_FALSE(*ended[0]);
  hanging.stop();
  ended.push_back(loop_.start(read_by(hanging, texts[2])));
  loop_.hand().settle();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(*ended[i]) << i;
    EXPECT_EQ(texts[i], std::nullopt);
  }
  go_on.set_value();
}

}  // namespace
}  // namespace recorder

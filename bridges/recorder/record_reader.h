#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "bridges/disk/worker.h"
#include "canopen/clock.h"
#include "canopen/event.h"

namespace recorder {

/// Reads files of records for whoever asks, in a thread of its own: the loop never waits for the disk. One piece is
/// read at a time, whoever waits first has the next.
class RecordReader {
 public:
  static constexpr std::size_t kPiece = 128UL * 1024;
  /// How long one piece may take, the waiting for others included.
  static constexpr canopen::Duration kPatience = std::chrono::seconds(5);

  /// `directory`: where the records are.
  RecordReader(const boost::asio::any_io_executor& executor, std::filesystem::path directory);

  /// kPiece bytes from `offset` on, fewer at the end of the file. `name`: of a file that is known to be a record's.
  /// Nothing where it cannot be read, or not in time. The reader outlives it.
  [[nodiscard]] boost::asio::awaitable<std::optional<std::string>> read(std::string name, std::uint64_t offset);

 private:
  std::filesystem::path directory_;
  canopen::Event freed_;
  disk::Worker worker_;
};

}  // namespace recorder

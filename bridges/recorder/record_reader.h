#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
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
  /// Small, since so much waits for each client at once.
  static constexpr std::size_t kPiece = 32UL * 1024;
  /// How long one piece may take, the waiting for others included.
  static constexpr canopen::Duration kPatience = std::chrono::seconds(5);

  /// At most kPiece bytes of a file from an offset on; nothing where it cannot be read. Called in the thread.
  using ReadPiece = std::function<std::optional<std::string>(const std::filesystem::path& path, std::uint64_t offset)>;
  [[nodiscard]] static std::optional<std::string> read_piece(const std::filesystem::path& path, std::uint64_t offset);

  /// `directory`: where the records are.
  RecordReader(const boost::asio::any_io_executor& executor, std::filesystem::path directory,
               ReadPiece read_piece = &RecordReader::read_piece);

  /// Whoever waits gets nothing, at once, and nobody waits any more: an orderly end waits for no disk.
  void stop();
  [[nodiscard]] bool is_stopped() const noexcept { return stopped_; }
  /// It reads just now: to let the reader go may wait for the disk.
  [[nodiscard]] bool is_busy() const noexcept { return worker_.busy(); }

  /// kPiece bytes from `offset` on, fewer at the end of the file. `name`: of a file that is known to be a record's.
  /// Nothing where it cannot be read, or not in time. The reader outlives it.
  [[nodiscard]] boost::asio::awaitable<std::optional<std::string>> read(std::string name, std::uint64_t offset);

 private:
  std::filesystem::path directory_;
  ReadPiece read_piece_;
  bool stopped_ = false;
  canopen::Event freed_;
  disk::Worker worker_;
};

}  // namespace recorder

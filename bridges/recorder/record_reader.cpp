#include "bridges/recorder/record_reader.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <utility>

#include "bridges/disk/descriptor.h"

namespace recorder {
namespace {

struct Piece {
  bool done = false;  ///< On the loop.
  std::optional<std::string> text;
};

std::optional<std::string> read_piece(const std::filesystem::path& path, std::uint64_t offset) {
  const disk::Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  std::string text(RecordReader::kPiece, '\0');
  std::size_t filled = 0;
  while (file && filled < text.size()) {
    const ssize_t size =
        pread(file.get(), text.data() + filled, text.size() - filled, static_cast<off_t>(offset + filled));
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size < 0) {
      return std::nullopt;
    }
    if (size == 0) {
      break;
    }
    filled += static_cast<std::size_t>(size);
  }
  text.resize(filled);
  return file ? std::optional(std::move(text)) : std::nullopt;
}

}  // namespace

RecordReader::RecordReader(const boost::asio::any_io_executor& executor, std::filesystem::path directory)
    : directory_(std::move(directory)), freed_(executor), worker_(executor) {}

boost::asio::awaitable<std::optional<std::string>> RecordReader::read(std::string name, std::uint64_t offset) {
  const canopen::TimePoint until = canopen::Clock::now() + kPatience;
  while (worker_.busy()) {
    if (canopen::Clock::now() >= until) {
      co_return std::nullopt;
    }
    co_await freed_.wait_until(until);
  }
  const auto piece = std::make_shared<Piece>();  // with the job, which may outlast us
  worker_.run([piece, path = directory_ / name, offset] { piece->text = read_piece(path, offset); },
              [this, piece] {
                piece->done = true;
                freed_.notify();
              });
  while (!piece->done && canopen::Clock::now() < until) {
    co_await freed_.wait_until(until);
  }
  if (!piece->done) {
    co_return std::nullopt;
  }
  std::optional<std::string> text = std::move(piece->text);
  co_return text;
}

}  // namespace recorder

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

}  // namespace

std::optional<std::string> RecordReader::read_piece(const std::filesystem::path& path, std::uint64_t offset) {
  const disk::Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  std::string text(kPiece, '\0');
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

RecordReader::RecordReader(const boost::asio::any_io_executor& executor, std::filesystem::path directory,
                           ReadPiece read_piece)
    : directory_(std::move(directory)), read_piece_(std::move(read_piece)), freed_(executor), worker_(executor) {}

void RecordReader::stop() {
  stopped_ = true;
  freed_.notify();
}

boost::asio::awaitable<std::optional<std::string>> RecordReader::read(std::string name, std::uint64_t offset) {
  const canopen::TimePoint until = canopen::Clock::now() + kPatience;
  while (worker_.busy() && !stopped_ && canopen::Clock::now() < until) {
    co_await freed_.wait_until(until);
  }
  if (worker_.busy() || stopped_) {
    co_return std::nullopt;
  }
  const auto piece = std::make_shared<Piece>();  // with the job, which may outlast us
  worker_.run([piece, read = read_piece_, path = directory_ / name, offset] { piece->text = read(path, offset); },
              [this, piece] {
                piece->done = true;
                freed_.notify();
              });
  while (!piece->done && !stopped_ && canopen::Clock::now() < until) {
    co_await freed_.wait_until(until);
  }
  if (!piece->done) {
    co_return std::nullopt;
  }
  std::optional<std::string> text = std::move(piece->text);
  co_return text;
}

}  // namespace recorder

#include "bridges/journal/tail.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "bridges/disk/descriptor.h"

namespace journal {
namespace {

std::error_code last_error() {
  return {errno, std::generic_category()};
}

}  // namespace

std::error_code read_pieces(const std::filesystem::path& file, std::uint64_t from,
                            const std::function<void(std::string_view)>& take) {
  const disk::Descriptor descriptor(open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!descriptor || lseek(descriptor.get(), static_cast<off_t>(from), SEEK_SET) < 0) {
    return last_error();
  }
  std::vector<char> piece(64UL * 1024);
  for (;;) {
    const ssize_t size = read(descriptor.get(), piece.data(), piece.size());
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size < 0) {
      return last_error();
    }
    if (size == 0) {
      return {};
    }
    take({piece.data(), static_cast<std::size_t>(size)});
  }
}

Tail find_tail(const std::filesystem::path& directory, const std::vector<File>& files, std::error_code& failure) {
  Tail tail{.hash = std::string(kNoHash)};
  // Mostly one file is read: only where a new one holds no line yet the one before tells how the chain goes on.
  for (auto file = files.rbegin(); file != files.rend() && tail.n == 0; ++file) {
    std::uint64_t end = 0;
    LineReader reader([&](const ReadLine& read) {
      tail.n = read.line.n;
      tail.hash = read.hash;
      end = read.end;
    });
    failure = read_pieces(directory / to_string(file->name), 0, [&](std::string_view bytes) { reader.add(bytes); });
    if (failure) {
      return tail;
    }
    const bool unended = reader.unended();
    const Junk torn = reader.finish();
    if (file == files.rbegin()) {
      tail.end = end;
      tail.unended = unended;
      tail.torn = torn;
    }
  }
  return tail;
}

}  // namespace journal

#include "config/files.h"

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <system_error>

namespace config {

std::variant<std::string, FileFailure> read_file(const std::filesystem::path& path) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 20U;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return FileFailure{"no such file"};
  }
  if (error) {
    return FileFailure{error.message()};
  }
  if (!std::filesystem::is_regular_file(status)) {
    return FileFailure{"not a file"};
  }
  const auto size = std::filesystem::file_size(path, error);
  if (error || size > kLargest) {
    return FileFailure{error ? error.message() : "larger than 1 MiB"};
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    return FileFailure{std::generic_category().message(errno)};
  }
  std::string content(static_cast<std::size_t>(size), '\0');
  in.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(in.gcount()));
  return content;
}

}  // namespace config

#include "config/toml/files.h"

#include <sys/stat.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

namespace config {

std::variant<FileFacts, FileFailure> look_at_file(const std::filesystem::path& path) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 20U;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (error == std::errc::no_such_file_or_directory) {
    if (is_absent(path)) {
      return FileFailure{"no such file"};
    }
    return FileFailure{std::filesystem::is_symlink(std::filesystem::symlink_status(path, error))
                           ? "the link leads nowhere"
                           : "its directory is a link that leads nowhere"};
  }
  if (error) {
    return FileFailure{error.message()};
  }
  if (!std::filesystem::is_regular_file(status)) {
    return FileFailure{std::filesystem::is_directory(status) ? "not a file but a directory"
                                                             : "not a file but a device or pipe"};
  }
  const auto size = std::filesystem::file_size(path, error);
  if (error || size > kLargest) {
    return FileFailure{error ? error.message() : "larger than 1 MiB"};
  }
  const auto others = status.permissions() & std::filesystem::perms::others_read;
  return FileFacts{.size = size, .readable_by_all = others != std::filesystem::perms::none};
}

std::variant<std::string, FileFailure> read_file(const std::filesystem::path& path) {
  auto facts = look_at_file(path);
  if (auto* const failure = std::get_if<FileFailure>(&facts); failure != nullptr) {
    return *failure;
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    return FileFailure{std::generic_category().message(errno)};
  }
  std::string content(static_cast<std::size_t>(std::get<FileFacts>(facts).size), '\0');
  in.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(in.gcount()));
  return content;
}

bool group_may_read(const std::filesystem::path& path, std::string_view group, const std::filesystem::path& groups) {
  struct stat entry{};
  if (::stat(path.c_str(), &entry) != 0 || (entry.st_mode & S_IRGRP) == 0) {
    return false;
  }
  std::ifstream in(groups);
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);  // NAME:PASSWORD:ID:MEMBERS
    std::string name;
    std::string password;
    gid_t id = 0;
    if (std::getline(fields, name, ':') && std::getline(fields, password, ':') && fields >> id && name == group) {
      return id == entry.st_gid;
    }
  }
  return false;
}

bool is_absent(const std::filesystem::path& path) {
  struct stat entry{};
  if (::lstat(path.c_str(), &entry) == 0 || errno != ENOENT) {
    return false;
  }
  const auto directory = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  // A directory that is a link which leads nowhere (a share that is not mounted) may well hold it.
  return ::lstat(directory.c_str(), &entry) != 0 ? errno == ENOENT : ::stat(directory.c_str(), &entry) == 0;
}

}  // namespace config

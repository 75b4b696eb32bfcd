#include "daemon/doctor/port_owner.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace gateway::doctor {
namespace {

namespace fs = std::filesystem;
using boost::asio::ip::tcp;

constexpr const char* kAnyV4 = "00000000";
constexpr const char* kAnyV6 = "00000000000000000000000000000000";
constexpr const char* kMappedV4 = "0000000000000000FFFF0000";  // ::ffff:0:0/96

// As /proc/net/tcp and tcp6 have an address (proc(5)): words of 32 bits as they lie in memory.
template <std::size_t kSize>
std::string hex_words(const std::array<unsigned char, kSize>& bytes) {
  std::string text;
  for (std::size_t i = 0; i < kSize; i += sizeof(std::uint32_t)) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data() + i, sizeof(word));
    text += fmt::format("{:08X}", word);
  }
  return text;
}

struct Listener {
  std::string address;
  std::string inode;
};

// Those of the port in one of the two files; empty where there is none.
std::vector<Listener> listeners_on(const char* file, std::uint16_t port) {
  constexpr const char* kListening = "0A";  // TCP_LISTEN
  const std::string at_port = fmt::format(":{:04X}", port);
  std::vector<Listener> listeners;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream columns(line);
    std::string skipped;
    std::string local;
    std::string state;
    Listener found;
    columns >> skipped >> local >> skipped >> state;
    for (int i = 0; i < 5; ++i) {  // queues, timer, retransmits, user, timeout
      columns >> skipped;
    }
    if (columns >> found.inode && state == kListening && local.ends_with(at_port)) {
      found.address = local.substr(0, local.size() - at_port.size());
      listeners.push_back(std::move(found));
    }
  }
  return listeners;
}

// Of the sockets that keep others from `at`.
std::vector<std::string> inodes_at(const tcp::endpoint& at) {
  std::vector<std::string> inodes;
  const bool is_v4 = at.address().is_v4();
  const bool is_any = at.address().is_unspecified();
  const std::string own =
      is_v4 ? hex_words(at.address().to_v4().to_bytes()) : hex_words(at.address().to_v6().to_bytes());
  for (const Listener& each : listeners_on(is_v4 ? "/proc/net/tcp" : "/proc/net/tcp6", at.port())) {
    if (is_any || each.address == own || each.address == (is_v4 ? kAnyV4 : kAnyV6)) {
      inodes.push_back(each.inode);
    }
  }
  if (is_v4 && inodes.empty()) {  // a socket of IPv6 that takes both
    for (const Listener& each : listeners_on("/proc/net/tcp6", at.port())) {
      if (each.address == kAnyV6 || each.address == kMappedV4 + own ||
          (is_any && each.address.starts_with(kMappedV4))) {
        inodes.push_back(each.inode);
      }
    }
  }
  return inodes;
}

// The links to what it has open; nothing where that cannot be seen.
std::optional<std::set<std::string>> open_files_of(const fs::path& process) {
  std::set<std::string> links;
  std::error_code failed;
  for (fs::directory_iterator each(process / "fd", failed), end; !failed && each != end; each.increment(failed)) {
    std::error_code gone;  // closed in between
    links.insert(fs::read_symlink(each->path(), gone).string());
  }
  return failed ? std::nullopt : std::optional(std::move(links));
}

}  // namespace

std::optional<bool> is_held_by(const tcp::endpoint& at, pid_t process) {
  const fs::path directory = fs::path("/proc") / std::to_string(process);
  std::error_code failed;
  const fs::path network = fs::read_symlink(directory / "ns/net", failed);
  if (process <= 0 || failed || network != fs::read_symlink("/proc/self/ns/net", failed)) {
    return std::nullopt;
  }
  const std::vector<std::string> inodes = inodes_at(at);
  const std::optional<std::set<std::string>> open = open_files_of(directory);
  if (inodes.empty() || !open) {
    return std::nullopt;
  }
  return std::ranges::all_of(
      inodes, [&open](const std::string& inode) { return open->contains(fmt::format("socket:[{}]", inode)); });
}

}  // namespace gateway::doctor

#include "tests/support/tshark.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "canopen/hex.h"

namespace support {
namespace {

/// A folder that goes with it.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "tshark-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("no temporary folder");
    }
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

std::string candump_text(const canopen::Frame& frame) {
  std::string text = canopen::hex(frame.id, 3) + "#";
  if (frame.remote) {
    return text + "R" + (frame.size == 0 ? "" : std::to_string(frame.size));
  }
  for (const std::uint8_t byte : frame.bytes()) {
    text += canopen::hex(byte, 2);
  }
  return text;
}

void write_log(const std::filesystem::path& path, std::span<const canopen::Received> frames) {
  std::ofstream log(path);
  for (const canopen::Received& sent : frames) {
    const auto since = std::chrono::duration_cast<std::chrono::microseconds>(sent.at.time_since_epoch()).count();
    std::array<char, 40> time{};
    std::snprintf(time.data(), time.size(), "(%010lld.%06lld) can0 ", static_cast<long long>(since / 1'000'000),
                  static_cast<long long>(since % 1'000'000));
    log << time.data() << candump_text(sent.frame) << '\n';
  }
}

std::string output_of(const std::string& command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  if (!pipe) {
    throw std::runtime_error("cannot run: " + command);
  }
  std::string output;
  std::array<char, 4096> part{};
  for (std::size_t size = 0; (size = std::fread(part.data(), 1, part.size(), pipe.get())) > 0;) {
    output.append(part.data(), size);
  }
  return output;
}

}  // namespace

std::vector<Decoded> decode_log_by_tshark(const std::filesystem::path& log) {
  const std::string output = output_of("tshark -r '" + log.string() +
                                       "' -d can.subdissector,canopen -T fields -E separator='|' -e _ws.malformed "
                                       "-e _ws.col.Info 2>/dev/null");
  std::vector<Decoded> decoded;
  for (std::size_t begin = 0; begin < output.size();) {
    const std::size_t end = output.find('\n', begin);
    const std::string line = output.substr(begin, end - begin);
    begin = end == std::string::npos ? output.size() : end + 1;
    const std::size_t bar = line.find('|');
    if (bar == std::string::npos) {
      throw std::runtime_error("tshark says what nobody asked for: " + line);
    }
    decoded.push_back({{}, bar != 0, line.substr(bar + 1)});
  }
  return decoded;
}

std::vector<Decoded> decode_by_tshark(std::span<const canopen::Received> frames) {
  const Folder folder;
  const std::filesystem::path log = folder.path() / "sent.log";
  write_log(log, frames);
  std::vector<Decoded> decoded = decode_log_by_tshark(log);
  if (decoded.size() != frames.size()) {
    throw std::runtime_error("tshark decoded " + std::to_string(decoded.size()) + " of " +
                             std::to_string(frames.size()) + " frames: is it installed?");
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    decoded[i].frame = candump_text(frames[i].frame);
  }
  return decoded;
}

}  // namespace support

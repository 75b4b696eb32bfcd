#include "tests/unit/simulator/golden_trace.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <regex>
#include <stdexcept>

namespace simulator {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(GATEWAY_SOURCE_DIR) / "tests/golden";

unsigned hex(std::string_view text) {
  unsigned value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value, 16);
  return value;
}

}  // namespace

std::vector<TraceFrame> golden_trace(std::string_view name) {
  const std::filesystem::path path = kFolder / (std::string(name) + ".log");
  std::ifstream file(path);
  if (!file) {
    throw std::runtime_error(path.string() + ": cannot be read");
  }
  static const std::regex line_form(R"(^\((\d+)\.(\d{6})\) \S+ ([0-9A-F]{3})#((?:[0-9A-F]{2}){0,8})$)");
  std::vector<TraceFrame> trace;
  canopen::Duration first{};
  std::string line;
  while (std::getline(file, line)) {
    std::smatch parts;
    if (!std::regex_match(line, parts, line_form)) {
      throw std::runtime_error(path.string() + ": not a frame: " + line);
    }
    const canopen::Duration at =
        std::chrono::seconds(std::stoll(parts[1])) + std::chrono::microseconds(std::stoll(parts[2]));
    if (trace.empty()) {
      first = at;
    }
    canopen::Frame frame;
    frame.id = hex(parts[3].str());
    const std::string data = parts[4];
    for (std::size_t i = 0; i + 1 < data.size(); i += 2) {
      frame.data[frame.size++] = static_cast<std::uint8_t>(hex(std::string_view(data).substr(i, 2)));
    }
    trace.push_back({at - first, frame});
  }
  if (trace.empty()) {
    throw std::runtime_error(path.string() + ": no frames");
  }
  return trace;
}

std::vector<std::string> golden_trace_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    if (entry.path().extension() == ".log") {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace simulator

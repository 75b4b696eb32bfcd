#include "daemon/http/page.h"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace gateway::http {
namespace {

constexpr const char* kChartFile = "/usr/share/javascript/dygraphs/dygraph.min.js";
constexpr std::string_view kChartPath = "/page/dygraph.js";

}  // namespace

std::string chart_library() {
  std::ifstream file(kChartFile, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::optional<Answer> page_file(std::string_view path, const std::string& charts) {
  if (path == kChartPath && !charts.empty()) {
    return Answer{.type = "text/javascript; charset=utf-8", .lasting = &charts, .page = true};
  }
  const auto files = page_files();
  const auto found = std::ranges::find(files, path, &PageFile::path);
  if (found == files.end()) {
    return std::nullopt;
  }
  return Answer{.type = found->type, .body = std::string(found->text), .page = true};
}

}  // namespace gateway::http

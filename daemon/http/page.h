#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "daemon/http/answer.h"

namespace gateway::http {

/// A file of the status page, which is part of the program.
struct PageFile {
  std::string_view path;  ///< As it is asked for.
  std::string_view type;
  std::string_view text;
};

[[nodiscard]] std::span<const PageFile> page_files() noexcept;

/// The text of dygraphs, which draws the page's trend lines, where this machine has Debian's package of it; else empty.
[[nodiscard]] std::string chart_library();

/// A file of the page; nothing: there is none of that path. `charts`: that of chart_library(), which outlives the
/// answer.
[[nodiscard]] std::optional<Answer> page_file(std::string_view path, const std::string& charts);

}  // namespace gateway::http

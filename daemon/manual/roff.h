#pragma once

#include <string>
#include <string_view>

namespace gateway::manual {

/// Text of ours as a line of roff: nothing in it is taken for a request; `code` between backticks is bold.
[[nodiscard]] std::string roff(std::string_view text);

/// A heading of the first or second level.
[[nodiscard]] std::string heading(std::string_view text);
[[nodiscard]] std::string subheading(std::string_view text);

/// A paragraph with a hanging tag.
[[nodiscard]] std::string tagged(std::string_view tag, std::string_view text);

}  // namespace gateway::manual

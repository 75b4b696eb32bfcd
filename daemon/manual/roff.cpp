#include "daemon/manual/roff.h"

namespace gateway::manual {
namespace {

// groff_char(7): these would come out as typographic signs that nobody can copy into a shell, or end a font.
std::string_view escaped(char sign) {
  switch (sign) {
    case '\\':
      return "\\(rs";
    case '-':
      return "\\-";
    case '\'':
      return "\\(aq";
    case '^':
      return "\\(ha";
    case '~':
      return "\\(ti";
    case '"':
      return "\\(dq";
    default:
      return {};
  }
}

}  // namespace

std::string roff(std::string_view text) {
  std::string out;
  bool bold = false;
  if (!text.empty() && (text.front() == '.' || text.front() == '\'')) {
    out += "\\&";  // else a request
  }
  for (const char sign : text) {
    if (sign == '`') {
      bold = !bold;
      out += bold ? "\\fB" : "\\fR";
    } else if (const std::string_view instead = escaped(sign); !instead.empty()) {
      out += instead;
    } else {
      out += sign;
    }
  }
  return out;
}

std::string heading(std::string_view text) {
  return ".SH \"" + roff(text) + "\"\n";
}

std::string subheading(std::string_view text) {
  return ".SS \"" + roff(text) + "\"\n";
}

std::string tagged(std::string_view tag, std::string_view text) {
  return ".TP\n\\fB" + roff(tag) + "\\fR\n" + roff(text) + "\n";
}

}  // namespace gateway::manual

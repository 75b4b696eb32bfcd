#include "config/schema/form.h"
#include "config/text.h"
#include "config/toml/document.h"

// What the machine has: sizes of files, and paths.

namespace config {

Form<std::uint64_t> size(std::uint64_t min, std::uint64_t max) {
  const std::string allowed = size_text(min) + ".." + size_text(max);
  return {.type = "size " + allowed,
          .read = [=](const Node& node, const Complaint& complain) -> std::optional<std::uint64_t> {
            if (node.kind != NodeKind::text) {
              complain.value(node.place,
                             "must be a size with its unit, such as \"50MB\", not " + std::string(name_of(node.kind)));
              return std::nullopt;
            }
            const auto value = parse_size(node.text);
            if (!value.has_value()) {
              complain.value(node.place, in_quotes(node.text) +
                                             " is no size; write a number of whole bytes with B, kB, MB or GB, such as "
                                             "\"50MB\"");
            } else if (*value < min || *value > max) {
              complain.value(node.place, in_quotes(node.text) + " is out of range " + allowed);
            } else {
              return value;
            }
            return std::nullopt;
          },
          .show = [](const std::uint64_t& value) { return size_text(value); }};
}

Form<std::string> absolute_path(PathRule rule) {
  return {.type = "absolute path",
          .read = [rule](const Node& node, const Complaint& complain) -> std::optional<std::string> {
            if (!expect(node, NodeKind::text, complain)) {
              return std::nullopt;
            }
            const std::string& path = node.text;
            if (path.empty() && rule.may_be_empty) {
              return path;
            }
            if (!path.starts_with('/')) {
              complain.value(node.place, in_quotes(path) + " must be an absolute path, beginning with '/'" +
                                             (rule.may_be_empty ? ", or empty" : ""));
            } else if (path.size() > rule.longest) {
              complain.value(node.place, in_quotes(path) + " has " + std::to_string(path.size()) + " bytes; at most " +
                                             std::to_string(rule.longest) + " are possible" +
                                             std::string(rule.why_no_longer));
            } else if (!is_plain_text(path)) {
              complain.value(node.place, in_quotes(path) + " must have no control characters");
            } else {
              return path;
            }
            return std::nullopt;
          },
          .show = [](const std::string& path) { return path; }};
}

}  // namespace config

#include "config/schema/complaint.h"

namespace config {
namespace {

constexpr std::size_t kLongestShown = 80;

}  // namespace

Complaint Complaint::at(std::string_view key) const {
  Complaint below = *this;
  const std::string shown(key.substr(0, kLongestShown));
  below.path_ += (path_.empty() ? "" : ".") + shown;
  below.heading_ += (heading_.empty() ? "" : ".") + shown;
  return below;
}

Complaint Complaint::within(std::string_view label) const {
  Complaint inside = *this;
  inside.where_ += (where_.empty() ? "" : ": ") + path_ + " " + std::string(label);
  inside.path_.clear();
  return inside;
}

std::string in_quotes(std::string_view text) {
  return "\"" + std::string(text.substr(0, kLongestShown)) + (text.size() > kLongestShown ? "…\"" : "\"");
}

}  // namespace config

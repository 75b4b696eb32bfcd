#include "bridges/trace/filter.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "canopen/hex.h"
#include "config/model.h"

namespace trace {
namespace {

using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

std::vector<std::string_view> split(std::string_view list) {
  std::vector<std::string_view> items;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    if (end > 0) {
      items.push_back(list.substr(0, end));
    }
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return items;
}

template <class Items>
std::string names_in(const Items& items) {
  std::string text;
  for (const auto& item : items) {
    text.append(text.empty() ? "" : ", ").append(item.name);
  }
  return text;
}

Error unknown(std::string_view what, std::string_view written, const std::string& known) {
  constexpr std::size_t kShown = 40;
  return {
      .kind = ErrorKind::unknown,
      .detail = "no " + std::string(what) + " \"" + std::string(written.substr(0, kShown)) + "\"; there are " + known};
}

template <class Items>
bool mark(const Items& items, std::string_view name, std::vector<bool>& marks) {
  const auto found = std::ranges::find(items, name, [](const auto& item) { return std::string_view(item.name); });
  if (found == items.end()) {
    return false;
  }
  marks.at(static_cast<std::size_t>(found - items.begin())) = true;
  return true;
}

std::optional<Error> take_names(const config::Model& model, std::string_view names, Filter& filter) {
  const std::vector<std::string_view> wanted = split(names);
  if (wanted.empty()) {
    return std::nullopt;
  }
  filter.drives.assign(model.drives.size(), false);
  filter.buses.assign(model.buses.size(), false);
  filter.by_name = true;
  for (const std::string_view name : wanted) {
    const bool is_drive = mark(model.drives, name, filter.drives);
    const bool is_bus = mark(model.buses, name, filter.buses);
    if (!is_drive && !is_bus) {
      return unknown("drive or bus", name, names_in(model.drives) + ", and the buses " + names_in(model.buses));
    }
  }
  return std::nullopt;
}

std::optional<Error> take_kinds(std::string_view kinds, Filter& filter) {
  const std::vector<std::string_view> wanted = split(kinds);
  unsigned mask = 0;
  for (const std::string_view name : wanted) {
    const std::optional<Kind> kind = parse_kind(name);
    if (!kind) {
      return unknown("kind of frames", name, std::string(kind_names()));
    }
    mask |= 1U << static_cast<unsigned>(*kind);
  }
  filter.kinds = wanted.empty() ? filter.kinds : static_cast<std::uint8_t>(mask);
  return std::nullopt;
}

std::optional<Error> take_cob_ids(std::string_view cob_ids, Filter& filter) {
  for (const std::string_view text : split(cob_ids)) {
    const std::string_view digits = text.starts_with("0x") || text.starts_with("0X") ? text.substr(2) : text;
    std::uint32_t id = 0;
    const auto [end, failed] = std::from_chars(digits.data(), digits.data() + digits.size(), id, 16);
    if (failed != std::errc{} || end != digits.data() + digits.size() || id > canopen::kMaxCobId) {
      return unknown("COB-ID", text, "0x000 to 0x" + canopen::hex(canopen::kMaxCobId, 3));
    }
    if (!filter.cob_ids) {
      filter.cob_ids.emplace();
    }
    filter.cob_ids->set(id);
  }
  return std::nullopt;
}

// A filter that was made just before the configuration changed may be of another length.
bool is_marked(const std::vector<bool>& marks, std::size_t position) {
  return position < marks.size() && marks[position];
}

template <class Named>
std::vector<bool> moved_marks(const std::vector<bool>& marks, const std::vector<Named>& before,
                              const std::vector<Named>& now) {
  std::vector<bool> moved;
  for (const Named& one : now) {
    const auto was_at = config::find_named(before, one.name);
    moved.push_back(was_at && is_marked(marks, *was_at));
  }
  return moved;
}

bool has_kind(const Filter& filter, const Entry& entry) {
  return (filter.kinds >> static_cast<unsigned>(entry.kind) & 1U) != 0;
}

bool has_cob_id(const Filter& filter, const Entry& entry) {
  return !filter.cob_ids || (!entry.frame.error && !entry.frame.extended && entry.frame.id <= canopen::kMaxCobId &&
                             filter.cob_ids->test(entry.frame.id));
}

bool is_of_drive(const config::Model& model, const Filter& filter, const Entry& entry) {
  if (entry.drive) {
    return is_marked(filter.drives, *entry.drive);
  }
  if (entry.lost == 0 && !(entry.kind == Kind::nmt && entry.node == 0)) {
    return false;
  }
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    if (is_marked(filter.drives, i) && entry.bus && model.drives.at(i).bus == *entry.bus) {
      return true;
    }
  }
  return false;
}

}  // namespace

Result<Filter> make_filter(const config::Model& model, const FilterWords& words) {
  Filter filter;
  if (const auto wrong = take_names(model, words.names, filter)) {
    return *wrong;
  }
  if (const auto wrong = take_kinds(words.kinds, filter)) {
    return *wrong;
  }
  if (const auto wrong = take_cob_ids(words.cob_ids, filter)) {
    return *wrong;
  }
  return filter;
}

Filter moved(Filter filter, const config::Model& before, const config::Model& now) {
  if (filter.by_name) {
    filter.drives = moved_marks(filter.drives, before.drives, now.drives);
    filter.buses = moved_marks(filter.buses, before.buses, now.buses);
  }
  return filter;
}

bool passes(const config::Model& model, const Filter& filter, const Entry& entry) {
  if (entry.gone || (entry.lost == 0 && (!has_kind(filter, entry) || !has_cob_id(filter, entry)))) {
    return false;
  }
  return !filter.by_name || (entry.bus && is_marked(filter.buses, *entry.bus)) || is_of_drive(model, filter, entry);
}

}  // namespace trace

#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "config/schema/complaint.h"
#include "config/schema/form.h"
#include "config/toml/document.h"

// The one description of every key: its name, the member of a plain struct that it fills, how its value is written, and
// what it means. Check, reading, default, layers and the tables of the manual all come of it.

namespace config {

class Section;

/// What becomes of a key's value where one layer is laid over another.
enum class Layering : std::uint8_t {
  replace,  ///< The upper one alone counts.
  table,    ///< Key by key, after the section below.
  by_name,  ///< A table of tables: name by name, each like `table`.
  by_key,   ///< Tables of plain values: key by key, and so are tables in them.
  append    ///< A list: the upper one's items after the lower one's.
};

struct Key {
  std::string name;  ///< Ending in `N`, as in tpdoN: any number from 1 to 512 there.
  std::string type;
  std::string standard;  ///< The default as the manual has it; empty: none.
  std::string meaning;
  bool required = false;
  std::string unless{};  ///< Of a required one: the key that stands for it.
  bool built = true;     ///< False: for a later version; refused wherever it stands.
  Layering layering = Layering::replace;
  const Section* below = nullptr;  ///< Of tables: their keys.
  std::function<void(const Node&, const Complaint&)> check{};
};

/// The keys of one table.
class Section {
 public:
  Section(std::string title, std::vector<Key> keys, const Section* also = nullptr)
      : title_(std::move(title)), keys_(std::move(keys)), also_(also) {}

  [[nodiscard]] const std::string& title() const noexcept { return title_; }  ///< Heading of the manual: `[[bus]]`.
  [[nodiscard]] const std::vector<Key>& keys() const noexcept { return keys_; }
  [[nodiscard]] const Section* also() const noexcept { return also_; }  ///< Further keys, those of this section.
  /// The key of that name here or in also(); null where there is none.
  [[nodiscard]] const Key* find(std::string_view name) const noexcept;

 private:
  std::string title_;
  std::vector<Key> keys_;
  const Section* also_;
};

/// Complains of unknown, missing and unbuilt keys, and of values that are not written as their key says. What one key
/// means beside another is for those who read them.
void check_table(const Node& table, const Section& section, const Complaint& complain);
/// Each table of a list of them; their findings begin with `drive "pump1"`.
void check_tables(const Node& list, const Section& section, const Complaint& complain);
/// Each table of a table of them, and their names.
void check_named(const Node& table, const Section& section, bool (*good_name)(std::string_view), std::string_view rule,
                 const Complaint& complain);

/// A table that was read, with its name and where it stands.
template <class S>
struct Said {
  std::string name;  ///< The key that it stands under.
  Place place;       ///< Of that name.
  const Node* table = nullptr;
  S keys{};
};

namespace detail {

template <class M, class T>
void assign(M& member, T value) {
  if constexpr (std::is_arithmetic_v<M> && std::is_arithmetic_v<T>) {
    member = static_cast<M>(value);  // its form keeps it in range
  } else {
    member = std::move(value);
  }
}
template <class M>
void assign(std::optional<M>& member, std::int64_t value) {
  member = static_cast<M>(value);
}

template <class T, class M>
std::string shown(const Form<T>& form, const M& member) {
  if constexpr (std::is_convertible_v<M, T>) {
    return form.show ? form.show(static_cast<T>(member)) : "";
  } else {
    return "";  // an optional one, which is empty by default
  }
}

}  // namespace detail

/// A key and the member of S that it fills.
template <class S>
class KeyOf {
 public:
  /// `member`: a pointer to a member, or a callable that takes an S and gives a reference.
  template <class Member, class T>
  KeyOf(std::string_view name, Member member, Form<T> form, std::string_view meaning)
      : key_{.name = std::string(name), .type = form.type, .standard = {}, .meaning = std::string(meaning)} {
    const S fresh{};
    key_.standard = detail::shown(form, std::invoke(member, fresh));
    key_.check = checked(name, form, meaning).key_.check;
    fill = [member, read = form.read](const Entry& entry, S& into) {
      if (auto value = read(entry.value, Complaint::silent()); value.has_value()) {
        detail::assign(std::invoke(member, into), *std::move(value));
      }
    };
  }

  /// One that is only checked: what it says is put together elsewhere.
  template <class T>
  static KeyOf checked(std::string_view name, const Form<T>& form, std::string_view meaning) {
    return checked(
        name, form.type, Layering::replace, nullptr,
        [read = form.read](const Node& node, const Complaint& complain) { (void)read(node, complain); }, meaning);
  }
  static KeyOf checked(std::string_view name, std::string_view type, Layering layering, const Section* below,
                       std::function<void(const Node&, const Complaint&)> check, std::string_view meaning) {
    return KeyOf({.name = std::string(name),
                  .type = std::string(type),
                  .standard = {},
                  .meaning = std::string(meaning),
                  .layering = layering,
                  .below = below,
                  .check = std::move(check)});
  }
  /// A table, or a list of them; likewise.
  static KeyOf table(std::string_view name, const Section& below, std::string_view meaning) {
    return checked(
        name, "table", Layering::table, &below,
        [&below](const Node& node, const Complaint& complain) { check_table(node, below, complain); }, meaning);
  }
  static KeyOf tables(std::string_view name, const Section& below, std::string_view meaning) {
    return checked(
        name, "tables", Layering::append, &below,
        [&below](const Node& node, const Complaint& complain) { check_tables(node, below, complain); }, meaning);
  }
  /// One that no code serves yet. `standard`: the default that it will have.
  static KeyOf later(std::string_view name, std::string_view type, std::string_view standard, std::string_view meaning,
                     const Section* below = nullptr) {
    KeyOf key({.name = std::string(name),
               .type = std::string(type),
               .standard = std::string(standard),
               .meaning = std::string(meaning),
               .built = false});
    key.key_.below = below;
    return key;
  }

  /// `unless`: a key that may stand for it.
  [[nodiscard]] KeyOf required(std::string_view unless = {}) && {
    key_.required = true;
    key_.unless = unless;
    key_.standard.clear();
    return std::move(*this);
  }
  /// A list that must hold something.
  [[nodiscard]] KeyOf filled() && {
    key_.check = [check = std::move(key_.check), tables = key_.type == "tables"](const Node& node,
                                                                                 const Complaint& complain) {
      check(node, complain);
      if (node.kind == NodeKind::list && node.items.empty()) {
        complain.value(node.place, "is empty; write at least one" + (tables ? " [[" + complain.path() + "]]" : ""));
      }
    };
    return std::move(*this);
  }
  /// Words of the manual where leaving the key out means more than a value.
  [[nodiscard]] KeyOf unset(std::string_view words) && {
    key_.standard = words;
    return std::move(*this);
  }
  /// A word behind the default: `[]: nobody`.
  [[nodiscard]] KeyOf note(std::string_view words) && {
    key_.standard += ": " + std::string(words);
    return std::move(*this);
  }
  [[nodiscard]] KeyOf layered(Layering layering) && {
    key_.layering = layering;
    return std::move(*this);
  }

  [[nodiscard]] const Key& key() const noexcept { return key_; }

  std::function<void(const Entry&, S&)> fill{};  ///< Nothing where the value is wrong, or only checked.

 private:
  explicit KeyOf(Key key) : key_(std::move(key)) {}

  Key key_;
};

/// A section that fills an S.
template <class S>
class SectionOf : public Section {
 public:
  SectionOf(std::string title, const std::vector<KeyOf<S>>& keys, const Section* also = nullptr)
      : Section(std::move(title), plain(keys), also) {
    for (const KeyOf<S>& key : keys) {
      fill_.push_back(key.fill);
    }
  }

  /// What a checked table says; members whose key is missing, wrong or not built keep their default.
  [[nodiscard]] S read(const Node& table) const {
    S said{};
    for (const Entry& entry : table.entries) {
      const Key* const key = find(entry.key);
      const bool own = key != nullptr && key >= keys().data() && key < keys().data() + keys().size();
      if (own && fill_[static_cast<std::size_t>(key - keys().data())]) {
        fill_[static_cast<std::size_t>(key - keys().data())](entry, said);
      }
    }
    return said;
  }

 private:
  static std::vector<Key> plain(const std::vector<KeyOf<S>>& keys) {
    std::vector<Key> all;
    for (const KeyOf<S>& key : keys) {
      all.push_back(key.key());
    }
    return all;
  }

  std::vector<std::function<void(const Entry&, S&)>> fill_;
};

/// A key whose value is a table that fills a member, or adds a Said to one that is a list.
template <class S, class Member, class T>
[[nodiscard]] KeyOf<S> table_key(std::string_view name, Member member, const SectionOf<T>& section,
                                 std::string_view meaning) {
  auto key = KeyOf<S>::table(name, section, meaning);
  key.fill = [member, &section](const Entry& entry, S& into) {
    auto& target = std::invoke(member, into);
    if (entry.value.kind != NodeKind::table) {
      return;
    }
    if constexpr (std::is_same_v<std::remove_reference_t<decltype(target)>, std::vector<Said<T>>>) {
      target.push_back({entry.key, entry.key_place, &entry.value, section.read(entry.value)});
    } else {
      target = section.read(entry.value);
    }
  };
  return key;
}

/// A key whose value is a table of named tables; only checked, and laid over each other name by name.
template <class S>
[[nodiscard]] KeyOf<S> named_key(std::string_view name, const Section& section, bool (*good_name)(std::string_view),
                                 std::string_view rule, std::string_view meaning) {
  return KeyOf<S>::checked(
      name, "tables by name", Layering::by_name, &section,
      [&section, good_name, rule](const Node& node, const Complaint& complain) {
        check_named(node, section, good_name, rule, complain);
      },
      meaning);
}

/// A key whose value is a list of tables, each a Said of a list.
template <class S, class Member, class T>
[[nodiscard]] KeyOf<S> tables_key(std::string_view name, Member member, const SectionOf<T>& section,
                                  std::string_view meaning) {
  auto key = KeyOf<S>::tables(name, section, meaning);
  key.fill = [member, &section](const Entry& entry, S& into) {
    for (const Node& item : entry.value.items) {
      if (item.kind == NodeKind::table) {
        std::invoke(member, into).push_back({entry.key, item.place, &item, section.read(item)});
      }
    }
  };
  return key;
}

/// All keys of these sections and of those below them, as Markdown tables.
[[nodiscard]] std::string render_reference(const std::vector<const Section*>& sections);

}  // namespace config

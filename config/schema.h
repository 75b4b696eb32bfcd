#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

// Every key that a configuration or a profile may hold, in one set of tables. They drive the check of a file, the
// nearest-key suggestion and the reference in docs/CONFIGURATION.md.

namespace config {

enum class KeyKind : std::uint8_t {
  boolean,
  integer,   ///< min..max
  number,    ///< An integer or a number, finite.
  text,      ///< Free text without control characters.
  name,      ///< [A-Za-z0-9_-]{1,32}
  duration,  ///< A string with unit, min..max in nanoseconds.
  choice,    ///< One of `choices`.
  object,    ///< "0x2021:02"
  type,      ///< "u16"
  cob_id,    ///< A number, or "$NODEID+0x180"
  unit,      ///< 1..247 or "none"
  texts,     ///< A list of strings.
  choices,   ///< A list of `choices`.
  integers,  ///< A list of integers min..max.
  mapping,   ///< A list of "0x2021:02 u16".
  table,     ///< A table of `section`.
  tables,    ///< A list of tables of `section`.
  signals,   ///< A table of signal name -> table of `section`.
  presets,   ///< A table of any name -> table of `section`.
  numbered,  ///< A table of number -> string.
  faults     ///< A table of number -> string, or {text, severity}.
};

enum class Support : std::uint8_t {
  built,
  default_only,  ///< Any other value than the default is for a later version.
  none           ///< The key is for a later version.
};

struct Section;

struct Key {
  std::string_view name;  ///< Ending in `N`, as in tpdoN: any number from 1 to 512 there.
  KeyKind kind = KeyKind::text;
  std::string_view standard{};  ///< The default, as the reference shows it; empty: none.
  std::string_view meaning{};
  std::int64_t min = 0;
  std::int64_t max = 0;
  std::string_view choices{};  ///< Parted by `|`.
  const Section* section = nullptr;
  bool required = false;
  Support support = Support::built;
};

struct Section {
  std::string_view title;  ///< Heading of the reference: `[[bus]]`.
  std::span<const Key> keys;
  const Section* also = nullptr;  ///< Further keys, those of this section.
};

extern const Section kSiteSection;     ///< The gateway's own file.
extern const Section kDriveSection;    ///< One `[[drive]]` of it.
extern const Section kProfileSection;  ///< A profile's file.
extern const Section kOverlaySection;  ///< What a profile, a preset and a drive can all say: signals, PDOs, ….
extern const Section kSignalSection;   ///< A signal.

/// The key of that name in a section; null where there is none.
[[nodiscard]] const Key* find_key(const Section& section, std::string_view name) noexcept;

/// All keys as Markdown tables.
[[nodiscard]] std::string render_reference();

}  // namespace config

#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/toml/document.h"
#include "config/toml/report.h"

namespace config {

/// A profile, laid over those it extends.
struct Profile {
  std::string name;
  Node table;
  bool partial = false;  ///< Only to be extended.
};

/// Finds profiles by name, checks each file once, and keeps what it read. For one load: places count the files of its
/// Report.
class ProfileLibrary {
 public:
  /// The first directory that has an entry NAME.toml wins, whether it can be read or not: a profile of the site is
  /// never passed over for a shipped one.
  explicit ProfileLibrary(std::vector<std::filesystem::path> directories);

  /// Puts a text before all files of that name.
  void add(std::string name, std::string text);

  /// Null where there is none or it cannot be read; `asked` is where its name stands, `where` begins the finding then.
  const Profile* find(std::string_view name, Place asked, std::string_view where, Report& report);

  /// Names of all profiles to be found, in order.
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  struct Source {
    std::string file;
    std::string text;
  };
  const Profile* load(const std::string& name, Place asked, std::string_view where, Report& report, int depth);
  std::optional<Profile> read(const std::string& name, Place asked, std::string_view where, Report& report, int depth);
  [[nodiscard]] std::optional<Source> text_of(const std::string& name, Place asked, const std::string& prefix,
                                              Report& report) const;

  std::vector<std::filesystem::path> directories_;
  std::map<std::string, std::string, std::less<>> texts_;
  std::map<std::string, Profile, std::less<>> known_;
};

}  // namespace config

#include "config/drive/profile.h"

#include <algorithm>
#include <functional>
#include <set>
#include <system_error>
#include <utility>
#include <variant>

#include "config/drive/drive_keys.h"
#include "config/schema/merge.h"
#include "config/schema/nearest.h"
#include "config/text.h"
#include "config/toml/document.h"
#include "config/toml/files.h"

namespace config {
namespace {

// A chain of profiles longer than this goes in a circle, or should.
constexpr int kLongestChain = 8;

}  // namespace

ProfileLibrary::ProfileLibrary(std::vector<std::filesystem::path> directories) : directories_(std::move(directories)) {}

void ProfileLibrary::add(std::string name, std::string text) {
  texts_.insert_or_assign(std::move(name), std::move(text));
}

std::vector<std::string> ProfileLibrary::names() const {
  std::set<std::string> names;
  for (const auto& [name, text] : texts_) {
    names.insert(name);
  }
  for (const auto& directory : directories_) {
    std::error_code error;
    for (std::filesystem::directory_iterator at(directory, error), end; !error && at != end; at.increment(error)) {
      if (at->path().extension() == ".toml") {
        names.insert(at->path().stem().string());
      }
    }
  }
  return {names.begin(), names.end()};
}

const Profile* ProfileLibrary::find(std::string_view name, Place asked, std::string_view where, Report& report) {
  return load(std::string(name), asked, where, report, 0);
}

const Profile* ProfileLibrary::load(const std::string& name, Place asked, std::string_view where, Report& report,
                                    int depth) {
  if (const auto found = known_.find(name); found != known_.end()) {
    return &found->second;
  }
  // A failure is not kept: each drive that asks for the profile gets its finding.
  auto profile = read(name, asked, where, report, depth);
  return profile.has_value() ? &known_.emplace(name, *std::move(profile)).first->second : nullptr;
}

std::optional<ProfileLibrary::Source> ProfileLibrary::text_of(const std::string& name, Place asked,
                                                              const std::string& prefix, Report& report) const {
  if (const auto given = texts_.find(name); given != texts_.end()) {
    return Source{.file = name + ".toml", .text = given->second};
  }
  for (const auto& directory : directories_) {
    const auto path = directory / (name + ".toml");
    if (is_absent(path)) {
      continue;
    }
    auto content = read_file(path);
    if (const auto* failure = std::get_if<FileFailure>(&content); failure != nullptr) {
      report.error(asked, prefix + " cannot be read from " + path.string() + ": " + failure->reason);
      return std::nullopt;
    }
    return Source{.file = path.string(), .text = std::get<std::string>(std::move(content))};
  }
  const auto all = names();
  const std::vector<std::string_view> views(all.begin(), all.end());
  report.error(asked,
               prefix + " is not known; " +
                   (all.empty() ? "no profile was found at all, see --profile-dir" : nearest_or_all(name, views)));
  return std::nullopt;
}

std::optional<Profile> ProfileLibrary::read(const std::string& name, Place asked, std::string_view where,
                                            Report& report, int depth) {
  const std::string prefix = std::string(where) + ": profile \"" + name + "\"";
  if (depth >= kLongestChain) {
    report.error(asked, prefix + " extends itself, or a chain of too many profiles");
    return std::nullopt;
  }
  const auto source = text_of(name, asked, prefix, report);
  if (!source.has_value()) {
    return std::nullopt;
  }
  auto parsed = parse_toml(source->text, report.add_file(source->file));
  if (const auto* failure = std::get_if<ParseFailure>(&parsed); failure != nullptr) {
    report.error(failure->place, failure->text);
    return std::nullopt;
  }
  Profile profile{.name = name, .table = std::get<Node>(std::move(parsed))};
  const std::string label = "profile \"" + name + "\"";
  check_table(profile.table, profile_section(), Complaint(label, report));
  const ProfileKeys keys = profile_section().read(profile.table);
  profile.partial = keys.partial;
  const Place extends = place_of(profile.table, "extends");
  // Both are said of this file only.
  std::erase_if(profile.table.entries,
                [](const Entry& entry) { return entry.key == "extends" || entry.key == "partial"; });
  if (keys.extends.has_value()) {
    const Profile* const parent = load(*keys.extends, extends, label, report, depth + 1);
    if (parent == nullptr) {
      return std::nullopt;
    }
    Node merged = parent->table;
    lay_over(merged, profile.table, profile_section());
    merged.place = profile.table.place;
    profile.table = std::move(merged);
  }
  return profile;
}

}  // namespace config

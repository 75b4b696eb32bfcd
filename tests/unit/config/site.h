#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "config/drive/profile.h"
#include "config/load.h"

// What the tests of the loader share: small sites as text, with the shipped profiles and one of the test's own.

namespace config {

inline const std::string kProfiles = GATEWAY_SOURCE_DIR "/config/profiles";

/// A bus, one drive, and nothing else.
inline const std::string kBus = "[[bus]]\nname = \"can0\"\n";
inline const std::string kDrive = "[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"veichi-ac310\"\n";

inline Loaded load_site(std::string_view text, std::string_view own_profile = "") {
  ProfileLibrary library({kProfiles});
  if (!own_profile.empty()) {
    library.add("own", std::string(own_profile));
  }
  return load_text(text, {.file = "gateway.toml", .profile_dirs = {}, .host_name = "host"}, library);
}

/// The findings as they are printed, one a line.
inline std::string lines(const Findings& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    text += to_string(finding) + "\n";
  }
  return text;
}

inline std::vector<std::string> errors_of(const Loaded& loaded) {
  std::vector<std::string> texts;
  for (const Finding& finding : loaded.findings) {
    if (finding.level == Finding::Level::error) {
      texts.push_back(to_string(finding));
    }
  }
  return texts;
}

inline std::vector<std::string> warnings_of(const Loaded& loaded) {
  std::vector<std::string> texts;
  for (const Finding& finding : loaded.findings) {
    if (finding.level == Finding::Level::warning) {
      texts.push_back(to_string(finding));
    }
  }
  return texts;
}

/// The model of a site that must be good.
inline Model model_of(std::string_view text, std::string_view own_profile = "") {
  const Loaded loaded = load_site(text, own_profile);
  EXPECT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  return loaded.model.value_or(Model{});
}

/// The only error of a site.
inline std::string error_of(std::string_view text, std::string_view own_profile = "") {
  const Loaded loaded = load_site(text, own_profile);
  EXPECT_FALSE(loaded.model.has_value());
  const auto errors = errors_of(loaded);
  EXPECT_EQ(errors.size(), 1U) << lines(loaded.findings);
  return errors.empty() ? "" : errors.front();
}

inline const Signal& signal_of(const Drive& drive, std::string_view name) {
  const auto at = drive.find(name);
  static const Signal none;
  EXPECT_TRUE(at.has_value()) << name;
  return at.has_value() ? drive.signals[*at] : none;
}

/// Drive `a` with the profile `own`, and `more` in its table.
inline std::string own_site(std::string_view more) {
  return kBus + "[[drive]]\nname = \"a\"\nnode = 1\nprofile = \"own\"\n" + std::string(more);
}

}  // namespace config

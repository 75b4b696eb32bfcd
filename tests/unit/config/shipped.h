#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/unit/config/site.h"

// The profiles as they are installed, and the manuals' tables in data/.

namespace config {

inline Loaded load_drive(const std::string& profile, const std::string& more = "") {
  return load_site(kBus + "[[drive]]\nname = \"a\"\nnode = 5\nprofile = \"" + profile + "\"\n" + more);
}

inline Drive drive_of(const std::string& profile, const std::string& more = "") {
  const Loaded loaded = load_drive(profile, more);
  EXPECT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  return loaded.model.has_value() ? loaded.model->drives.at(0) : Drive{};
}

/// The rows of a table of the manuals, without its heading. Texts in it hold no quoted commas but in the last column.
inline std::vector<std::vector<std::string>> rows_of(const std::string& name) {
  std::ifstream in(GATEWAY_SOURCE_DIR "/tests/unit/config/data/" + name);
  EXPECT_TRUE(in.good()) << name;
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> row;
    std::stringstream cells(line);
    std::string cell;
    while (std::getline(cells, cell, ',')) {
      row.push_back(cell);
    }
    rows.push_back(row);
  }
  EXPECT_GT(rows.size(), 20U) << name;
  return rows;
}

inline std::uint64_t hex(const std::string& text) {
  return std::stoull(text, nullptr, 16);
}

}  // namespace config

#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "config/drive_notes.h"
#include "config/model.h"
#include "config/toml/report.h"

namespace config {

class ProfileLibrary;

struct LoadOptions {
  std::filesystem::path file;
  /// Searched in this order; the first that holds NAME.toml wins.
  std::vector<std::filesystem::path> profile_dirs;
  std::string host_name;      ///< The gateway's name where the file gives none.
  bool with_secrets = false;  ///< Read the file of the password; else only its size and mode are looked at.
};

struct Loaded {
  std::optional<Model> model;       ///< Present where no finding is an error.
  Findings findings;                ///< All of them, in order of place.
  std::vector<DriveNotes> notes{};  ///< Of the model's drives, in their order.
};

[[nodiscard]] Loaded load(const LoadOptions& options);
/// The same from text; `options.file` only names it in findings.
[[nodiscard]] Loaded load_text(std::string_view text, const LoadOptions& options);

/// The same with the profiles of `library`.
[[nodiscard]] Loaded load_text(std::string_view text, const LoadOptions& options, ProfileLibrary& library);

/// `ok: 1 bus, 4 drives, 52 signals`
[[nodiscard]] std::string summary(const Model& model);

}  // namespace config

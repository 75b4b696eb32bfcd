#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "config/model.h"
#include "daemon/doctor/line.h"
#include "daemon/doctor/service_user.h"

namespace gateway::doctor {

/// What the service has to do with a file.
struct Wanted {
  enum class Use : std::uint8_t {
    read,
    search,  ///< A directory whose files are read.
    keep,    ///< A directory that files are written to.
    handed,  ///< A file that systemd may hand over instead (LoadCredential=).
    secret   ///< Such a file, and nobody else may read it.
  };
  std::filesystem::path path;
  Use use = Use::read;
  friend bool operator==(const Wanted&, const Wanted&) = default;
};

/// Configuration, directories and files of profiles, secrets, and where state is kept.
[[nodiscard]] std::vector<Wanted> wanted_files(const config::Model& model, const std::filesystem::path& config,
                                               const std::vector<std::filesystem::path>& profile_dirs);

/// As whom they were tried, and what the system said to each.
struct FileFacts {
  std::string user;
  bool is_service_user = false;
  std::vector<int> errors;  ///< errno of each, in their order; 0: it may.
};

/// As the service's user where this program is root and the machine has that user, else as who runs it. A process of
/// its own takes that user's place for a moment.
[[nodiscard]] FileFacts try_files(const std::vector<Wanted>& wanted);
[[nodiscard]] Lines judge(const std::vector<Wanted>& wanted, const FileFacts& facts);
/// One of `files` is not there, and may be a credential that only the service sees.
[[nodiscard]] bool lacks_credential(const std::vector<Wanted>& wanted, const FileFacts& facts,
                                    const std::vector<std::string>& files);

}  // namespace gateway::doctor

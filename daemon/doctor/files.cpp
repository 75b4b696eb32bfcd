#include "daemon/doctor/files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

#include "daemon/control/accounts.h"

namespace gateway::doctor {
namespace {

namespace fs = std::filesystem;
using Use = Wanted::Use;

int mode_of(Use use) noexcept {
  switch (use) {
    case Use::read:
    case Use::handed:
    case Use::secret:
      return R_OK;
    case Use::search:
      return R_OK | X_OK;
    case Use::keep:
      break;
  }
  return R_OK | W_OK | X_OK;
}

int try_to_use(const Wanted& wanted) {
  return ::access(wanted.path.c_str(), mode_of(wanted.use)) == 0 ? 0 : errno;
}

// access(2) asks for the real user, and who has given up root does not get it back: so a child does it.
std::vector<int> try_as_service_user(const std::vector<Wanted>& wanted) {
  std::vector<int> errors;
  for (const Wanted& each : wanted) {
    const std::optional<int> error = as_service_user([&each] { return try_to_use(each); });
    if (!error) {
      break;
    }
    errors.push_back(*error);
  }
  return errors;
}

std::string remedy(const Wanted& wanted, int error, const std::string& user) {
  const std::string path = wanted.path.string();
  if (error == ENOENT) {
    return wanted.use == Use::keep
               ? fmt::format("`install -d -m 750 -o {} -g {} {}`; the unit does it for /var/lib/canopen-gateway", user,
                             user, path)
               : "put it there, or name the right one";
  }
  if (error == EROFS) {
    return "choose a place on a file system that can be written";
  }
  if (wanted.use == Use::keep) {
    return fmt::format("`chown {} {}`, and let that user through all directories above it", user, path);
  }
  if (wanted.use == Use::secret) {
    return fmt::format(
        "`chown {} {}` and `chmod 600 {}`, and let that user through all directories above it; or let systemd hand it "
        "over (LoadCredential=). Not by its group: people join that to command",
        user, path, path);
  }
  return fmt::format("`chgrp {} {}` and `chmod g+r{} {}`, and let that user through all directories above it", user,
                     path, wanted.use == Use::search ? "x" : "", path);
}

// One that is absent and has an absolute name is an error of the configuration, which is then not looked at any
// further.
bool may_be_credential(Use use, int error) noexcept {
  return (use == Use::secret || use == Use::handed) && error == ENOENT;
}

void add_profiles(std::vector<Wanted>& wanted, const fs::path& directory) {
  std::error_code failed;
  if (!fs::is_directory(directory, failed)) {
    return;  // Each of them may be missing.
  }
  wanted.push_back({directory, Use::search});
  for (fs::directory_iterator each(directory, failed), end; !failed && each != end; each.increment(failed)) {
    if (each->path().extension() == ".toml") {
      wanted.push_back({each->path(), Use::read});
    }
  }
}

}  // namespace

std::vector<Wanted> wanted_files(const config::Model& model, const fs::path& config,
                                 const std::vector<fs::path>& profile_dirs) {
  std::vector<Wanted> wanted{{config, Use::read}};
  for (const fs::path& directory : profile_dirs) {
    add_profiles(wanted, directory);
  }
  if (!model.gateway.state_dir.empty()) {
    wanted.push_back({model.gateway.state_dir, Use::keep});
  }
  if (model.mqtt) {
    const std::array<Wanted, 4> files{{{model.mqtt->password_file, Use::secret},
                                       {model.mqtt->ca_file, Use::handed},
                                       {model.mqtt->cert_file, Use::handed},
                                       {model.mqtt->key_file, Use::secret}}};
    std::ranges::copy_if(files, std::back_inserter(wanted), [](const Wanted& each) { return !each.path.empty(); });
  }
  return wanted;
}

FileFacts try_files(const std::vector<Wanted>& wanted) {
  if (is_service_user_known()) {
    return {.user = kServiceUser, .is_service_user = true, .errors = try_as_service_user(wanted)};
  }
  const std::string name = control::name_of_user(::geteuid());
  std::vector<int> errors;
  std::ranges::transform(wanted, std::back_inserter(errors), try_to_use);
  return {.user = name, .is_service_user = name == kServiceUser, .errors = std::move(errors)};
}

bool lacks_credential(const std::vector<Wanted>& wanted, const FileFacts& facts,
                      const std::vector<std::string>& files) {
  for (std::size_t i = 0; i < std::min(wanted.size(), facts.errors.size()); ++i) {
    if (may_be_credential(wanted[i].use, facts.errors[i]) &&
        std::ranges::find(files, wanted[i].path.string()) != files.end()) {
      return true;
    }
  }
  return false;
}

Lines judge(const std::vector<Wanted>& wanted, const FileFacts& facts) {
  Lines lines;
  if (facts.errors.size() != wanted.size()) {
    return {{Verdict::warning, "files", fmt::format("what {} may could not be tried", facts.user),
             "run this as root outside of a sandbox"}};
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const int error = facts.errors[i];
    if (may_be_credential(wanted[i].use, error)) {
      lines.push_back({Verdict::warning, "file " + wanted[i].path.string(),
                       "it is not beside the configuration; a credential of the service?",
                       "`systemctl show -p LoadCredential,LoadCredentialEncrypted canopen-gateway` names those that it "
                       "gets; else put it there"});
    } else if (error != 0) {
      lines.push_back({Verdict::error, "file " + wanted[i].path.string(),
                       fmt::format("{} may not {} it: {}", facts.user, wanted[i].use == Use::keep ? "write to" : "read",
                                   std::generic_category().message(error)),
                       remedy(wanted[i], error, facts.is_service_user ? facts.user : std::string(kServiceUser))});
    }
  }
  if (!facts.is_service_user) {
    lines.push_back({Verdict::warning, "files",
                     fmt::format("they were tried as {}, not as the service's user {}", facts.user, kServiceUser),
                     "run this as root on a machine with that user (the package makes it, or `systemd-sysusers`)"});
  } else if (lines.empty()) {
    lines.push_back({Verdict::ok, "files", fmt::format("{} may use all {}", facts.user, wanted.size())});
  }
  return lines;
}

}  // namespace gateway::doctor

#include "daemon/doctor/service.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>

namespace gateway::doctor {
namespace {

namespace fs = std::filesystem;
using Values = std::vector<std::string>;

constexpr const char* kService = "canopen-gateway.service";
constexpr const char* kSocket = "canopen-gateway.socket";

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// An assignment of nothing forgets those before (systemd.syntax(7)).
void take_values(const fs::path& file, std::string_view key, Values& values) {
  std::ifstream in(file);
  std::string whole;
  for (std::string line; std::getline(in, line);) {
    whole += line;
    if (whole.ends_with('\\')) {
      whole.back() = ' ';
      continue;
    }
    const auto equals = whole.find('=');
    if (equals != std::string::npos && trimmed(whole.substr(0, equals)) == key) {
      const std::string value = trimmed(whole.substr(equals + 1));
      if (value.empty()) {
        values.clear();
      } else {
        values.push_back(value);
      }
    }
    whole.clear();
  }
}

/// The unit, then its drop-ins by their names; of one name that of the first directory.
std::vector<fs::path> files_of(const std::vector<fs::path>& directories, const std::string& unit) {
  std::vector<fs::path> files;
  std::map<std::string, fs::path> drop_ins;
  std::error_code failed;
  for (const fs::path& directory : directories) {
    if (files.empty() && fs::exists(directory / unit, failed)) {
      files.push_back(directory / unit);
    }
    for (fs::directory_iterator each(directory / (unit + ".d"), failed), end; !failed && each != end;
         each.increment(failed)) {
      if (each->path().extension() == ".conf") {
        drop_ins.try_emplace(each->path().filename().string(), each->path());
      }
    }
  }
  for (const auto& [name, path] : drop_ins) {
    files.push_back(path);
  }
  return files;
}

Values values_of(const std::vector<fs::path>& files, std::string_view key) {
  Values values;
  for (const fs::path& file : files) {
    take_values(file, key, values);
  }
  return values;
}

/// All words of a list that may stand in several lines.
Values words_of(const std::vector<fs::path>& files, std::string_view key) {
  Values words;
  for (const std::string& value : values_of(files, key)) {
    std::istringstream in(value);
    for (std::string word; in >> word;) {
      words.push_back(word);
    }
  }
  return words;
}

bool is_one_of(const Values& values, std::initializer_list<std::string_view> good) {
  return !values.empty() && std::ranges::find(good, values.back()) != good.end();
}

/// Enabled for the service.
bool is_wanted(const std::vector<fs::path>& directories) {
  return std::ranges::any_of(directories, [](const fs::path& directory) {
    std::error_code failed;
    return fs::is_symlink(directory / (std::string(kService) + ".wants") / kSocket, failed);
  });
}

bool is_below(const fs::path& path, const fs::path& directory) {
  const fs::path within = path.lexically_normal().lexically_relative(directory.lexically_normal());
  return !within.empty() && *within.begin() != "..";
}

bool is_below_any(const fs::path& path, const std::vector<fs::path>& directories) {
  return std::ranges::any_of(directories, [&path](const fs::path& each) { return is_below(path, each); });
}

/// Why the service does not see what is there; nothing: it does.
std::optional<std::string> hidden_by(const ServiceFacts& service, const fs::path& path) {
  if (service.sees_no_homes && is_below_any(path, {"/home", "/root", "/run/user"})) {
    return "ProtectHome=";
  }
  if (service.has_own_tmp && is_below_any(path, {"/tmp", "/var/tmp"})) {
    return "PrivateTmp=";
  }
  return std::nullopt;
}

Line read_only(const std::string& subject, const fs::path& directory) {
  return {Verdict::warning, subject, "the service cannot write there: its unit has ProtectSystem=strict",
          fmt::format("let `systemctl edit canopen-gateway` say [Service], ReadWritePaths={}, each in a line; or leave "
                      "the key out",
                      directory.string())};
}

}  // namespace

std::vector<fs::path> unit_directories() {
  return {"/etc/systemd/system", "/run/systemd/system", "/usr/local/lib/systemd/system", "/lib/systemd/system",
          "/usr/lib/systemd/system"};
}

ServiceFacts look_at_service(const std::vector<fs::path>& directories) {
  const std::vector<fs::path> files = files_of(directories, kService);
  ServiceFacts facts;
  facts.installed = std::ranges::any_of(files, [](const fs::path& file) { return file.filename() == kService; });
  if (is_wanted(directories)) {
    facts.sockets = values_of(files_of(directories, kSocket), "ListenStream");
  }
  const Values capabilities = words_of(files, "AmbientCapabilities");
  facts.takes_any_port = std::ranges::find(capabilities, "CAP_NET_BIND_SERVICE") != capabilities.end();
  facts.sees_all_as_read_only = is_one_of(values_of(files, "ProtectSystem"), {"strict"});
  for (const std::string& path : words_of(files, "ReadWritePaths")) {
    facts.writable.emplace_back(path.substr(std::min(path.find_first_not_of("-+"), path.size())));
  }
  for (const std::string& name : words_of(files, "StateDirectory")) {
    facts.writable.push_back(fs::path("/var/lib") / name);
  }
  for (const std::string& name : words_of(files, "RuntimeDirectory")) {
    facts.writable.push_back(fs::path("/run") / name);
  }
  facts.sees_no_homes = is_one_of(values_of(files, "ProtectHome"), {"yes", "true", "on", "1", "tmpfs"});
  facts.has_own_tmp = is_one_of(values_of(files, "PrivateTmp"), {"yes", "true", "on", "1"});
  return facts;
}

Lines judge(const ServiceFacts& service, const std::vector<Wanted>& wanted, const std::string& control) {
  Lines lines;
  for (const Wanted& each : wanted) {
    const fs::path path = fs::absolute(each.path);
    if (const auto hidden = hidden_by(service, path)) {
      lines.push_back({Verdict::warning, "file " + path.string(),
                       "the service does not see it: its unit has " + *hidden,
                       "put it below /etc/canopen-gateway, or what is written below /var/lib/canopen-gateway"});
    } else if (each.use == Wanted::Use::keep && service.sees_all_as_read_only &&
               !is_below_any(path, service.writable)) {
      lines.push_back(read_only("file " + path.string(), path));
    }
  }
  if (!control.empty() && service.sees_all_as_read_only && !is_below_any(control, service.writable)) {
    lines.push_back(read_only("file " + control, fs::path(control).parent_path()));
  }
  return lines;
}

}  // namespace gateway::doctor

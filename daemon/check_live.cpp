#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <system_error>

#include "daemon/commands.h"
#include "daemon/compare/compare.h"
#include "daemon/control/session.h"
#include "daemon/demo_name.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace gateway {
namespace {

using std::chrono::milliseconds;
using Time = std::chrono::steady_clock;

// One answer: the transfers of others go first, and a drive that is silent costs its timeouts.
constexpr std::chrono::seconds kPatience(15);
// All of it. 127 drives of 60 objects take half a minute where SDO has a tenth of 250 kbit/s.
constexpr std::chrono::seconds kTogether(180);

constexpr const char* kStatus = R"({"id":1,"op":"status"})";

std::string how_to_start(const Options& options) {
  const std::string file = options.config.string();
  return "; check --live compares through the running gateway, so start it: `systemctl start canopen-gateway`, or "
         "`canopen-gateway run --config " +
         file + "`; for one with simulated drives `canopen-gateway demo --config " + file +
         "`, and --control as it says";
}

// The gateway knows the file as it was when it started.
std::optional<config::Finding> changed_since(const std::filesystem::path& file, double uptime) {
  std::error_code failed;
  const auto changed = std::filesystem::last_write_time(file, failed);
  if (failed) {
    return std::nullopt;
  }
  const auto age = std::filesystem::file_time_type::clock::now() - changed;
  if (std::chrono::duration<double>(age).count() >= uptime) {
    return std::nullopt;
  }
  return config::Finding{.file = file.string(),
                         .level = config::Finding::Level::warning,
                         .text =
                             "it was changed after the gateway started, which runs what stood there before; restart "
                             "it, then look again"};
}

/// Asks within the time for all of it. What went wrong between us and the gateway is kept.
class Asker {
 public:
  explicit Asker(const std::filesystem::path& socket) : session_(socket) {}

  std::optional<std::string> operator()(const std::string& request) {
    const auto left = std::chrono::duration_cast<milliseconds>(end_ - Time::now());
    if (left <= milliseconds(0)) {
      late_ = true;
      return std::nullopt;
    }
    control::Exchanged exchanged = session_.ask(request, std::min<milliseconds>(left, kPatience));
    return exchanged.problem.empty() ? std::optional(std::move(exchanged.answer)) : std::nullopt;
  }
  [[nodiscard]] const std::string& problem() const noexcept { return session_.problem(); }
  [[nodiscard]] bool late() const noexcept { return late_; }

 private:
  control::Session session_;
  Time::time_point end_ = Time::now() + kTogether;
  bool late_ = false;
};

config::Findings other_gateway(const config::Model& model, const Options& options, const compare::Running& running) {
  config::Findings findings;
  const std::string& name = model.gateway.name;
  if (running.gateway != name && running.gateway != demo_name(name)) {
    findings.push_back({.file = options.config.string(),
                        .level = config::Finding::Level::warning,
                        .text = "the running gateway is \"" + running.gateway + "\", not \"" + name + "\""});
  }
  if (auto changed = changed_since(options.config, running.uptime)) {
    findings.push_back(*std::move(changed));
  }
  return findings;
}

}  // namespace

int check_live(const Options& options, const std::filesystem::path& control) {
  const config::Loaded loaded = config::load(load_options(options));
  print(text_of(loaded.findings));
  if (!loaded.model) {
    return kConfigurationError;
  }
  const config::Model& model = *loaded.model;
  Asker asker(control.empty() ? std::filesystem::path(model.gateway.control) : control);
  const std::optional<std::string> status = asker(kStatus);
  const auto running = status ? compare::read_running(*status) : std::nullopt;
  if (!running) {
    complain((asker.problem().empty() ? "what listens there is no gateway" : asker.problem()) + how_to_start(options));
    return kFailed;
  }
  const compare::Ask ask = [&asker](const std::string& request) { return asker(request); };
  const compare::Comparison comparison = compare::compare(model, loaded.notes, *running, ask);
  print(text_of(other_gateway(model, options, *running)) + text_of(comparison.findings));
  if (!asker.problem().empty() || asker.late()) {
    complain(asker.late() ? "not all was compared within " + std::to_string(kTogether.count()) + " s"
                          : asker.problem());
    return kFailed;
  }
  print(compare::summary(comparison) + "\n");
  if (config::has_errors(comparison.findings)) {
    return kConfigurationError;
  }
  print(config::summary(model) + "\n");
  return kDone;
}

}  // namespace gateway

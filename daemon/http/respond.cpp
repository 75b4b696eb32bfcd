#include "daemon/http/respond.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "daemon/http/metrics.h"
#include "daemon/http/page.h"

namespace gateway::http {
namespace {

constexpr std::string_view kOneDrive = "/api/drives/";
constexpr std::string_view kOneRecord = "/records/";
constexpr std::array<std::string_view, 1> kCount{"count"};
constexpr std::array<std::string_view, 1> kDrive{"drive"};
constexpr std::array<std::string_view, 2> kTraced{"drive", "kind"};

struct Resource {
  std::string_view path;
  Answer (*answer)(const Site& site, const Target& target);
  std::span<const std::string_view> parameters{};
};

constexpr std::array<Resource, 12> kResources{
    {{"/metrics", [](const Site& site, const Target&) { return metrics(site); }},
     {"/health", [](const Site& site, const Target&) { return health(site); }},
     {"/api/drives", [](const Site& site, const Target&) { return drives(site); }},
     {"/api/gateway", [](const Site& site, const Target&) { return gateway_figures(site); }},
     {"/api/buses", [](const Site& site, const Target&) { return buses(site); }},
     {"/api/alarms", [](const Site& site, const Target&) { return active_alarms(site); }},
     {"/api/records", [](const Site& site, const Target&) { return records(site); }},
     {"/api/map", [](const Site& site, const Target&) { return map(site); }},
     {"/api/history", [](const Site& site, const Target& target) { return history(site, target); }, kDrive},
     {"/api/live", [](const Site&, const Target&) { return Answer{.type = "text/event-stream", .stream = true}; }},
     {"/api/trace", [](const Site& site, const Target& target) { return trace_frames(site, target); }, kTraced},
     {"/api/commands", [](const Site& site, const Target& target) { return commands(site, target); }, kCount}}};

Answer not_found(std::string_view path) {
  std::vector<std::string> known;
  for (const Resource& resource : kResources) {
    known.emplace_back(resource.path);
  }
  known.insert(known.begin() + 3, std::string(kOneDrive).append("NAME"));
  known.emplace_back(std::string(kOneRecord).append("NAME"));
  known.emplace(known.begin(), "/");
  return refusal(404, std::string("there is no ").append(beginning(path)), "resources", known);
}

// Whoever writes a parameter wants something of it.
std::optional<Answer> unknown_parameter(const Target& target, std::span<const std::string_view> known) {
  for (const Parameter& parameter : target.parameters) {
    if (std::ranges::find(known, parameter.name) == known.end()) {
      return refusal(400, target.path + " knows no parameter \"" + std::string(beginning(parameter.name)) + "\"",
                     "parameters", std::vector<std::string>(known.begin(), known.end()));
    }
  }
  return std::nullopt;
}

}  // namespace

Answer respond(const Request& request, const Site& site) {
  const Target& target = request.target;
  if (target.path.starts_with(kOneDrive)) {
    const auto wrong = unknown_parameter(target, {});
    return wrong ? *wrong : drive(site, std::string_view(target.path).substr(kOneDrive.size()));
  }
  if (target.path.starts_with(kOneRecord)) {
    const auto wrong = unknown_parameter(target, {});
    return wrong ? *wrong : record_file(site, std::string_view(target.path).substr(kOneRecord.size()));
  }
  if (auto page = page_file(target.path, site.charts)) {
    const auto wrong = unknown_parameter(target, {});
    return wrong ? *wrong : *std::move(page);
  }
  const auto* const found = std::ranges::find(kResources, std::string_view(target.path), &Resource::path);
  if (found == kResources.end()) {
    return not_found(target.path);
  }
  const auto wrong = unknown_parameter(target, found->parameters);
  return wrong ? *wrong : found->answer(site, target);
}

}  // namespace gateway::http

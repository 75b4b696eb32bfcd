#include <cstddef>
#include <string>
#include <vector>

#include "daemon/control/status_json.h"
#include "daemon/http/respond.h"

namespace gateway::http {

std::vector<std::string> drive_names(const config::Model& model) {
  std::vector<std::string> names;
  for (const config::Drive& drive : model.drives) {
    names.push_back(drive.name);
  }
  return names;
}

Answer drives(const Site& site) {
  if (site.plant.size() == 0) {
    return {.body = "[]"};
  }
  Answer answer{.body = "["};
  // By name: meanwhile the configuration may change.
  answer.rest = [&site, names = drive_names(site.plant.model()), next = std::size_t{0},
                 any = false](std::string& text) mutable {
    if (const process::Drive* const drive = site.plant.find(names[next])) {
      text += any ? "," : "";
      any = true;
      control::append_drive_status(text, site.plant, drive->index(), canopen::Clock::now());
    }
    ++next;
    text += next < names.size() ? "" : "]";
    return Progress{.goes_on = next < names.size()};
  };
  return answer;
}

Answer drive(const Site& site, std::string_view name) {
  const process::Drive* const found = site.plant.find(name);
  if (found == nullptr) {
    return refusal(404, "there is no drive \"" + std::string(beginning(name)) + "\"", "drives",
                   drive_names(site.plant.model()));
  }
  Answer answer;
  control::append_drive_status(answer.body, site.plant, found->index(), canopen::Clock::now());
  return answer;
}

}  // namespace gateway::http

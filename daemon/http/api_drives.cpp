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
  answer.rest = [&site, next = std::size_t{0}](std::string& text) mutable {
    control::append_drive_status(text, site.plant, next, canopen::Clock::now());
    ++next;
    text += next < site.plant.size() ? ',' : ']';
    return Progress{.goes_on = next < site.plant.size()};
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

#include <ranges>
#include <string>
#include <vector>

#include "bridges/text/json_text.h"
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
  Answer answer;
  const canopen::TimePoint now = canopen::Clock::now();
  text::append_list(answer.body, std::views::iota(std::size_t{0}, site.plant.size()),
                    [&](std::string& to, auto index) { control::append_drive_status(to, site.plant, index, now); });
  return answer;
}

Answer drive(const Site& site, std::string_view name) {
  const process::Drive* const found = site.plant.find(name);
  if (found == nullptr) {
    return refusal(404, "there is no drive \"" + std::string(name) + "\"", "drives", drive_names(site.plant.model()));
  }
  Answer answer;
  control::append_drive_status(answer.body, site.plant, found->index(), canopen::Clock::now());
  return answer;
}

}  // namespace gateway::http

#include <string>
#include <vector>

#include "daemon/http/respond.h"

namespace gateway::http {

Answer history(const Site& site, const Target& target) {
  const std::string* const name = target.find("drive");
  const process::Drive* const found = name == nullptr ? nullptr : site.plant.find(*name);
  if (found == nullptr) {
    const std::string why = name == nullptr ? "which drive? write ?drive=NAME"
                                            : "there is no drive \"" + std::string(beginning(*name)) + "\"";
    return refusal(name == nullptr ? 400 : 404, why, "drives", drive_names(site.plant.model()));
  }
  Answer answer;
  answer.rest = site.history(found->index());
  return answer;
}

}  // namespace gateway::http

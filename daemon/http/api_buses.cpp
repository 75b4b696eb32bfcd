#include "daemon/bus_report.h"
#include "daemon/http/respond.h"

namespace gateway::http {

// A bus a piece.
Answer buses(const Site& site) {
  Answer answer;
  answer.body = "[";
  answer.rest = [&site, bus = std::size_t{0}, configuration = site.plant.changes()](std::string& text) mutable {
    if (configuration != site.plant.changes()) {
      text += "]";  // Meanwhile the buses became others.
      return Progress{};
    }
    const std::size_t count = site.survey ? site.plant.model().buses.size() : 0;
    if (bus < count) {
      text += bus == 0 ? "" : ",";
      append_bus_report(text, site.plant, bus, site.survey(bus));
      ++bus;
    }
    if (bus < count) {
      return Progress{.goes_on = true};
    }
    text += "]";
    return Progress{};
  };
  return answer;
}

}  // namespace gateway::http

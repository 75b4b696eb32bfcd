#include <cmath>

#include "config/bus_load.h"
#include "config/site/site.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

/// Above this, at worst stuffing, a bus has too little left for commands and retries.
constexpr double kBusy = 0.6;

std::string percent(double share) {
  return to_text(std::round(share * 1000.0) / 10.0) + " %";
}

}  // namespace

void advise_on_load(const Model& model, const Node& root, Report& report) {
  const auto tables = read_tables(root, "bus");
  for (std::size_t i = 0; i < model.buses.size() && i < tables.size(); ++i) {
    const auto load = forecast_load(model, i);
    if (!load.has_value()) {
      continue;
    }
    const std::string where = "bus \"" + model.buses[i].name + "\": ";
    if (load->worst > kBusy) {
      report.warning(tables[i]->place, where + "its load is forecast at " + percent(load->usual) + ", " +
                                           percent(load->worst) + " at worst stuffing" +
                                           (load->at_least ? " (both at least)" : "") +
                                           "; above 60 % commands and boots wait. Make event_timer "
                                           "and poll longer, leave PDOs out, or raise the bit rate");
    }
    if (load->polls_worst > model.buses[i].sdo_load / 2) {
      report.warning(tables[i]->place, where + "polls alone are forecast to take " + percent(load->polls_worst) +
                                           " of the bus, more than half of what SDO transfers may lead to; make poll "
                                           "longer, or let TPDOs carry these signals");
    }
  }
}

}  // namespace config

#include "daemon/bus_report.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <ranges>
#include <string_view>

#include "bridges/text/timestamp.h"
#include "canopen/survey/bus_survey.h"

namespace gateway {
namespace {

using canopen::BusHealth;
using canopen::Duration;
using canopen::Extremes;
using canopen::LogHistogram;
using canopen::NodeHealth;
using text::ObjectText;

// Digits beyond that are none.
double rounded(double value, double parts) {
  return std::round(value * parts) / parts;
}

double seconds(Duration time) {
  constexpr double kParts = 1e6;
  return rounded(std::chrono::duration<double>(time).count(), kParts);
}

double share(double value) {
  constexpr double kParts = 1e4;
  return rounded(value, kParts);
}

void append_extremes(ObjectText& to, std::string_view name, const std::optional<Extremes>& extremes) {
  if (!extremes) {
    to.null(name);
    return;
  }
  ObjectText object(to.key(name));
  object.integer("least", extremes->least);
  object.integer("most", extremes->most);
  object.close();
}

void append_shares(ObjectText& to, std::string_view name, const std::optional<double>& least,
                   const std::optional<double>& most) {
  if (!least || !most) {
    to.null(name);
    return;
  }
  ObjectText object(to.key(name));
  object.number("least", share(*least));
  object.number("most", share(*most));
  object.close();
}

void append_suspicion(ObjectText& to, const BusHealth& health) {
  if (!health.suspicion) {
    to.null("suspicion");
    return;
  }
  ObjectText object(to.key("suspicion"));
  object.text("kind", name_of(health.suspicion->kind));
  object.text("since", text::timestamp(health.suspected_since));
  object.number("age", seconds(health.suspicion_age));
  object.text("text", suspicion_text(health));
  object.text("seen", health.suspicion->seen);
  object.text("look", health.suspicion->look);
  object.close();
}

void append_percentiles(ObjectText& object, const LogHistogram::Percentiles& percentiles) {
  object.integer("count", percentiles.count);
  object.number("p50", seconds(percentiles.p50));
  object.number("p99", seconds(percentiles.p99));
}

std::optional<std::string_view> drive_of(const process::Plant& plant, std::size_t bus, std::uint8_t node) {
  for (const config::Drive& drive : plant.model().drives) {
    if (drive.bus == bus && drive.node.node == node) {
      return drive.name;
    }
  }
  return std::nullopt;
}

std::optional<double> seconds(const std::optional<Duration>& time) {
  return time ? std::optional(seconds(*time)) : std::nullopt;
}

void append_node(std::string& out, std::optional<std::string_view> drive, const NodeHealth& node) {
  ObjectText object(out);
  object.integer("node", node.node);
  object.text("drive", drive);
  object.number("timeout", node.timeout > Duration::zero() ? std::optional(seconds(node.timeout)) : std::nullopt);
  object.number("longest_gap", seconds(node.longest_gap));
  append_shares(object, "margin", node.worst_margin(), node.best_margin());
  if (node.answers.count == 0) {
    object.null("sdo");
  } else {
    ObjectText answers(object.key("sdo"));
    append_percentiles(answers, node.answers);
    answers.close();
  }
  object.close();
}

void append_cob_id(std::string& out, const canopen::PeriodHealth& period) {
  ObjectText object(out);
  object.text("cob_id", fmt::format("0x{:03X}", period.cob_id));
  append_percentiles(object, period.period);
  object.number("worst", seconds(period.worst));
  object.close();
}

void append_burst(ObjectText& to, const std::optional<canopen::Burst>& burst) {
  if (!burst) {
    to.null("burst");
    return;
  }
  ObjectText object(to.key("burst"));
  object.integer("frames", burst->frames);
  object.number("time", seconds(burst->time));
  object.close();
}

void append_load(ObjectText& to, const std::optional<Extremes>& load) {
  constexpr double kPerMille = 1000;
  append_shares(to, "load", load ? std::optional(load->least / kPerMille) : std::nullopt,
                load ? std::optional(load->most / kPerMille) : std::nullopt);
}

}  // namespace

void append_bus_summary(ObjectText& to, const process::Plant& plant, std::size_t bus, const Surveys& surveys) {
  const BusHealth health = surveys ? surveys(bus).health() : BusHealth{};
  const std::string suspicion = suspicion_text(health);
  to.text("suspicion", health.suspicion ? std::optional<std::string_view>(suspicion) : std::nullopt);
  const NodeHealth* const worst = worst_node(health);
  if (worst == nullptr) {
    to.null("heartbeat_margin");
    return;
  }
  ObjectText object(to.key("heartbeat_margin"));
  object.integer("node", worst->node);
  object.text("drive", drive_of(plant, bus, worst->node));
  object.number("least", share(*worst->worst_margin()));
  object.close();
}

void append_bus_report(std::string& out, const process::Plant& plant, std::size_t bus,
                       const canopen::BusSurvey& survey) {
  const BusHealth health = survey.health();
  ObjectText object(out);
  object.text("name", plant.model().buses[bus].name);
  object.text("interface", plant.model().buses[bus].interface);
  append_suspicion(object, health);
  append_load(object, health.load);
  append_extremes(object, "transmit_errors", health.transmit_errors);
  append_extremes(object, "receive_errors", health.receive_errors);
  append_extremes(object, "error_frames", health.errors);
  append_burst(object, health.burst);
  text::append_list(object.key("nodes"), health.nodes, [&](std::string& to, const NodeHealth& node) {
    append_node(to, drive_of(plant, bus, node.node), node);
  });
  text::append_list(object.key("cob_ids"), survey.periods(), append_cob_id);
  object.close();
}

std::string bus_reports(const process::Plant& plant, const Surveys& surveys) {
  std::string out;
  const std::size_t buses = surveys ? plant.model().buses.size() : 0;
  text::append_list(out, std::views::iota(std::size_t{0}, buses),
                    [&](std::string& to, std::size_t bus) { append_bus_report(to, plant, bus, surveys(bus)); });
  return out;
}

}  // namespace gateway

#include "config/longest_restart.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "canopen/node/life_guarding.h"
#include "config/text.h"

namespace config {
namespace {

/// One drive, and how long it bears to be without us.
struct Patience {
  Duration lasts{};
  std::string then;  ///< "mixer1 misses it (supervise_gateway 2s)"
};

Patience patience_by_rpdo(const Drive& drive, std::uint16_t number) {
  const auto& rpdos = drive.node.rpdos;
  const auto rpdo =
      std::find_if(rpdos.begin(), rpdos.end(), [number](const auto& each) { return each.number == number; });
  const Duration timer = std::chrono::milliseconds(rpdo == rpdos.end() ? 0 : rpdo->event_timer.value_or(0));
  const std::string name = "rpdo" + std::to_string(number);
  return {.lasts = Duration::zero(),
          .then = drive.name + " trips without " + name + " (event_timer " + to_text(timer) +
                  "), which a new start repeats only once it is commanded again"};
}

std::optional<Patience> patience_of(const Drive& drive, const DriveNotes& notes, const Model& model) {
  if (!drive.enabled) {
    return std::nullopt;
  }
  if (notes.supervised_rpdo.has_value() && drive.commands.writers.any()) {
    return patience_by_rpdo(drive, *notes.supervised_rpdo);
  }
  const canopen::ErrorControlSettings& control = drive.node.error_control;
  if (control.supervise_gateway <= Duration::zero()) {
    return std::nullopt;
  }
  const bool guards = control.guarding > Duration::zero();
  const std::string how = drive.name + " misses it (supervise_gateway " + to_text(control.supervise_gateway) +
                          (guards ? ", by guarding)" : ")");
  if (guards) {
    const canopen::LifeGuarding life = canopen::wanted_life_guarding(control);
    return Patience{.lasts = std::chrono::milliseconds(life.guard_time * life.factor) - control.guarding, .then = how};
  }
  return Patience{.lasts = control.supervise_gateway - model.buses[drive.bus].heartbeat, .then = how};
}

std::string seconds_text(Duration time) {
  return to_text(std::chrono::duration<double>(time).count()) + " s";
}

}  // namespace

std::string longest_restart(const Loaded& loaded) {
  const Model& model = *loaded.model;
  std::vector<Patience> all;
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    if (auto patience = patience_of(model.drives[i], loaded.notes[i], model)) {
      all.push_back(*std::move(patience));
    }
  }
  const auto first =
      std::min_element(all.begin(), all.end(), [](const Patience& a, const Patience& b) { return a.lasts < b.lasts; });
  if (first == all.end()) {
    return "longest restart: no limit is known, since no drive supervises the gateway";
  }
  const std::string others = all.size() == 1 ? "" : "; " + std::to_string(all.size()) + " drives supervise the gateway";
  if (first->lasts <= Duration::zero()) {
    return "longest restart: none: " + first->then + others;
  }
  return "longest restart: " + seconds_text(first->lasts) + ", then " + first->then + others;
}

}  // namespace config

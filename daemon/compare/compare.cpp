#include "daemon/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>

#include "daemon/compare/settings.h"

namespace gateway::compare {
namespace {

using Level = config::Finding::Level;

config::Finding warning_of(const std::string& drive, std::string text) {
  return {.file = place_of_drive(drive), .level = Level::warning, .text = std::move(text)};
}

const RunningDrive* find(const Running& running, const std::string& name) {
  const auto found = std::ranges::find(running.drives, name, &RunningDrive::name);
  return found == running.drives.end() ? nullptr : &*found;
}

// Why the gateway's drive of that name is not the one of the configuration, so that it cannot be compared; empty where
// it is.
std::string why_another(const config::Model& model, const config::Drive& drive, const RunningDrive* running) {
  const std::string restart = "; it runs another configuration: restart it, then look again";
  if (running == nullptr) {
    return "the running gateway has no such drive, so it was not compared" + restart;
  }
  const std::string& bus = model.buses[drive.bus].name;
  if (running->node != drive.node.node || running->bus != bus) {
    return fmt::format(
        "in the running gateway it is node {} on bus {}, here node {} on bus {}, so it was not compared{}",
        running->node, running->bus, drive.node.node, bus, restart);
  }
  return "";
}

// Its boot ended with a letter: it is there, and the gateway does not serve it.
bool has_letter(const RunningDrive& running) {
  return running.boot != "ok" && running.boot != "not-booted" && !running.boot.empty();
}

// Why nothing can be read of it; empty where it can.
std::string why_not_there(const RunningDrive& running) {
  if (!running.enabled) {
    return "is out of service in the running gateway (enabled = false), so it was not compared";
  }
  if (!running.online && !has_letter(running)) {
    return "is offline, so it was not compared" +
           (running.boot_text.empty() ? std::string() : "; its boot: " + running.boot_text);
  }
  return "";
}

void compare_all(DriveView& view, const config::DriveNotes& notes, const RunningDrive& running) {
  // Whatever is found beside it: the gateway does not serve the drive.
  if (has_letter(running)) {
    view.note(Level::error, "boot " + running.boot + ": " + running.boot_text);
  }
  compare_identity(view);
  compare_error_control(view);
  compare_pdos(view);
  compare_setup(view);
  compare_live_checks(view, notes);
}

void compare_drive(Comparison& into, const config::Drive& drive, const config::DriveNotes& notes,
                   const RunningDrive& running, const Ask& ask) {
  if (running.profile != drive.profile && !running.profile.empty()) {
    into.findings.push_back(warning_of(
        drive.name, fmt::format("in the running gateway its profile is {}, here {}; restart it, then look again",
                                running.profile, drive.profile)));
  }
  DriveView view(ask, drive, into.findings, into.objects);
  compare_all(view, notes, running);
  into.drives += view.silent() ? 0U : 1U;
}

void name_the_others(Comparison& into, const config::Model& model, const Running& running) {
  for (const RunningDrive& drive : running.drives) {
    if (std::ranges::find(model.drives, drive.name, &config::Drive::name) == model.drives.end()) {
      into.findings.push_back(
          warning_of(drive.name, "the running gateway has it, and this configuration does not; restart the gateway"));
    }
  }
}

}  // namespace

Comparison compare(const config::Model& model, std::span<const config::DriveNotes> notes, const Running& running,
                   const Ask& ask) {
  Comparison into;
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    const config::Drive& drive = model.drives[i];
    if (!drive.enabled) {
      continue;
    }
    const RunningDrive* const there = find(running, drive.name);
    std::string reason = why_another(model, drive, there);
    if (reason.empty()) {
      reason = why_not_there(*there);
    }
    if (reason.empty()) {
      compare_drive(into, drive, notes[i], *there, ask);
    } else {
      into.findings.push_back(warning_of(drive.name, std::move(reason)));
    }
  }
  name_the_others(into, model, running);
  return into;
}

std::string summary(const Comparison& comparison) {
  return fmt::format("live: {} {} compared, {} objects as configured, {} that a drive does not have", comparison.drives,
                     comparison.drives == 1 ? "drive" : "drives", comparison.objects.alike, comparison.objects.absent);
}

}  // namespace gateway::compare

#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canopen/node/node_settings.h"
#include "config/drive/note_keys.h"
#include "config/model.h"
#include "config/schema/section.h"

// What a site, a profile and a preset say of a drive, each table as a plain struct; what follows from it is worked out
// by the drive's builder.

namespace config {

/// Freely assigned objects are counted from 1 to this at most.
inline constexpr std::int64_t kLastSlot = 64;

/// What only a `[[drive]]` says.
struct DriveKeys {
  std::string name;
  std::optional<std::string> bus;
  std::uint8_t node = 0;
  std::string profile;
  std::optional<Unit> unit;
  std::optional<std::uint16_t> flat;
  canopen::ErrorControlSettings error_control;  ///< Its times.
  std::optional<OnStale> on_stale;
  bool reconfigure_running = false;
  bool restart = false;
  bool enabled = true;
  std::vector<std::string> presets;
  Commands commands;
};
[[nodiscard]] const SectionOf<DriveKeys>& drive_section();

/// One `signals.NAME`.
struct SignalKeys {
  bool enabled = true;
  Signal signal;  ///< What is plainly said of it; name, object, type and all that follows from them are not.
  std::optional<canopen::ObjectAddress> object;
  std::optional<canopen::DataType> type;
  std::optional<std::string> from;
  std::optional<std::int64_t> mask;
  std::vector<std::int64_t> equals;
  bool negative = false;
  std::optional<std::string> source;
  std::vector<std::int64_t> momentary;
  std::vector<std::int64_t> edge;
  std::vector<std::int64_t> stop;
  std::vector<canopen::StopWord> stop_masks;
  std::optional<std::int64_t> address;
  bool as_float = false;
};
[[nodiscard]] const SectionOf<SignalKeys>& signal_section();

/// One `tpdoN` or `rpdoN`.
struct PdoKeys {
  bool enabled = true;
  canopen::PdoSettings settings;  ///< Its policies and type.
  std::optional<CobId> cob_id;
  std::optional<canopen::Duration> inhibit_time;
  std::optional<canopen::Duration> event_timer;
  std::vector<std::pair<canopen::ObjectAddress, canopen::DataType>> map;
  std::vector<std::string> unused;
  bool supervised = false;
  bool unconfirmed = false;
};

struct ErrorControlKeys {
  canopen::SetupPolicy policy = canopen::SetupPolicy::write;
  bool consumer = false;
  bool unconfirmed = false;
  bool guarding = false;
};

struct EmcyKeys {
  canopen::EmcySettings settings;
  bool error_register = true;
  bool error_field = true;
};

struct SetupKeys {
  std::optional<canopen::ObjectAddress> object;
  std::optional<canopen::DataType> type;
  std::optional<std::int64_t> value;
};

/// What a profile, a preset and a drive can all say.
struct OverlayKeys {
  std::vector<Said<SignalKeys>> signals;
  std::vector<Said<PdoKeys>> tpdos;
  std::vector<Said<PdoKeys>> rpdos;
  canopen::Duration inhibit_unit = std::chrono::microseconds(100);
  bool self_starting = false;
  bool error_register = true;
  ErrorControlKeys error_control;
  canopen::SdoSettings sdo;
  EmcyKeys emcy;
  canopen::ExpectedIdentity identity;
  std::vector<Said<SetupKeys>> setup;
  std::map<std::int64_t, FaultText> fault_texts;
  std::map<std::int64_t, FaultText> emcy_texts;
  std::vector<Said<LiveKeys>> live;
  Trial trial;
};
[[nodiscard]] const SectionOf<OverlayKeys>& overlay_section();

/// What a profile says of its own file.
struct ProfileKeys {
  std::string title;
  std::optional<std::string> extends;
  bool partial = false;
};
[[nodiscard]] const SectionOf<ProfileKeys>& profile_section();

/// One `presets.NAME`, beside its overlay.
struct PresetKeys {
  std::string text;
  std::optional<std::string> unconfirmed;
};
[[nodiscard]] const SectionOf<PresetKeys>& preset_section();

/// `slots.settings` or `slots.returns`: objects whose meaning is chosen in the drive.
struct SlotKeys {
  std::vector<canopen::ObjectAddress> objects;
  std::optional<std::string> unconfirmed;
};
[[nodiscard]] const SectionOf<SlotKeys>& slot_section();

}  // namespace config

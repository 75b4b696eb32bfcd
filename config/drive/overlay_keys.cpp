#include <chrono>
#include <limits>

#include "config/drive/drive_keys.h"
#include "config/text.h"

namespace config {
namespace {

using canopen::SetupPolicy;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr std::int64_t kMaxInteger = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMaxU32 = 0xFFFF'FFFF;

Form<SetupPolicy> policy() {
  return choice<SetupPolicy>(
      {{"write", SetupPolicy::write}, {"verify", SetupPolicy::verify}, {"assume", SetupPolicy::assume}});
}

/// Number -> text, or number -> { text, severity }.
Form<std::map<std::int64_t, FaultText>> fault_texts(std::int64_t max) {
  using Field = KeyOf<FaultText>;
  static const SectionOf<FaultText> section(
      "fault",
      {Field("text", &FaultText::text, text(), "What is shown.").required(),
       Field("severity", &FaultText::severity,
             choice<Severity>({{"fault", Severity::fault}, {"warning", Severity::warning}}), "How bad it is.")});
  return numbered<FaultText>("number = string or { text, severity }", 0, max,
                             [](const Node& node, const Complaint& complain) -> std::optional<FaultText> {
                               if (node.kind == NodeKind::table) {
                                 check_table(node, section, complain);
                                 return section.read(node);
                               }
                               auto text = read_short_text(node, complain);
                               return text.has_value() ? std::optional(FaultText{.text = *text}) : std::nullopt;
                             });
}

/// One whose mask is missing or wrong has its finding, and would match everything.
Form<canopen::StopWord> stop_mask() {
  using canopen::StopWord;
  using Field = KeyOf<StopWord>;
  static const SectionOf<StopWord> section(
      "stop_masks", {Field("mask", &StopWord::mask, any_integer(1), "Bits that count.").required(),
                     Field("equals", &StopWord::equals, any_integer(0), "What they are in a stop.").required()});
  return {.type = "{ mask, equals }",
          .read = [](const Node& node, const Complaint& complain) -> std::optional<StopWord> {
            check_table(node, section, complain);
            const StopWord word = section.read(node);
            return word.mask == StopWord{}.mask ? std::nullopt : std::optional(word);
          },
          .show = {}};
}

const SectionOf<PdoKeys>& pdo_section() {
  using canopen::PdoSettings;
  using Field = KeyOf<PdoKeys>;
  const auto setting = [](auto member) { return [member](auto& said) -> auto& { return said.settings.*member; }; };
  static const SectionOf<PdoKeys> section(
      "tpdoN, rpdoN",
      {Field("enabled", &PdoKeys::enabled, boolean(), "`false`: the gateway leaves it alone."),
       Field("cob_id", &PdoKeys::cob_id, cob_id(), "`0x185` or `\"$NODEID+0x180\"`.").unset("predefined for 1..4"),
       Field("communication", setting(&PdoSettings::communication), policy(),
             "COB-ID, type and times: made so, only compared, or taken for granted."),
       Field(
           "mapping", setting(&PdoSettings::mapping_policy), policy(),
           "The same for the mapping. One that is to be made so, and that the drive does not have, is boot letter J."),
       Field("transmission_type", setting(&PdoSettings::transmission_type), integer(0, 255), "Sub-index 2.")
           .unset("as the drive has it"),
       Field("inhibit_time", &PdoKeys::inhibit_time, duration({.min = seconds(0), .max = kLongest16}),
             "Sub-index 3, counted in `inhibit_unit`.")
           .unset("as the drive has it"),
       Field("event_timer", &PdoKeys::event_timer, duration({.min = seconds(0), .max = kLongest16}),
             "Sub-index 5, whole milliseconds; `0s`: none. Of an RPDO: the drive supervises its arrival.")
           .unset("as the drive has it"),
       Field("map", &PdoKeys::map, list("list of strings", mapped_object()),
             "Its objects in order, `\"0x2021:02 u16\"`; at most 64 bits. Replaces the profile's as a whole.")
           .unset(""),
       Field("unused", &PdoKeys::unused, list("list of strings", text()),
             "RPDO: signals or objects that the site does not use; sent as 0, and no signal any more."),
       Field("supervised", &PdoKeys::supervised, boolean(),
             "RPDO: the drive has its event timer, and trips when the RPDO is missing that long."),
       Field("unconfirmed", &PdoKeys::unconfirmed, boolean(), "The layout is not established for this drive.")});
  return section;
}

const SectionOf<ErrorControlKeys>& error_control_section() {
  using Field = KeyOf<ErrorControlKeys>;
  static const SectionOf<ErrorControlKeys> section(
      "error_control",
      {Field("policy", &ErrorControlKeys::policy, policy(), "Of the heartbeat period, 0x1017."),
       Field("consumer", &ErrorControlKeys::consumer, boolean(), "It can supervise the gateway's heartbeat (0x1016)."),
       Field("unconfirmed", &ErrorControlKeys::unconfirmed, boolean(),
             "What its motor does when `supervise_gateway` runs out is not established: nothing relies on that it "
             "stops."),
       Field("guarding", &ErrorControlKeys::guarding, boolean(),
             "It answers node guarding; asked once for its state, when found without a heartbeat. What `guarding` of a "
             "drive "
             "needs.")});
  return section;
}

const SectionOf<canopen::SdoSettings>& sdo_section() {
  using canopen::SdoSettings;
  using Field = KeyOf<SdoSettings>;
  static const SectionOf<SdoSettings> section(
      "sdo", {Field("timeout", &SdoSettings::timeout, duration({.min = milliseconds(10), .max = minutes(1)}),
                    "Of one answer frame."),
              Field("retries", &SdoSettings::retries, integer(0, 10),
                    "Further tries of reads and of settings; a command is sent once."),
              Field("patience", &SdoSettings::patience, duration({.min = seconds(0), .max = minutes(10)}),
                    "How long after a boot-up the SDO server may be silent."),
              Field("block", &SdoSettings::block, boolean(),
                    "It knows block transfer: what is longer than 28 bytes, or of no known length, goes that way."),
              Field("short_answers", &SdoSettings::accept_short_answers, boolean(),
                    "Answers of fewer than 8 bytes are good if they hold what they need."),
              Field("upload_style_write_answer", &SdoSettings::accept_upload_style_write_answer, boolean(),
                    "A write may be confirmed in the form of an answer to a read.")});
  return section;
}

const SectionOf<EmcyKeys>& emcy_section() {
  using canopen::EmcyLayout;
  using canopen::EmcySettings;
  using Field = KeyOf<EmcyKeys>;
  const auto setting = [](auto member) { return [member](auto& said) -> auto& { return said.settings.*member; }; };
  static const SectionOf<EmcyKeys> section(
      "emcy",
      {Field("layout", setting(&EmcySettings::layout),
             choice<EmcyLayout>({{"cia301", EmcyLayout::cia301},
                                 {"drive-code", EmcyLayout::drive_code},
                                 {"class-and-vendor40", EmcyLayout::class_and_vendor40}}),
             "How the emergency frame is filled."),
       Field("reset_counts_remaining", setting(&EmcySettings::reset_counts_remaining), boolean(),
             "Byte 3 of an error reset counts the errors that remain."),
       Field("drive_code_under", setting(&EmcySettings::drive_code_under), integer(0, 0xFFFF),
             "Emergency code under which the drive sends its own fault code.")
           .note("none"),
       Field("error_register", &EmcyKeys::error_register, boolean(),
             "The drive has 0x1001, and it is read; false: as if it had none."),
       Field("error_field", &EmcyKeys::error_field, boolean(), "0x1003 is read for the names of active errors."),
       Field("enable", setting(&EmcySettings::enable), boolean(),
             "0x1014 may be written where emergencies are switched off or moved there.")});
  return section;
}

const SectionOf<canopen::ExpectedIdentity>& identity_section() {
  using canopen::ExpectedIdentity;
  using Field = KeyOf<ExpectedIdentity>;
  const auto number = [](std::string_view name, auto member, std::string_view meaning) {
    return Field(name, member, integer(0, kMaxU32), meaning).unset("not compared");
  };
  static const SectionOf<ExpectedIdentity> section("identity",
                                                   {number("device_type", &ExpectedIdentity::device_type, "0x1000"),
                                                    number("vendor", &ExpectedIdentity::vendor, "0x1018:01"),
                                                    number("product", &ExpectedIdentity::product, "0x1018:02"),
                                                    number("revision", &ExpectedIdentity::revision, "0x1018:03"),
                                                    number("serial", &ExpectedIdentity::serial, "0x1018:04")});
  return section;
}

const SectionOf<SetupKeys>& setup_section() {
  using Field = KeyOf<SetupKeys>;
  static const SectionOf<SetupKeys> section(
      "setup", {Field("object", &SetupKeys::object, object(), "What to write.").required(),
                Field("type", &SetupKeys::type, data_type(), "Its type; no reals.").required(),
                Field("value", &SetupKeys::value, any_integer(), "The raw value.").required()});
  return section;
}

}  // namespace

const SectionOf<SignalKeys>& signal_section() {
  using Field = KeyOf<SignalKeys>;
  using Self = SignalKeys;
  const auto plain = [](auto member) { return [member](auto& said) -> auto& { return said.signal.*member; }; };
  static const SectionOf<Self> section(
      "signals.NAME",
      {Field("enabled", &Self::enabled, boolean(), "`false`: the drive has no such signal."),
       Field("object", &Self::object, object(), "`\"0x2021:02\"`. Needed unless `from` is given."),
       Field("type", &Self::type, data_type(),
             "`bool`, `u8`, `u16`, `u32`, `u64`, `i8`, `i16`, `i32`, `i64`, `f32`, `f64`. Needed with `object`."),
       Field("from", &Self::from, text(),
             "Makes it a boolean read out of this other signal's raw word, by `mask` and `equals` or by `negative`."),
       Field("mask", &Self::mask, any_integer(1), "Bits of the word."),
       Field("equals", &Self::equals, list("list of integers", any_integer(0)),
             "True where the masked word is one of these.")
           .unset("the mask itself"),
       Field("negative", &Self::negative, boolean(), "True where the word as a number is below zero."),
       Field("scale", plain(&Signal::scale), number(), "Engineering value = raw value x scale."),
       Field("unit", plain(&Signal::unit), text(), "`\"Hz\"`."),
       Field("access", plain(&Signal::access),
             choice<Access>({{"read", Access::read}, {"write", Access::write}, {"read-write", Access::read_write}}),
             "A value that goes out in an RPDO is `write`."),
       Field("source", &Self::source, text(), "`\"tpdo1\"`, `\"rpdo1\"`, `\"sdo\"`.")
           .unset("the PDO that maps it, else `sdo`"),
       Field("pdo_only", plain(&Signal::pdo_only), boolean(),
             "The drive takes it in its RPDO alone, so it is not tried by SDO: a write that does not complete the RPDO "
             "is `incomplete`."),
       Field("min", plain(&Signal::min), number(), "Least value that may be commanded.").unset("none"),
       Field("max", plain(&Signal::max), number(), "Greatest value that may be commanded.").unset("none"),
       Field("values", plain(&Signal::values), numbered_texts(std::numeric_limits<std::int64_t>::min(), kMaxInteger),
             "Names of raw numbers: `{ 0 = \"stop\", 1 = \"run\" }`. Replaces the profile's as a whole.")
           .unset("none"),
       Field("momentary", &Self::momentary, list("list of integers", any_integer()),
             "Raw values that are forgotten once sent: fault reset, jog."),
       Field("momentary_mask", plain(&Signal::momentary_mask), any_integer(0), "So is a value with one of these bits."),
       Field(
           "stop", &Self::stop, list("list of integers", any_integer()),
           "Of `control_command`: raw values that only ever stop. A command with one goes before all others; the first "
           "is what a stop for all sends."),
       Field("stop_masks", &Self::stop_masks, list("list of { mask, equals }", stop_mask()),
             "Likewise words that, masked, only ever stop."),
       Field(
           "edge", &Self::edge, list("list of integers", any_integer()),
           "Of `control_command`: momentary raw values that act by their rising edge alone, so that an RPDO may repeat "
           "them: fault reset."),
       Field("address", &Self::address, integer(0, 65535), "Modbus address, of a bit for booleans.")
           .unset("by its name"),
       Field("as", &Self::as_float, choice<bool>({{"raw", false}, {"float", true}}),
             "`float`: two registers with the engineering value."),
       Field("poll", plain(&Signal::poll), duration({.min = milliseconds(10), .max = minutes(60)}),
             "How often it is read by SDO."),
       Field("deadband", plain(&Signal::deadband), number(),
             "MQTT: smaller changes are not published. Engineering units."),
       Field("publish_mask", plain(&Signal::publish_mask), any_integer(0),
             "MQTT: bits whose change alone causes a publish.")
           .unset("all bits"),
       Field("unconfirmed", plain(&Signal::unconfirmed), boolean(), "Meaning or scale is not established.")});
  return section;
}

const SectionOf<OverlayKeys>& overlay_section() {
  using Self = OverlayKeys;
  using Field = KeyOf<Self>;
  const auto signals = [] {
    auto key = named_key<Self>("signals", signal_section(), is_signal_name, kSignalNameRule, "By name.");
    key.fill = [](const Entry& entry, Self& into) {
      for (const Entry& signal : entry.value.entries) {
        if (signal.value.kind == NodeKind::table && is_signal_name(signal.key)) {
          into.signals.push_back({signal.key, signal.key_place, &signal.value, signal_section().read(signal.value)});
        }
      }
    };
    return key;
  };
  static const SectionOf<Self> section(
      "In a profile, a preset and a drive",
      {signals(), table_key<Self>("tpdoN", &Self::tpdos, pdo_section(), "What the drive sends."),
       table_key<Self>("rpdoN", &Self::rpdos, pdo_section(), "What it receives."),
       Field("inhibit_unit", &Self::inhibit_unit,
             choice<canopen::Duration>({{"100us", std::chrono::microseconds(100)}, {"1ms", milliseconds(1)}}),
             "What the drive counts inhibit times in; CiA 301 has 100 us."),
       Field("self_starting", &Self::self_starting, boolean(),
             "It goes operational by itself after power-up: sent pre-operational once per boot-up where it has to be "
             "configured, and where `running`, read by SDO first, is false."),
       Field("error_register", &Self::error_register, boolean(),
             "0x1001 follows the faults of the drive. Where it does not, it is shown, and neither raises nor ends an "
             "error."),
       table_key<Self>("error_control", &Self::error_control, error_control_section(), "Heartbeat."),
       table_key<Self>("sdo", &Self::sdo, sdo_section(), "SDO transfer."),
       table_key<Self>("emcy", &Self::emcy, emcy_section(), "Emergency messages."),
       table_key<Self>("identity", &Self::identity, identity_section(), "What must stand there."),
       tables_key<Self>("setup", &Self::setup, setup_section(),
                        "Further objects to write at every boot, in this order, after the profile's."),
       Field("fault_texts", &Self::fault_texts, fault_texts(kMaxInteger), "Text by the drive's own fault code.")
           .layered(Layering::by_key),
       Field("emcy_texts", &Self::emcy_texts, fault_texts(0xFFFF),
             "Text by emergency code; a code without one takes that of its class (0x2100, 0x2000).")
           .layered(Layering::by_key),
       tables_key<Self>("live", &Self::live, live_section(),
                        "Settings of the drive that `check --live` looks at, after the profile's."),
       table_key<Self>("trial", &Self::trial, trial_section(), "How to try the drive, as `demo` tells it.")});
  return section;
}

const SectionOf<PresetKeys>& preset_section() {
  using Field = KeyOf<PresetKeys>;
  static const SectionOf<PresetKeys> section("presets.NAME",
                                             {Field("text", &PresetKeys::text, text(), "What it is for.").required(),
                                              Field("unconfirmed", &PresetKeys::unconfirmed, text(),
                                                    "Why it is not established; `check` warns where it is used.")},
                                             &overlay_section());
  return section;
}

}  // namespace config

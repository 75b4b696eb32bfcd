#include "bridges/trace/decoder.h"

#include "canopen/cob_id.h"
#include "canopen/sdo/frames.h"

namespace trace {
namespace {

constexpr std::uint32_t kNodeMask = 0x7F;
// CiA 301 table 75: TPDO1 0x180, RPDO1 0x200, …, RPDO4 0x500, plus the node id.
constexpr std::uint32_t kFirstPdo = 0x181;
constexpr std::uint32_t kLastPdo = 0x57F;

}  // namespace

Decoder::Decoder(const config::Model& model, std::optional<std::size_t> bus) {
  place(model, bus);
}

void Decoder::place(const config::Model& model, std::optional<std::size_t> bus) {
  bus_ = bus ? std::optional(static_cast<std::uint16_t>(*bus)) : std::nullopt;
  places_.assign(canopen::kMaxCobId + 1, {});
  drives_ = {};
  for (std::size_t i = 0; bus && i < model.drives.size(); ++i) {
    const config::Drive& drive = model.drives[i];
    if (drive.bus == *bus && drive.node.node < kNodes) {
      const auto index = static_cast<std::uint16_t>(i);
      drives_.at(drive.node.node) = index;
      place_pdos(index, drive.node, PdoWay::transmit);
      place_pdos(index, drive.node, PdoWay::receive);
    }
  }
}

void Decoder::place_pdos(std::uint16_t drive, const canopen::NodeSettings& node, PdoWay way) {
  const std::vector<canopen::PdoSettings>& pdos = way == PdoWay::transmit ? node.tpdos : node.rpdos;
  for (std::size_t i = 0; i < pdos.size(); ++i) {
    if (pdos[i].cob_id > canopen::kNmtCobId && pdos[i].cob_id <= canopen::kMaxCobId) {
      places_[pdos[i].cob_id] = {.drive = drive,
                                 .node = node.node,
                                 .number = pdos[i].number,
                                 .mapping = static_cast<std::uint16_t>(i),
                                 .way = way};
    }
  }
}

Entry Decoder::decode(const canopen::Frame& frame, canopen::WallTime at, canopen::FrameOrigin origin) noexcept {
  Entry entry{.frame = frame, .at = at, .origin = origin, .bus = bus_};
  take_apart(entry);
  return entry;
}

Entry Decoder::lose(std::uint32_t frames, canopen::WallTime at) noexcept {
  dialogues_ = {};
  asked_ = {};
  return {
      .frame = {}, .at = at, .origin = canopen::FrameOrigin::driver, .kind = Kind::error, .bus = bus_, .lost = frames};
}

void Decoder::take_apart(Entry& entry) noexcept {
  const canopen::Frame& frame = entry.frame;
  if (frame.error) {
    entry.kind = Kind::error;
  } else if (!frame.extended && frame.id <= canopen::kMaxCobId) {
    if (const Place& place = places_[frame.id]; place.number != 0) {
      take_pdo(entry, place);
    } else {
      take_service(entry);
    }
  }
}

// CiA 301 tables 74 and 75.
void Decoder::take_service(Entry& entry) noexcept {
  const std::uint32_t id = entry.frame.id;
  const std::uint32_t node = id & kNodeMask;
  if (id == canopen::kNmtCobId) {
    entry.kind = Kind::nmt;
    belongs_to(entry, entry.frame.size >= 2 ? entry.frame.data[1] : 0U);
  } else if (id == canopen::kSyncCobId) {
    entry.kind = Kind::sync;
  } else if (id > canopen::kEmcyBase && id <= canopen::kEmcyBase + kNodeMask) {
    entry.kind = Kind::emcy;
    belongs_to(entry, node);
  } else if (id >= kFirstPdo && id <= kLastPdo && node != 0) {
    const std::uint32_t function = (id >> 7U) - 3;
    take_pdo(entry, {.number = static_cast<std::uint16_t>(function / 2 + 1),
                     .way = function % 2 == 0 ? PdoWay::transmit : PdoWay::receive});
    belongs_to(entry, node);
  } else if (id > canopen::kSdoAnswerBase && id <= canopen::kSdoRequestBase + kNodeMask && node != 0) {
    entry.kind = Kind::sdo;
    belongs_to(entry, node);
    const bool is_request = id > canopen::kSdoRequestBase;
    SdoDialogue& dialogue = dialogues_.at(node);
    if (!entry.frame.remote) {
      entry.sdo = is_request ? dialogue.on_request(entry.frame.bytes()) : dialogue.on_answer(entry.frame.bytes());
    }
    entry.sdo.by_server = !is_request;
  } else if (id > canopen::kErrorControlBase && id <= canopen::kErrorControlBase + kNodeMask) {
    take_error_control(entry);
  }
}

void Decoder::take_pdo(Entry& entry, const Place& place) const noexcept {
  entry.kind = Kind::pdo;
  entry.pdo = place.number;
  entry.way = place.way;
  if (place.drive) {
    entry.drive = place.drive;
    entry.mapping = place.mapping;
    entry.node = place.node;
  }
}

void Decoder::take_error_control(Entry& entry) noexcept {
  entry.kind = Kind::heartbeat;
  belongs_to(entry, entry.frame.id & kNodeMask);
  bool& asked = asked_.at(entry.node);
  // No state of an answer is 0 (CiA 301 §7.2.8.3.2): a drive that was away begins again, though it is still asked.
  const bool is_boot_up = entry.frame.size > 0 && entry.frame.data[0] == 0;
  entry.guarded = !entry.frame.remote && !is_boot_up && asked;
  asked = entry.frame.remote;
}

void Decoder::belongs_to(Entry& entry, std::uint32_t node) const noexcept {
  entry.node = static_cast<std::uint8_t>(node);
  entry.drive = node < kNodes ? drives_.at(node) : std::nullopt;
}

}  // namespace trace

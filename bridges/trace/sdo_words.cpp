#include "bridges/trace/object_words.h"
#include "bridges/trace/words.h"
#include "canopen/error.h"
#include "canopen/hex.h"

namespace trace {
namespace {

std::string follow(const SdoPart& part, std::string_view how) {
  return part.bytes == 0 ? std::string(how) + " follow, of unknown length"
                         : std::to_string(part.bytes) + " bytes follow in " + std::string(how);
}

std::string segment_words(const SdoPart& part, const std::string& value) {
  return part.last && part.knows_object
             ? "last segment, " + std::to_string(part.bytes) + " bytes in all: " + value
             : std::string(part.last ? "last " : "") + "segment of " + std::to_string(part.bytes) + " bytes";
}

bool is_a_write(SdoStep step) {
  return step == SdoStep::write || step == SdoStep::write_segment || step == SdoStep::write_begin ||
         step == SdoStep::written || step == SdoStep::block_write || step == SdoStep::block_write_ready;
}

// Behind the name of the object.
std::string rest_of(const SdoPart& part, const std::string& value) {
  switch (part.step) {
    case SdoStep::write:
    case SdoStep::value:
      return " = " + value;
    case SdoStep::write_begin:
    case SdoStep::value_begin:
      return ": " + follow(part, "segments");
    case SdoStep::write_segment:
    case SdoStep::value_segment:
      return ": " + segment_words(part, value);
    case SdoStep::ask_segment:
      return ": next segment asked for";
    case SdoStep::written:
      return " written";
    case SdoStep::segment_taken:
      return ": segment taken";
    case SdoStep::block_read:
      return " in blocks of up to " + std::to_string(part.number) + " segments";
    case SdoStep::block_read_ready:
    case SdoStep::block_write:
      return ": " + follow(part, "blocks");
    case SdoStep::block_read_start:
      return ": block transfer may start";
    case SdoStep::block_write_ready:
      return ": blocks of up to " + std::to_string(part.number) + " segments are taken";
    case SdoStep::block_segment:
      return ": block segment " + std::to_string(part.number) + (part.last ? ", the last" : "");
    case SdoStep::block_taken:
      return ": block taken up to segment " + std::to_string(part.number);
    case SdoStep::block_end:
      return ": end of block transfer, " + std::to_string(part.bytes) + " bytes in all: " + value;
    case SdoStep::block_end_taken:
      return ": block transfer done";
    case SdoStep::abort:
      return ": abort 0x" + canopen::hex(part.abort, 8) + ", " + std::string(canopen::abort_text(part.abort));
    case SdoStep::read:
    case SdoStep::unclear:
      break;
  }
  return {};
}

std::string_view verb_of(SdoStep step) {
  switch (step) {
    case SdoStep::read:
    case SdoStep::ask_segment:
    case SdoStep::block_read:
    case SdoStep::block_read_start:
      return "read ";
    case SdoStep::write:
    case SdoStep::write_begin:
    case SdoStep::write_segment:
    case SdoStep::block_write:
      return "write ";
    default:
      return "";
  }
}

}  // namespace

std::string sdo_words(const config::Drive* drive, const Entry& entry) {
  const SdoPart& part = entry.sdo;
  const std::string_view begin = part.by_server ? "answer: " : "";
  if (part.step == SdoStep::unclear) {
    return std::string(begin) + "not understood: " + bytes_text(entry.frame.bytes());
  }
  const PdoWay way = is_a_write(part.step) ? PdoWay::receive : PdoWay::transmit;
  const std::string name = part.knows_object ? object_name(drive, part.object, way) : "an object that was not seen";
  const std::string value = object_value(drive, part.object, way, part.value(), part.bytes);
  return std::string(begin).append(verb_of(part.step)).append(name) + rest_of(part, value);
}

}  // namespace trace

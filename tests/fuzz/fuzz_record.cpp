// Any bytes as the name of a record, and as the JSON beside it: a name that is one is exactly that text and no path,
// and what is listed of a JSON are names.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "bridges/recorder/record_name.h"
#include "bridges/recorder/record_text.h"

namespace {

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

bool is_plain(std::string_view text) {
  return text.find_first_of("/\\\"\r\n") == std::string_view::npos && text.find('\0') == std::string_view::npos &&
         !text.starts_with('.');
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (const auto name = recorder::parse_record_name(bytes)) {
    require(recorder::to_text(*name) == bytes);
    require(is_plain(bytes) && bytes.size() <= 64);
  }
  if (const auto summary = recorder::parse_summary(bytes)) {
    require(!summary->bus.empty() && is_plain(summary->bus) && is_plain(summary->drive));
    recorder::Record record{.name = {{}, "pump1", "emcy"}, .bus = summary->bus, .interface = "can0"};
    record.drive = summary->drive;
    recorder::LogFigures log{.frames = summary->frames & 0x7FFFFFFFFFFFFFFFU};
    const auto again = recorder::parse_summary(recorder::record_json(record, log));
    require(again && again->bus == summary->bus && again->drive == summary->drive && again->frames == log.frames);
  }
  return 0;
}

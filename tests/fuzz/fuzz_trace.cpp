// Any bytes as a candump log, and as frames: what comes of them is text, however little they fit.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "bridges/text/json_text.h"
#include "bridges/trace/decoder.h"
#include "bridges/trace/line.h"
#include "bridges/trace/log_decoder.h"

namespace {

canopen::MappedObject mapped(canopen::ObjectAddress object, canopen::DataType type, std::uint8_t bits) {
  return {.object = object, .type = type, .bits = bits};
}

config::Signal signal(std::string name, canopen::ObjectAddress object, canopen::DataType type, double scale,
                      unsigned decimals) {
  config::Signal made;
  made.name = std::move(name);
  made.object = object;
  made.type = type;
  made.scale = scale;
  made.decimals = decimals;
  return made;
}

config::Model make_model() {
  using canopen::DataType;
  config::Drive drive;
  drive.name = "pump1";
  drive.node.node = 5;
  drive.node.emcy.layout = canopen::EmcyLayout::class_and_vendor40;
  drive.signals = {
      signal("status_word", {0x2001, 0}, DataType::u16, 1, 0), signal("frequency", {0x2001, 1}, DataType::i16, 0.01, 2),
      signal("torque", {0x2001, 2}, DataType::f32, 1, 0), signal("running", {0x2001, 0}, DataType::u16, 1, 0)};
  drive.signals[3].derived = config::Derived{.from = 0, .mask = 3, .values = {1}};
  drive.signals[1].access = config::Access::read_write;
  drive.faults.fault_code = 1;
  drive.node.tpdos = {{.number = 1,
                       .cob_id = 0x185,
                       .mapping = {mapped({0x2001, 0}, DataType::u16, 16), mapped({0x0002, 0}, DataType::u8, 3),
                                   mapped({0x2001, 1}, DataType::i16, 13)}}};
  drive.node.rpdos = {{.number = 1,
                       .cob_id = 0x205,
                       .mapping = {mapped({0x2001, 2}, DataType::f32, 32), mapped({0x2009, 0}, DataType::u32, 31)}}};
  config::Model model;
  model.buses = {config::Bus{.name = "can0", .interface = "can0", .bitrate = {}}};
  model.drives = {drive};
  return model;
}

void check(const std::string& line) {
  if (line.find('\n') != std::string::npos || line.size() > 2000 || !text::is_utf8(line)) {
    std::abort();
  }
}

// Seven frames of eight bytes of each hundred: identifiers that mean something come often.
void take_frames(const config::Model& model, const std::uint8_t* data, std::size_t size) {
  constexpr std::uint32_t kIds[]{0x000, 0x085, 0x185, 0x205, 0x585, 0x605, 0x705, 0x385};
  trace::Decoder decoder(model, 0);
  while (size > 1) {
    canopen::Frame frame{.id = kIds[data[0] & 7U], .size = static_cast<std::uint8_t>(data[0] >> 4U & 7U)};
    frame.size = static_cast<std::uint8_t>(frame.size + 1);
    frame.error = data[0] == 0xFF;
    frame.remote = data[0] == 0xFE;
    ++data;
    --size;
    for (std::size_t i = 0; i < frame.size && size > 0; ++i, ++data, --size) {
      frame.data.at(i) = *data;
    }
    check(trace::terminal_line(trace::line_of(model, decoder.decode(frame, {}, canopen::FrameOrigin::others))));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const config::Model model = make_model();
  trace::LogDecoder log(model, {}, false,
                        {.line = [](const std::string& line) { check(line); }, .complaint = [](const std::string&) {}});
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t half = size / 2;
  log.take(text.substr(0, half));
  log.take(text.substr(half));
  log.finish();
  take_frames(model, data, size);
  return 0;
}

#pragma once

#include <string>
#include <string_view>

#include "bridges/text/json_text.h"
#include "bridges/trace/entry.h"
#include "config/model.h"

namespace trace {

/// What a line of a trace shows, as text.
struct Line {
  std::string time;   ///< `2026-01-02T03:04:05.678123Z`
  std::string bus;    ///< Its name, or the interface of a log.
  std::string frame;  ///< `185#0102…`, see candump_frame(); empty: frames were lost.
  bool own = false;
  std::string kind;
  std::string owner;  ///< See owner_of(); empty: nobody's.
  std::string name;   ///< See heading_of().
  std::string text;   ///< See words_of().
};

/// `interface`: of a frame of no bus that the model has.
[[nodiscard]] Line line_of(const config::Model& model, const Entry& entry, std::string_view interface = {});

/// Members of an object: `ts`, `bus`, `frame`, `own`, `kind`, `owner`, `name`, `text`.
void append_members(text::ObjectText& object, const Line& line);

/// For a terminal: `03:04:05.678123 can0 >605 pump1      SDO       read 0x2021:02 output_frequency`. Behind the bus
/// stands the COB-ID, before it `>` for a frame of our own, `!` for what was never on the bus.
[[nodiscard]] std::string terminal_line(const Line& line);

}  // namespace trace

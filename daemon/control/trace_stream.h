#pragma once

#include <string>

#include "bridges/trace/feed.h"
#include "daemon/control/stream.h"

namespace gateway::control {

/// The frames of the buses, `{"id":1,"ts":"…","bus":"can0",…}` (see trace::append_members()), or `{"id":1,"raw":"…"}`
/// for a candump log; `{"id":1,"lost":37}` where the client was too slow for so many.
class TraceStream final : public Stream {
 public:
  /// `id`: JSON text. `feed` outlives it.
  TraceStream(trace::Feed& feed, trace::Filter filter, std::string id, bool raw);

  [[nodiscard]] bool take(std::string& lines) override;
  [[nodiscard]] canopen::Duration pace() const override { return std::chrono::milliseconds(50); }

 private:
  /// Wording one takes some 4 us, and whoever asks by Modbus meanwhile waits for all of a piece.
  static constexpr std::size_t kMostAtOnce = 8;

  void append(std::string& lines, const trace::Entry& entry) const;

  trace::Feed::Reader reader_;
  std::string id_;
  bool raw_;
};

}  // namespace gateway::control

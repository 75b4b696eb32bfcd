#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "canopen/frame.h"
#include "simulator/object_dictionary.h"
#include "simulator/record.h"
#include "simulator/traits.h"

namespace simulator {

/// The drive's SDO server: expedited and segmented, no block transfer (CiA 301 §7.2.4.3).
class SdoServer {
 public:
  using Style = std::function<AnswerStyle(Address, bool write)>;
  /// Why an object that exists is not to be written now; `none` where it may.
  using WriteRefusal = std::function<Abort(Address)>;

  /// Why an object that exists is said not to; `none` where it is not denied.
  using Denial = std::function<Abort(Address)>;

  SdoServer(std::uint8_t node, ObjectDictionary& dictionary, Record& record, Style style, WriteRefusal write_refusal,
            Denial denial);

  /// At each start of the communication; ends a transfer.
  void start(const Traits& traits);
  /// The answer, or nothing where the drive keeps silent.
  [[nodiscard]] std::optional<canopen::Frame> handle(const canopen::Frame& request);

 private:
  enum class Transfer : std::uint8_t { none, upload, download };

  /// Why there is no such object; `none` where there is one.
  [[nodiscard]] Abort absence(const Object* object) const;
  [[nodiscard]] canopen::Frame start_download(const canopen::Frame& request);
  [[nodiscard]] canopen::Frame download_expedited(const canopen::Frame& request, Object& object);
  [[nodiscard]] canopen::Frame download_segment(const canopen::Frame& request);
  [[nodiscard]] Abort finish_download();
  [[nodiscard]] canopen::Frame start_upload();
  [[nodiscard]] canopen::Frame upload_segment(const canopen::Frame& request);
  [[nodiscard]] Abort store_text(Object& object);
  [[nodiscard]] canopen::Frame refuse(Abort abort);
  [[nodiscard]] canopen::Frame initiate_answer(std::uint8_t command) const;
  [[nodiscard]] canopen::Frame write_done(const Object& object);

  std::uint8_t node_;
  ObjectDictionary& dictionary_;
  Record& record_;
  Style style_;
  WriteRefusal write_refusal_;
  Denial denial_;
  bool short_requests_ = false;
  bool segmented_ = true;
  std::vector<Abort> known_aborts_;

  Address address_;  ///< of the transfer, or of the last request
  Transfer transfer_ = Transfer::none;
  std::string buffer_;
  std::size_t sent_ = 0;
  std::uint32_t announced_ = 0;  ///< bytes of a segmented download; 0: not said
  std::uint8_t toggle_ = 0;
};

}  // namespace simulator

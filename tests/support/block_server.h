#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "canopen/frame.h"
#include "canopen/object.h"
#include "tests/support/block_codec.h"
#include "tests/support/block_faults.h"
#include "tests/support/block_receiver.h"
#include "tests/support/block_sender.h"

namespace support {

/// An SDO server without a bus and without time: a request goes in, the frames of its answer come out. Expedited,
/// segmented and block transfers after CiA 301 §7.2.4.3. It is strict: a frame that is not eight bytes long is no SDO,
/// and a bit or byte that the standard keeps at 0 has to be 0, else it aborts with 0504 0001h.
class BlockServer {
 public:
  using Bytes = block::Bytes;

  /// `node` is 1..127: requests come on 0x600 + node, answers go on 0x580 + node.
  explicit BlockServer(std::uint8_t node) : node_(node) {}

  /// The dictionary. A download changes it with the confirmation of its last frame, never before.
  std::map<canopen::ObjectAddress, Bytes> objects;
  /// Objects that take no data of another length than they have.
  std::set<canopen::ObjectAddress> fixed_lengths;
  /// Objects whose transfers are refused with this code, up and down.
  std::map<canopen::ObjectAddress, std::uint32_t> refused;
  block::Faults faults;

  /// Nothing for what is no request to this server, and where the protocol has no answer.
  [[nodiscard]] std::vector<canopen::Frame> answer(const canopen::Frame& request);

  /// What the client aborted so far.
  [[nodiscard]] const std::vector<block::Abort>& aborts_heard() const noexcept { return aborts_heard_; }
  /// Whether no transfer is under way.
  [[nodiscard]] bool idle() const noexcept { return std::holds_alternative<std::monostate>(transfer_); }

 private:
  using Content = block::Content;
  using Contents = std::vector<Content>;
  /// Data on their way in segments that are confirmed one by one.
  struct SegmentedDownload {
    canopen::ObjectAddress object;
    std::optional<std::uint32_t> size;
    bool toggle = false;
    Bytes data{};
  };
  struct SegmentedUpload {
    canopen::ObjectAddress object;
    Bytes data;
    bool toggle = false;
    std::size_t offset = 0;
  };
  using Transfer =
      std::variant<std::monostate, SegmentedDownload, SegmentedUpload, block::BlockReceiver, block::BlockSender>;

  [[nodiscard]] Contents reaction(const Content& request);
  [[nodiscard]] Contents initiate_download(const Content& request);
  [[nodiscard]] Contents download_expedited(const Content& request);
  [[nodiscard]] Contents download_segment(const Content& request);
  [[nodiscard]] Contents initiate_upload(const Content& request);
  [[nodiscard]] Contents upload(canopen::ObjectAddress object);
  [[nodiscard]] Contents upload_segment(const Content& request);

  [[nodiscard]] Contents initiate_block_download(const Content& request);
  [[nodiscard]] Contents block_segment(block::BlockReceiver& receiver, const Content& segment);
  [[nodiscard]] Contents acknowledge(block::BlockReceiver& receiver);
  [[nodiscard]] Contents end_block_download(const Content& request);
  [[nodiscard]] Contents block_upload(const Content& request);
  [[nodiscard]] Contents initiate_block_upload(const Content& request);
  [[nodiscard]] Contents block_acknowledged(block::BlockSender& sender, const Content& request);
  [[nodiscard]] Contents sub_block(block::BlockSender& sender);

  /// Why the object takes part in no transfer.
  [[nodiscard]] std::optional<std::uint32_t> refusal(canopen::ObjectAddress object) const;
  /// Why it takes no data of this length.
  [[nodiscard]] std::optional<std::uint32_t> length_refusal(canopen::ObjectAddress object, std::size_t size) const;
  /// The last frame of a download, or the abort for the length.
  [[nodiscard]] Contents finish_download(canopen::ObjectAddress object, std::optional<std::uint32_t> size, Bytes data,
                                         const Content& confirmation);
  [[nodiscard]] std::uint8_t block_size(unsigned sub_block) const;
  [[nodiscard]] std::uint32_t indicated_size(const Bytes& data) const;
  [[nodiscard]] canopen::ObjectAddress object_of_transfer() const;
  /// The abort that ends the transfer under way; the second names an object where none is.
  [[nodiscard]] Contents abort(std::uint32_t code);
  [[nodiscard]] Contents abort(canopen::ObjectAddress object, std::uint32_t code);

  [[nodiscard]] std::vector<canopen::Frame> sent(const Contents& contents);

  std::uint8_t node_;
  Transfer transfer_;
  std::optional<std::pair<canopen::ObjectAddress, Bytes>> downloaded_;
  std::vector<block::Abort> aborts_heard_;
};

}  // namespace support

// The SDO download and the SDO upload, expedited and in segments (CiA 301 §7.2.4.3.3 to 7).
#include <algorithm>

#include "tests/support/block_server.h"

namespace support {

using block::command;
using block::field;
using block::multiplexer;
using block::zero_from;
using canopen::ObjectAddress;

BlockServer::Contents BlockServer::initiate_download(const Content& request) {
  const ObjectAddress object = multiplexer(request);
  transfer_ = std::monostate();
  const bool size_indicated = field(request, 0, 1) != 0;
  const bool expedited = field(request, 1, 1) != 0;
  const bool n_valid = expedited && size_indicated;
  if (field(request, 4, 1) != 0 || (!n_valid && field(request, 2, 2) != 0) ||
      (!expedited && !size_indicated && !zero_from(request, 4))) {
    return abort(object, block::kCommandSpecifier);
  }
  if (const auto code = refusal(object)) {
    return abort(object, *code);
  }
  if (expedited) {
    return download_expedited(request);
  }
  std::optional<std::uint32_t> size;
  if (size_indicated) {
    size = block::get_u32(request, 4);
    if (const auto code = length_refusal(object, *size)) {
      return abort(object, *code);
    }
  }
  transfer_ = SegmentedDownload{.object = object, .size = size};
  return {command(0x60, object)};
}

BlockServer::Contents BlockServer::download_expedited(const Content& request) {
  const ObjectAddress object = multiplexer(request);
  std::size_t size = 4U - field(request, 2, 2);
  if (field(request, 0, 1) == 0) {
    // How many of the four bytes are meant, the object has to know.
    const std::size_t length = objects.at(object).size();
    size = length >= 1 && length <= 4 ? length : 4;
  }
  const auto data = std::span(request).subspan(4, size);
  return finish_download(object, std::nullopt, {data.begin(), data.end()}, command(0x60, object));
}

BlockServer::Contents BlockServer::download_segment(const Content& request) {
  auto* download = std::get_if<SegmentedDownload>(&transfer_);
  if (download == nullptr) {
    return abort(block::kCommandSpecifier);
  }
  const bool toggle = field(request, 4, 1) != 0;
  if (toggle != download->toggle) {
    return abort(block::kToggleBit);
  }
  download->toggle = !toggle;
  const auto data = std::span(request).subspan(1, block::kSegmentBytes - field(request, 1, 3));
  download->data.insert(download->data.end(), data.begin(), data.end());
  const Content confirmation = command(toggle ? 0x30 : 0x20);
  if (field(request, 0, 1) == 0) {
    return {confirmation};
  }
  SegmentedDownload done = std::move(*download);
  return finish_download(done.object, done.size, std::move(done.data), confirmation);
}

BlockServer::Contents BlockServer::initiate_upload(const Content& request) {
  const ObjectAddress object = multiplexer(request);
  transfer_ = std::monostate();
  if (field(request, 0, 5) != 0 || !zero_from(request, 4)) {
    return abort(object, block::kCommandSpecifier);
  }
  if (const auto code = refusal(object)) {
    return abort(object, *code);
  }
  return upload(object);
}

BlockServer::Contents BlockServer::upload(ObjectAddress object) {
  const Bytes& data = objects.at(object);
  if (!data.empty() && data.size() <= 4) {
    Content content = command(0x43U | static_cast<unsigned>(4 - data.size()) << 2U, object);
    std::ranges::copy(data, content.begin() + 4);
    return {content};
  }
  Content content = command(faults.size_indicated ? 0x41 : 0x40, object);
  if (faults.size_indicated) {
    block::put_u32(content, 4, indicated_size(data));
  }
  transfer_ = SegmentedUpload{.object = object, .data = data};
  return {content};
}

BlockServer::Contents BlockServer::upload_segment(const Content& request) {
  auto* upload = std::get_if<SegmentedUpload>(&transfer_);
  if (upload == nullptr || field(request, 0, 4) != 0 || !zero_from(request, 1)) {
    return abort(block::kCommandSpecifier);
  }
  const bool toggle = field(request, 4, 1) != 0;
  if (toggle != upload->toggle) {
    return abort(block::kToggleBit);
  }
  upload->toggle = !toggle;
  Content content{};
  const std::size_t bytes = block::put_segment(content, upload->data, upload->offset);
  upload->offset += bytes;
  const bool last = upload->offset == upload->data.size();
  content[0] = static_cast<std::uint8_t>((toggle ? 0x10U : 0U) |
                                         static_cast<unsigned>(block::kSegmentBytes - bytes) << 1U | (last ? 1U : 0U));
  if (last) {
    transfer_ = std::monostate();
  }
  return {content};
}

}  // namespace support

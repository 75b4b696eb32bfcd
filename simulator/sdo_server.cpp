#include "simulator/sdo_server.h"

#include <algorithm>
#include <utility>

namespace simulator {
namespace {

constexpr std::size_t kSegment = 7;
constexpr std::size_t kLongestText = 64;

std::uint32_t data_of(const canopen::Frame& frame, unsigned size) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < size; ++i) {
    value |= static_cast<std::uint32_t>(frame.data[4 + i]) << (8 * i);
  }
  return value;
}

void put(canopen::Frame& frame, std::uint32_t value) {
  for (unsigned i = 0; i < 4; ++i) {
    frame.data[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

/// The bytes an initiate request needs: 4, and for an expedited download its data.
std::uint8_t bytes_needed(std::uint8_t command) {
  if ((command & 0xE2U) == 0x22) {
    const unsigned unused = (command & 1U) != 0 ? (command >> 2U) & 3U : 3U;
    return static_cast<std::uint8_t>(8U - unused);
  }
  return 4;
}

}  // namespace

SdoServer::SdoServer(std::uint8_t node, ObjectDictionary& dictionary, Record& record, Style style,
                     WriteRefusal write_refusal, Denial denial)
    : node_(node),
      dictionary_(dictionary),
      record_(record),
      style_(std::move(style)),
      write_refusal_(std::move(write_refusal)),
      denial_(std::move(denial)) {}

void SdoServer::start(const Traits& traits) {
  short_requests_ = traits.short_sdo_requests;
  segmented_ = traits.segmented_sdo;
  known_aborts_ = traits.known_aborts;
  transfer_ = Transfer::none;
}

std::optional<canopen::Frame> SdoServer::handle(const canopen::Frame& request) {
  if (request.size == 0 || (request.size < 8 && (!short_requests_ || request.size < bytes_needed(request.data[0])))) {
    return std::nullopt;  // CiA 301 §7.2.4.3: an SDO has eight bytes; anything else is no SDO.
  }
  const std::uint8_t command = request.data[0];
  const unsigned specifier = command >> 5U;
  if (specifier == 4) {
    transfer_ = Transfer::none;
    return std::nullopt;
  }
  if (specifier == 1 || specifier == 2) {
    transfer_ = Transfer::none;
    address_ = {static_cast<std::uint16_t>(request.data[1] | (request.data[2] << 8U)), request.data[3]};
    return specifier == 1 ? start_download(request) : start_upload();
  }
  if (specifier == 0 && transfer_ == Transfer::download) {
    return download_segment(request);
  }
  if (specifier == 3 && transfer_ == Transfer::upload) {
    return upload_segment(request);
  }
  if (specifier > 4) {
    address_ = {static_cast<std::uint16_t>(request.data[1] | (request.data[2] << 8U)), request.data[3]};
  }
  return refuse(Abort::unknown_command);
}

canopen::Frame SdoServer::initiate_answer(std::uint8_t command) const {
  canopen::Frame frame;
  frame.id = 0x580U + node_;
  frame.size = 8;
  frame.data[0] = command;
  frame.data[1] = static_cast<std::uint8_t>(address_.index);
  frame.data[2] = static_cast<std::uint8_t>(address_.index >> 8U);
  frame.data[3] = address_.sub;
  return frame;
}

canopen::Frame SdoServer::refuse(Abort abort) {
  transfer_ = Transfer::none;
  record_.note_refusal(address_);
  if (!known_aborts_.empty() && std::find(known_aborts_.begin(), known_aborts_.end(), abort) == known_aborts_.end()) {
    abort = Abort::general;
  }
  canopen::Frame frame = initiate_answer(0x80);
  put(frame, static_cast<std::uint32_t>(abort));
  return frame;
}

Abort SdoServer::absence(const Object* object) const {
  return object == nullptr ? dictionary_.absence(address_) : denial_(address_);
}

canopen::Frame SdoServer::start_download(const canopen::Frame& request) {
  Object* object = dictionary_.find(address_);
  if (const Abort absent = absence(object); absent != Abort::none) {
    return refuse(absent);
  }
  if (object->access == Access::read_only) {
    return refuse(Abort::read_only);
  }
  if (const Abort refusal = write_refusal_(address_); refusal != Abort::none) {
    return refuse(refusal);
  }
  if ((request.data[0] & 0x02U) != 0) {
    return download_expedited(request, *object);
  }
  if (!segmented_) {
    return refuse(Abort::unknown_command);
  }
  announced_ = (request.data[0] & 1U) != 0 ? data_of(request, 4) : 0;
  if (announced_ > kLongestText) {
    return refuse(Abort::too_long);
  }
  transfer_ = Transfer::download;
  buffer_.clear();
  toggle_ = 0;
  return initiate_answer(0x60);
}

canopen::Frame SdoServer::download_expedited(const canopen::Frame& request, Object& object) {
  const std::uint8_t command = request.data[0];
  const bool sized = (command & 1U) != 0;
  if (object.is_string()) {
    const std::size_t size = sized ? 4U - ((command >> 2U) & 3U) : 4U;
    buffer_.clear();
    for (std::size_t i = 0; i < size; ++i) {
      buffer_.push_back(static_cast<char>(request.data[4 + i]));
    }
    const Abort abort = store_text(object);
    return abort == Abort::none ? write_done(object) : refuse(abort);
  }
  // Without a size bit the dictionary knows the length.
  const unsigned size = sized ? 4U - ((command >> 2U) & 3U) : object.size;
  if (size != object.size) {
    return refuse(Abort::wrong_length);
  }
  const Abort abort = ObjectDictionary::write(object, data_of(request, size));
  return abort == Abort::none ? write_done(object) : refuse(abort);
}

canopen::Frame SdoServer::write_done(const Object& object) {
  ++record_.sdo_writes[address_];
  const AnswerStyle style = style_(address_, true);
  if (style.upload_for_write && !object.is_string() && object.access != Access::write_only) {
    canopen::Frame frame = initiate_answer(static_cast<std::uint8_t>(0x43U | ((4U - object.size) << 2U)));
    put(frame, ObjectDictionary::read(object));
    return frame;
  }
  canopen::Frame frame = initiate_answer(0x60);
  if (style.trimmed) {
    frame.size = 4;
  }
  return frame;
}

Abort SdoServer::store_text(Object& object) {
  if (buffer_.size() > kLongestText) {
    return Abort::too_long;
  }
  object.text = buffer_;
  return Abort::none;
}

canopen::Frame SdoServer::download_segment(const canopen::Frame& request) {
  const std::uint8_t command = request.data[0];
  if ((command & 0x10U) != toggle_) {
    return refuse(Abort::toggle);
  }
  const std::size_t used = kSegment - ((command >> 1U) & 7U);
  for (std::size_t i = 0; i < used; ++i) {
    buffer_.push_back(static_cast<char>(request.data[1 + i]));
  }
  if (buffer_.size() > kLongestText) {
    return refuse(Abort::too_long);
  }
  canopen::Frame answer;
  answer.id = 0x580U + node_;
  answer.size = 8;
  answer.data[0] = static_cast<std::uint8_t>(0x20U | toggle_);
  toggle_ ^= 0x10U;
  if ((command & 1U) == 0) {
    return answer;
  }
  transfer_ = Transfer::none;
  const Abort abort = finish_download();
  if (abort != Abort::none) {
    return refuse(abort);
  }
  ++record_.sdo_writes[address_];
  return answer;
}

Abort SdoServer::finish_download() {
  Object* object = dictionary_.find(address_);
  if (object == nullptr) {
    return Abort::general;
  }
  if (announced_ != 0 && announced_ != buffer_.size()) {
    return Abort::wrong_length;
  }
  if (object->is_string()) {
    return store_text(*object);
  }
  if (buffer_.size() != object->size) {
    return Abort::wrong_length;
  }
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < buffer_.size(); ++i) {
    value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(buffer_[i])) << (8 * i);
  }
  return ObjectDictionary::write(*object, value);
}

canopen::Frame SdoServer::start_upload() {
  Object* object = dictionary_.find(address_);
  if (const Abort absent = absence(object); absent != Abort::none) {
    return refuse(absent);
  }
  if (object->access == Access::write_only) {
    return refuse(Abort::write_only);
  }
  if (object->present && !object->present()) {
    return refuse(Abort::no_data);
  }
  ++record_.sdo_reads[address_];
  if (object->is_string() && object->text.size() > 4) {
    transfer_ = Transfer::upload;
    buffer_ = object->text;
    sent_ = 0;
    toggle_ = 0;
    canopen::Frame frame = initiate_answer(0x41);
    put(frame, static_cast<std::uint32_t>(buffer_.size()));
    return frame;
  }
  if (object->is_string()) {
    const auto size = static_cast<unsigned>(object->text.size());
    if (size == 0) {
      return refuse(Abort::no_data);
    }
    canopen::Frame frame = initiate_answer(static_cast<std::uint8_t>(0x43U | ((4U - size) << 2U)));
    std::copy(object->text.begin(), object->text.end(), frame.data.begin() + 4);
    return frame;
  }
  const AnswerStyle style = style_(address_, false);
  const unsigned size = style.four_bytes && object->size == 2 ? 4U : object->size;
  canopen::Frame frame = initiate_answer(static_cast<std::uint8_t>(0x43U | ((4U - size) << 2U)));
  put(frame, ObjectDictionary::read(*object));
  if (style.trimmed) {
    frame.size = static_cast<std::uint8_t>(4U + size);
  }
  return frame;
}

canopen::Frame SdoServer::upload_segment(const canopen::Frame& request) {
  if ((request.data[0] & 0x10U) != toggle_) {
    return refuse(Abort::toggle);
  }
  const std::size_t count = std::min(kSegment, buffer_.size() - sent_);
  canopen::Frame answer;
  answer.id = 0x580U + node_;
  answer.size = 8;
  for (std::size_t i = 0; i < count; ++i) {
    answer.data[1 + i] = static_cast<std::uint8_t>(buffer_[sent_ + i]);
  }
  sent_ += count;
  const bool last = sent_ == buffer_.size();
  answer.data[0] = static_cast<std::uint8_t>(toggle_ | ((kSegment - count) << 1U) | (last ? 1U : 0U));
  toggle_ ^= 0x10U;
  if (last) {
    transfer_ = Transfer::none;
  }
  return answer;
}

}  // namespace simulator

#include "simulator/object_dictionary.h"

#include <utility>

namespace simulator {

Object& ObjectDictionary::add(Address address, Object object) {
  return objects_.insert_or_assign(address, std::move(object)).first->second;
}

Object& ObjectDictionary::add_constant(Address address, std::uint8_t size, std::uint32_t value) {
  Object object;
  object.size = size;
  object.access = Access::read_only;
  object.value = value;
  return add(address, std::move(object));
}

Object& ObjectDictionary::add_text(Address address, std::string text) {
  Object object;
  object.size = 0;
  object.access = Access::read_only;
  object.text = std::move(text);
  return add(address, std::move(object));
}

Object& ObjectDictionary::add_reading(Address address, std::uint8_t size, std::function<std::uint32_t()> read,
                                      Mappable mappable) {
  Object object;
  object.size = size;
  object.access = Access::read_only;
  object.mappable = mappable;
  object.read = std::move(read);
  return add(address, std::move(object));
}

void ObjectDictionary::clear() {
  objects_.clear();
  fallback_ = nullptr;
}

Object* ObjectDictionary::find(Address address) {
  if (const auto found = objects_.find(address); found != objects_.end()) {
    return &found->second;
  }
  if (fallback_) {
    if (auto made = fallback_(address)) {
      return &add(address, std::move(*made));
    }
  }
  return nullptr;
}

Abort ObjectDictionary::absence(Address address) const {
  const auto any = objects_.lower_bound({address.index, 0});
  const bool index_exists = any != objects_.end() && any->first.index == address.index;
  return index_exists ? Abort::no_sub_index : Abort::no_object;
}

std::uint32_t ObjectDictionary::read(const Object& object) {
  return cut(object.read ? object.read() : object.value, object.size);
}

Abort ObjectDictionary::write(Object& object, std::uint32_t value) {
  if (object.write) {
    return object.write(cut(value, object.size));
  }
  object.value = cut(value, object.size);
  return Abort::none;
}

}  // namespace simulator

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace canopen {

/// Who wants to know of one kind of event. Handlers may come and go while one runs: a new one is first called for the
/// next event, a removed one never again, and none is destroyed while it runs.
template <class... Arguments>
class HandlerList {
 public:
  using Handler = std::function<void(Arguments...)>;

  /// Returns what remove() takes.
  std::uint64_t add(Handler handler) {
    entries_.push_back({++last_id_, std::make_unique<Handler>(std::move(handler))});
    return last_id_;
  }

  void remove(std::uint64_t id) {
    for (Entry& entry : entries_) {
      if (entry.id == id) {
        entry.id = 0;
        removed_ = true;
      }
    }
    if (running_ == 0) {
      erase_removed();
    }
  }

  void call(Arguments... arguments) {
    if (entries_.empty()) {
      return;
    }
    const Running guard(*this);
    // By position, and only those of now: a handler may add others and move the entries.
    const std::size_t count = entries_.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (entries_[i].id != 0) {
        (*entries_[i].handler)(arguments...);
      }
    }
  }

 private:
  struct Entry {
    std::uint64_t id;  ///< 0: removed.
    std::unique_ptr<Handler> handler;
  };

  class Running {
   public:
    explicit Running(HandlerList& list) : list_(list) { ++list_.running_; }
    ~Running() {
      if (--list_.running_ == 0) {
        list_.erase_removed();
      }
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

   private:
    HandlerList& list_;
  };

  void erase_removed() {
    if (std::exchange(removed_, false)) {
      std::erase_if(entries_, [](const Entry& entry) { return entry.id == 0; });
    }
  }

  std::vector<Entry> entries_;
  std::uint64_t last_id_ = 0;
  std::uint32_t running_ = 0;
  bool removed_ = false;
};

}  // namespace canopen

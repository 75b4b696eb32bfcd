#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <vector>

#include "bridges/trace/decoder.h"
#include "bridges/trace/entry.h"
#include "bridges/trace/filter.h"
#include "canopen/bus/bus.h"
#include "config/model.h"

namespace trace {

/// The newest frames of all buses, taken apart, for any number of readers who each take them at their own pace. While
/// nobody reads it does nothing and keeps nothing. A reader that does not keep up loses the oldest ones, counted;
/// nobody waits for him, and a frame costs the same however many there are.
class Feed {
 public:
  /// Frames that are kept: of a full bus of 1 Mbit/s half a second.
  static constexpr std::size_t kKept = 4096;

  /// `buses` in the order of the model's; all outlive the feed.
  Feed(const config::Model& model, std::vector<canopen::Bus*> buses);
  ~Feed();
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  /// The configuration is another one, of which `from_drives` and `from_buses` tell what is the same as before (see
  /// config::Difference). Readers go on; frames that wait for them are of the drives that there are now. The model of
  /// before is still there.
  void change(const config::Model& model, std::vector<canopen::Bus*> buses, const config::Positions& from_drives,
              const config::Positions& from_buses);

  /// One who reads, from the next frame on. Once the feed is gone there is nothing more.
  class Reader {
   public:
    /// Frames that one take() looks at, whether they pass or not: some microseconds.
    static constexpr std::size_t kMostLooked = 256;

    Reader(Feed& feed, Filter filter);
    ~Reader();
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    /// Hands the next frame that passes to `show`, and further ones, `most` at most. True: there are more to look at.
    template <class Show>
    bool take(std::size_t most, Show show) {
      catch_up();
      for (std::size_t looked = 0; looked < kMostLooked; ++looked) {
        const Entry* const entry = next();
        if (entry == nullptr) {
          return false;
        }
        if (passes(*model_, filter_, *entry)) {
          if (most == 0) {
            return true;
          }
          --most;
          show(*entry);
        }
        ++next_;
      }
      return next() != nullptr;
    }
    /// Frames that were overtaken before they were looked at, since this was asked last. So many of those that would
    /// have passed are missing at most: nobody looks at them any more.
    [[nodiscard]] std::uint64_t take_lost() noexcept;
    [[nodiscard]] const config::Model& model() const noexcept { return *model_; }

   private:
    friend class Feed;
    /// Passes over what was overtaken.
    void catch_up() noexcept;
    /// The next frame; null: there is none yet.
    [[nodiscard]] const Entry* next() noexcept;

    Feed* feed_;  ///< Null: it is gone.
    const config::Model* model_;
    Filter filter_;
    std::uint64_t next_;
    std::uint64_t lost_ = 0;
  };

  [[nodiscard]] const config::Model& model() const noexcept { return *model_; }
  [[nodiscard]] std::size_t readers() const noexcept { return readers_.size(); }

 private:
  class Tap;

  void begin();
  void end();
  void push(const Entry& entry);
  [[nodiscard]] std::uint64_t oldest() const noexcept { return next_ < kKept ? 0 : next_ - kKept; }
  [[nodiscard]] Entry& at(std::uint64_t number) noexcept { return entries_[number % kKept]; }

  const config::Model* model_;
  std::vector<canopen::Bus*> buses_;
  std::vector<std::unique_ptr<Tap>> taps_;
  std::vector<Entry> entries_;  ///< A ring.
  std::uint64_t next_ = 0;      ///< The number of the next entry.
  std::list<Reader*> readers_;
};

}  // namespace trace

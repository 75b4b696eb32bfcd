#include "bridges/trace/feed.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bridges/trace/words.h"
#include "config/difference.h"
#include "tests/support/bus_fixture.h"
#include "tests/support/frame.h"
#include "tests/unit/trace/site.h"

namespace trace {
namespace {

using canopen::Clock;
using canopen::Received;
using testing::ElementsAre;
using testing::IsEmpty;

// Two buses of the site, whose frames a test makes by hand.
class TraceFeed : public testing::Test {
 protected:
  TraceFeed() {
    for (std::size_t i = 0; i < 2; ++i) {
      buses_.push_back(std::make_unique<canopen::Bus>(
          loop_.executor(), std::make_unique<support::HandLink>(events_.at(i)), support::kQuiet));
      buses_.back()->start();
      events_.at(i)->on_bus_state({canopen::BusCondition::error_active, 0, 0});
    }
    feed_ = std::make_unique<Feed>(model_, std::vector{buses_[0].get(), buses_[1].get()});
  }

  void hear(std::uint32_t id, std::uint8_t byte, std::size_t bus = 0) {
    const Received received{support::frame(id, byte), Clock::now(), canopen::wall_now()};
    events_.at(bus)->on_frames({&received, 1});
  }
  std::unique_ptr<Feed::Reader> reader(const FilterWords& words = {}) {
    return std::make_unique<Feed::Reader>(*feed_, make_filter(model_, words).value());
  }
  std::vector<std::string> take(Feed::Reader& reader, std::size_t most = 100) {
    std::vector<std::string> told;
    more_ = reader.take(most, [&](const Entry& entry) { told.push_back(words_of(model_, entry)); });
    return told;
  }
  std::size_t count_all(Feed::Reader& reader) {
    std::size_t count = 0;
    do {
      count += take(reader).size();
    } while (more_);
    return count;
  }

  support::HandDrivenLoop loop_;
  config::Model model_ = test::site();
  std::array<canopen::LinkEvents*, 2> events_{};
  std::vector<std::unique_ptr<canopen::Bus>> buses_;
  std::unique_ptr<Feed> feed_;
  bool more_ = false;
};

TEST_F(TraceFeed, AReaderHearsAllBusesFromItsBeginOn) {
  hear(0x705, 4);
  const auto one = reader();
  hear(0x705, 5);
  hear(0x706, 0x7F, 1);
  const Received own{support::frame(0x77F, 5), Clock::now(), canopen::wall_now()};
  events_[0]->on_echo(own);
  const auto late = reader({.names = "can1"});
  events_[1]->on_frames_lost(3);
  EXPECT_THAT(take(*one, 3), ElementsAre("operational", "pre-operational", "operational"));
  EXPECT_TRUE(more_);
  EXPECT_EQ(take(*one).size(), 1U);
  EXPECT_FALSE(more_);
  EXPECT_EQ(take(*late).size(), 1U) << "the lost ones";
  EXPECT_THAT(take(*late), IsEmpty());
  EXPECT_EQ(one->take_lost(), 0U);
}

TEST_F(TraceFeed, WhileNobodyReadsItDoesNothing) {
  EXPECT_EQ(feed_->readers(), 0U);
  {
    const auto one = reader();
    const auto two = reader();
    EXPECT_EQ(feed_->readers(), 2U);
    hear(0x705, 5);
  }
  EXPECT_EQ(feed_->readers(), 0U);
  hear(0x705, 4);
  const auto again = reader();
  EXPECT_THAT(take(*again), IsEmpty()) << "what came meanwhile nobody kept";
}

TEST_F(TraceFeed, ASlowReaderLosesTheOldestAndTheyAreCounted) {
  const auto slow = reader();
  const auto slow_and_choosy = reader({.kinds = "emcy"});
  const auto of_another_bus = reader({.names = "can1"});
  const auto quick = reader();
  hear(0x085, 5);
  std::size_t taken = 0;
  const std::size_t count = Feed::kKept + 10;
  for (std::size_t i = 1; i < count; ++i) {
    hear(0x705, i % 2 == 0 ? 5 : 4);
    taken += take(*quick).size();
  }
  EXPECT_EQ(taken, count);
  EXPECT_EQ(quick->take_lost(), 0U);
  EXPECT_EQ(slow->take_lost(), 10U);
  EXPECT_EQ(slow->take_lost(), 0U) << "told once";
  EXPECT_EQ(slow_and_choosy->take_lost(), 10U) << "whether it wanted them nobody looked";
  EXPECT_EQ(count_all(*slow), Feed::kKept);
  EXPECT_EQ(count_all(*slow_and_choosy), 0U);
  hear(0x085, 6);
  EXPECT_EQ(take(*slow_and_choosy).size(), 1U) << "it goes on";
  EXPECT_EQ(slow->take_lost(), 0U) << "it has taken all before";
  EXPECT_EQ(count_all(*of_another_bus), 0U);
  EXPECT_EQ(of_another_bus->take_lost(), 11U) << "counted though take() passed over them";
}

// Nothing of it passes: that keeps nobody waiting.
TEST_F(TraceFeed, OnePieceLooksAtSoManyFrames) {
  const auto choosy = reader({.kinds = "emcy"});
  for (std::size_t i = 0; i < 2 * Feed::Reader::kMostLooked; ++i) {
    hear(0x705, 5);
  }
  hear(0x085, 5);
  EXPECT_THAT(take(*choosy), IsEmpty());
  EXPECT_TRUE(more_);
  EXPECT_THAT(take(*choosy), IsEmpty());
  EXPECT_TRUE(more_);
  EXPECT_EQ(take(*choosy).size(), 1U);
  EXPECT_FALSE(more_);
  for (std::size_t i = 0; i < Feed::Reader::kMostLooked; ++i) {
    hear(0x705, 5);
  }
  EXPECT_THAT(take(*choosy), IsEmpty());
  EXPECT_FALSE(more_) << "that was all";
}

// As where the program is unwound by an exception.
TEST_F(TraceFeed, AReaderMayOutliveIt) {
  const auto one = reader();
  const auto two = reader();
  hear(0x705, 5);
  feed_.reset();
  EXPECT_THAT(take(*one), IsEmpty());
  EXPECT_FALSE(more_);
  EXPECT_EQ(two->take_lost(), 0U);
}

TEST_F(TraceFeed, AReaderGoesOnWhereTheConfigurationChanges) {
  const auto all = reader();
  const auto named = reader({.names = model_.drives[0].name});
  hear(0x700 + model_.drives[0].node.node, 5);
  hear(0x706, 0x7F, 1);
  // The buses change places, and the drives, of which the last one goes.
  config::Model now = model_;
  std::swap(now.buses[0], now.buses[1]);
  now.drives.pop_back();
  std::ranges::reverse(now.drives);
  for (config::Drive& drive : now.drives) {
    drive.bus = 1 - drive.bus;
  }
  const config::Difference same = config::difference(model_, now);
  feed_->change(now, {buses_[1].get(), buses_[0].get()}, same.drives, same.buses);
  EXPECT_EQ(&feed_->model(), &now);
  hear(0x700 + model_.drives[0].node.node, 4);
  std::vector<std::string> drives;
  named->take(100, [&](const Entry& entry) { drives.push_back(now.drives.at(entry.drive.value()).name); });
  EXPECT_THAT(drives, ElementsAre(model_.drives[0].name, model_.drives[0].name));
  std::vector<std::string> buses;
  all->take(100, [&](const Entry& entry) { buses.push_back(now.buses.at(entry.bus.value()).name); });
  EXPECT_THAT(buses, ElementsAre(model_.buses[0].name, model_.buses[1].name, model_.buses[0].name));
  EXPECT_EQ(all->take_lost(), 0U);
}

TEST_F(TraceFeed, FramesOfABusThatWentAreShownToNobody) {
  const auto all = reader();
  hear(0x705, 5);
  hear(0x706, 0x7F, 1);
  config::Model now = model_;
  std::erase_if(now.drives, [](const config::Drive& drive) { return drive.bus == 1; });
  now.buses.pop_back();
  const config::Difference same = config::difference(model_, now);
  feed_->change(now, {buses_[0].get()}, same.drives, same.buses);
  hear(0x706, 0x7F, 1);
  hear(0x705, 4);
  EXPECT_THAT(take(*all), ElementsAre("operational", "stopped"));
}

}  // namespace
}  // namespace trace

#include "daemon/http/live.h"

#include <gmock/gmock.h>

#include <string>

#include "tests/unit/daemon/http/shown_plant.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class HttpLive : public test::ShownPlant {
 protected:
  std::string take(Live::Place& place) {
    return live_.take(place, [] { return std::string("{}"); });
  }
};

TEST_F(HttpLive, AReaderBeginsWithAll) {
  Live::Place place = live_.begin();
  const std::string events = take(place);
  EXPECT_THAT(events,
              StartsWith("event: health\ndata: {}\n\nevent: alarms\ndata: []\n\nevent: drive\ndata: {\"name\":"));
  for (const config::Drive& drive : model_.drives) {
    EXPECT_THAT(events, HasSubstr("event: drive\ndata: {\"name\":\"" + drive.name + "\""));
  }
  EXPECT_EQ(take(place), "") << "and is told of changes only";
}

TEST_F(HttpLive, AChangeIsToldToEachReaderOnce) {
  Live::Place one = live_.begin();
  Live::Place other = live_.begin();
  (void)take(one);
  (void)take(other);
  drives_[1]->power_off();
  loop_.advance(5s);
  const std::string events = take(one);
  EXPECT_THAT(events, AllOf(HasSubstr("event: health"), HasSubstr("event: alarms\ndata: [{\"drive\":\"pump1\""),
                            HasSubstr("{\"name\":\"pump1\"")));
  EXPECT_THAT(events, HasSubstr("\"online\":false"));
  EXPECT_EQ(take(one), "");
  EXPECT_EQ(take(other), events) << "worded once for both";
}

TEST_F(HttpLive, APieceIsBoundedAndTheRestComesNext) {
  Live::Place place = live_.begin();
  const std::string head(Live::kMostBytes, ' ');
  const std::string first = live_.take(place, [&head] { return head; });
  EXPECT_THAT(first, Not(HasSubstr("event: drive")));
  EXPECT_THAT(take(place), HasSubstr("event: drive"));
}

TEST_F(HttpLive, WhoComesLaterIsToldTheAgesOfThen) {
  drives_[1]->power_off();
  loop_.advance(5s);
  Live::Place early = live_.begin();
  (void)take(early);
  const auto stands_still = [&] {
    loop_.advance(1s);
    return take(early).find("pump1") == std::string::npos;  // an age that grows is no change
  };
  int tries = 20;
  while (!stands_still() && tries > 0) {
    --tries;
  }
  ASSERT_GT(tries, 0);
  const std::string told = text("/api/drives/pump1");
  Live::Place late = live_.begin();
  EXPECT_THAT(take(late), HasSubstr("data: " + told + "\n"));
}

// None of them is there.
config::Model model_of(std::size_t drives) {
  config::Model model = test::shown_model();
  const config::Drive like = model.drives.front();
  model.drives.clear();
  while (model.drives.size() < drives) {
    config::Drive& drive = model.drives.emplace_back(like);
    drive.name += std::to_string(model.drives.size());
    drive.node.node = static_cast<std::uint8_t>(model.drives.size());
  }
  return model;
}

TEST_F(HttpLive, AListOfAlarmsIsWordedInPieces) {
  const config::Model model = model_of(AlarmList::kOfPiece + 10);
  canopen::VirtualBus wire{loop_.executor()};
  Gateway gateway{loop_.executor(), model, [&wire](const config::Bus&) { return wire.connect(); }};
  Live live(gateway.plant());
  gateway.plant().add(live);
  gateway.start();
  ASSERT_TRUE(loop_.advance_until([&] { return gateway.plant().active_alarms().size() >= model.drives.size(); }, 60s));
  const auto next_of = [&live](Live::Place& place) { return live.take(place, [] { return std::string("{}"); }); };
  const auto alarms_in = [](const std::string& events) {
    const std::size_t begin = events.find("event: alarms\ndata: ");
    return begin == std::string::npos
               ? std::size_t{0}
               : boost::json::parse(events.substr(begin + 20, events.find('\n', begin + 20) - begin - 20))
                     .as_array()
                     .size();
  };
  Live::Place place = live.begin();
  EXPECT_EQ(next_of(place), "event: health\ndata: {}\n\n");
  EXPECT_TRUE(place.more);
  EXPECT_EQ(alarms_in(next_of(place)), gateway.plant().active_alarms().size());
  Live::Place left = live.begin();
  EXPECT_EQ(alarms_in(next_of(left)), gateway.plant().active_alarms().size()) << "it is worded already";
  const auto stopped = support::spawn(loop_.executor(), gateway.stop());
  EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, 5s));
}

TEST_F(HttpLive, APieceWordsSomeDrivesOnly) {
  const config::Model model = model_of(Live::kMostWorded + 3);
  canopen::VirtualBus wire{loop_.executor()};
  Gateway gateway{loop_.executor(), model, [&wire](const config::Bus&) { return wire.connect(); }};
  Live live(gateway.plant());
  const auto events_of = [&live](Live::Place& place) {
    const std::string events = live.take(place, [] { return std::string("{}"); });
    std::size_t count = 0;
    for (std::size_t at = events.find("event: drive"); at != std::string::npos;
         at = events.find("event: drive", at + 1)) {
      ++count;
    }
    return count;
  };
  Live::Place place = live.begin();
  EXPECT_EQ(events_of(place), Live::kMostWorded);
  EXPECT_TRUE(place.more);
  EXPECT_EQ(events_of(place), 3U);
  EXPECT_FALSE(place.more);
  Live::Place other = live.begin();
  EXPECT_EQ(events_of(other), model.drives.size()) << "they are worded already";
}

}  // namespace
}  // namespace gateway::http

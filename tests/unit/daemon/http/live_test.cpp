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

}  // namespace
}  // namespace gateway::http

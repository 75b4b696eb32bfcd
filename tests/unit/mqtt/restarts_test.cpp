// Gateway, broker and drive go and come back in every order, while the drive's fault comes, goes, stays or becomes
// another one: three seconds after the last one is back every alarm is true.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/mqtt/restart_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::RestartSite;
namespace json = boost::json;

struct System {
  std::string profile;
  std::uint16_t fault;
  std::uint16_t other;
  bool has_fault_code = false;  ///< Else only an emergency that is heard names the fault.
};

struct Change {
  std::string_view name;
  bool before;
  bool after;
  bool same;
};
constexpr std::array<Change, 5> kChanges{{{"come", false, true, true},
                                          {"gone", true, false, true},
                                          {"stays", true, true, true},
                                          {"another", true, true, false},
                                          {"never", false, false, true}}};

/// Every order of every choice of them: `g` gateway, `b` broker, `d` drive.
std::vector<std::string> orders() {
  std::vector<std::string> all;
  for (const std::string choice : {"g", "b", "d", "bg", "dg", "bd", "bdg"}) {
    std::string order = choice;
    std::sort(order.begin(), order.end());
    do {
      all.push_back(order);
    } while (std::next_permutation(order.begin(), order.end()));
  }
  return all;
}

void stop(RestartSite& site, char who) {
  who == 'g' ? site.kill_gateway() : who == 'b' ? site.stop_broker() : site.stop_drive();
}

void start(RestartSite& site, char who) {
  who == 'g' ? site.start_gateway() : who == 'b' ? site.start_broker() : site.start_drive();
}

json::value parsed(const std::string& text) {
  boost::system::error_code failure;
  json::value value = json::parse(text, failure);
  EXPECT_FALSE(failure) << "no JSON: " << text;
  return value;
}

class Restarts : public ::testing::TestWithParam<System> {
 protected:
  /// What the alarm is called where nothing restarts.
  [[nodiscard]] static std::string name_of(const std::string& profile, std::uint16_t fault) {
    RestartSite site(profile, true);
    site.set_fault(fault);
    site.run(3s);
    const json::value alarm = parsed(site.retained("pump1/alarm/emcy"));
    EXPECT_TRUE(alarm.at("active").as_bool());
    return std::string(alarm.at("text").as_string());
  }

  static void expect_truth(const RestartSite& site, bool named, const std::optional<std::string>& name,
                           const std::string& what) {
    const std::string text = site.retained("pump1/alarm/emcy");
    const json::value alarm = parsed(text);
    ASSERT_TRUE(alarm.is_object()) << what;
    EXPECT_EQ(alarm.at("active").as_bool(), name.has_value()) << what << ": " << text;
    EXPECT_TRUE(alarm.at("confirmed").as_bool()) << what << ": " << text;
    if (name && named) {
      EXPECT_EQ(std::string(alarm.at("text").as_string()), *name) << what << ": " << text;
    }
    for (const std::string other : {"heartbeat", "boot", "data", "control"}) {
      const std::string held = site.retained("pump1/alarm/" + other);
      EXPECT_FALSE(parsed(held).at("active").as_bool()) << what << ": " << held;
    }
    const std::string list = site.retained("alarms");
    EXPECT_EQ(parsed(list).as_array().size(), name ? 1U : 0U) << what << ": " << list;
    EXPECT_EQ(site.retained("status"), "online") << what;
    EXPECT_EQ(site.retained("pump1/status"), "online") << what;
  }

  void check(const std::string& order, const Change& change, bool remembers, const std::array<std::string, 2>& names) {
    const std::string what =
        order + ", fault " + std::string(change.name) + (remembers ? "" : ", without memory") + ", " + kind_.profile;
    RestartSite site(kind_.profile, remembers);
    if (change.before) {
      site.set_fault(kind_.fault);
      site.run(2s);
    }
    for (const char who : order) {
      stop(site, who);
      site.run(200ms);
    }
    const std::uint16_t after = change.same ? kind_.fault : kind_.other;
    site.set_fault(change.after ? std::optional(after) : std::nullopt);
    site.run(2s);
    for (const char who : order) {
      site.run(300ms);
      start(site, who);
    }
    site.run(3s);
    const bool named = kind_.has_fault_code || order.find('g') == std::string::npos;
    expect_truth(site, named, change.after ? std::optional(names.at(change.same ? 0 : 1)) : std::nullopt, what);
  }

  const System kind_ = GetParam();
};

TEST_P(Restarts, InEveryOrderEveryAlarmIsTrueThreeSecondsAfterTheLast) {
  const std::array<std::string, 2> names{name_of(kind_.profile, kind_.fault), name_of(kind_.profile, kind_.other)};
  ASSERT_NE(names[0], names[1]);
  for (const std::string& order : orders()) {
    for (const Change& change : kChanges) {
      for (const bool remembers : {true, false}) {
        check(order, change, remembers, names);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllSystems, Restarts,
                         ::testing::Values(System{"veichi-ac300", 0x0005, 0x0006, true},
                                           System{"veichi-ac310", 0x0005, 0x0006, true},
                                           System{"invt-goodrive600", 4, 5}, System{"vacon-opte6", 1, 2}),
                         [](const auto& test) {
                           std::string name = test.param.profile;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace mqtt

// The turn of one broker: look up its name, try its addresses, serve the connection that comes about.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/password.h"
#include "bridges/mqtt/publisher.h"
#include "bridges/mqtt/reasons.h"
#include "bridges/mqtt/tcp_connection.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

constexpr auto kLookUpCheck = 50ms;
// Beyond connect_timeout, by which Paho gives up, but not at once.
constexpr auto kPahoDelay = 2s;
// For an address, where there is another broker, which is to be in use 10 s after this one fell silent. When all were
// tried in vain they have all the time that one alone has.
constexpr auto kShortestPatience = 1000ms;
constexpr auto kLeastPatience = 250ms;
constexpr auto kLongNamePatience = 10s;
// For the name of a broker whose last addresses are known, before those are tried.
constexpr auto kKnownNamePatience = 500ms;
// Between two attempts of which the first was closed: it may be starting.
constexpr auto kBetweenCloses = 500ms;
constexpr auto kAcceptPatience = 500ms;
// For the cause why TLS fails, after an attempt that took as long as it may: it is told within 10 s.
constexpr auto kTlsPatience = 3s;
constexpr auto kTlsPatienceOfSeveral = 1s;

}  // namespace

Publisher::Turn Publisher::take_turn() {
  find_addresses_ahead(Clock::now());
  Attempts& attempts = candidate().attempts;
  if (attempts.wants_addresses()) {
    find_addresses();
  }
  const bool hurries_now = is_one_of_several() && rotation_.is_first_round();
  turn_by_ = hurries_now ? Clock::now() + settings_.turn : Clock::time_point::max();
  Turn turn{.end = {.why = candidate().addresses.is_answered()
                               ? "the name " + candidate().broker.host + " has no address"
                               : "nothing is known of its name yet"}};
  const auto goes_on = [this] { return !is_finishing() && turn_by_ - Clock::now() >= kLeastPatience; };
  while (!attempts.wants_addresses() && !turn.stood && goes_on()) {
    drop_client();
    const std::string address = attempts.next_address();
    Turn next = attempt(address);
    if (!next.stood && is_one_of_several() && attempts.is_undecided(address) && pause(kBetweenCloses) && goes_on()) {
      drop_client();
      next = attempt(address);
    }
    if (next.stood || !turn.end.stays) {
      turn = std::move(next);
    }
  }
  return turn;
}

void Publisher::find_addresses() {
  Candidate& asked = candidate();
  {
    const Guard lock(mutex_);
    expect_sign_of_life(is_one_of_several() ? settings_.silence : settings_.resolve_patience);
  }
  asked.addresses.ask();
  const bool hurries_now = is_one_of_several() && rotation_.is_first_round();
  auto end = Clock::time_point::max();
  if (is_one_of_several() || asked.addresses.can_do_without()) {
    end = Clock::now() + (hurries_now ? settings_.hurried : std::chrono::milliseconds(kLongNamePatience));
  }
  if (hurries_now && asked.addresses.can_do_without()) {
    end = Clock::now() + kKnownNamePatience;
  }
  while (!asked.addresses.is_answered(kLookUpCheck) && !is_finishing() && Clock::now() < end) {
  }
  // Where there are none, what is known of those of before stays.
  if (std::vector<std::string> to_try = asked.addresses.to_try(); !to_try.empty()) {
    asked.attempts.found(std::move(to_try));
  }
}

void Publisher::find_addresses_ahead(Clock::time_point now) {
  for (Candidate& each : candidates_) {
    if (&each != &candidate()) {
      each.addresses.ask_ahead(now);
    }
  }
}

Publisher::Turn Publisher::attempt(const std::string& address) {
  Candidate& tried = candidate();
  for (std::optional<int> version = tried.attempts.first_version(); version;) {
    const std::optional<Refusal> refusal = connect(address, *version);
    if (!refusal) {
      tell_connected(address, *version);
    }
    version = tried.attempts.next_version(address, *version, refusal);
    if (!refusal) {
      return serve();
    }
    if (!version) {
      return {.end = {.why = text_of(*refusal), .stays = refuses_credentials(refusal->code)},
              .to_mend = !refusal->why.empty()};
    }
    drop_client();
  }
  return {};
}

void Publisher::tell_connected(const std::string& address, int version) {
  const Candidate& now = candidate();
  const bool of_before = !now.broker.tls && !now.addresses.are_new();
  const std::string at = of_before || now.attempts.addresses() > 1 ? " at " + address : "";
  say(Level::info, "MQTT: connected to " + now.name + at +
                       (of_before ? ", its last known address, for nobody answers for the name" : "") +
                       (version == 5 ? ", MQTT 5" : ", MQTT 3.1.1") + (now.broker.tls ? ", TLS" : ""));
  Connected connected{.id = line_.connection, .version = version, .broker = now.name};
  if (!now.broker.tls) {
    connected.address = address;
  }
  {
    const Guard lock(mutex_);
    traffic_.at_broker(rotation_.at());
  }
  loop_->post([this, told = std::move(connected)] { events_->on_connected(told); });
}

std::optional<Refusal> Publisher::connect(const std::string& address, int version) {
  const config::Endpoint& broker = candidate().broker;
  {
    const Guard lock(mutex_);
    if (finishing_) {
      return Refusal{};
    }
    // Paho may look up a name itself, and holds up whatever else is asked of it then.
    expect_sign_of_life(broker.tls ? settings_.resolve_patience : settings_.silence);
    line_.begin();
  }
  ClientSettings settings = settings_.client;
  std::string mistake = read_password(settings_.password_file, settings.password);
  if (mistake.empty() && broker.tls) {
    mistake = tls_files_mistake(settings.tls);
  }
  if (!mistake.empty()) {
    return Refusal{.why = std::move(mistake)};
  }
  settings.uri = (broker.tls ? "ssl://" : "tcp://") + uri_host(address) + ":" + std::to_string(broker.port);
  settings.version = version;
  gate_ = std::make_unique<EventGate>(static_cast<ClientEvents&>(*this));
  client_ = std::make_unique<Client>(settings, *gate_);
  if (!client_->connect()) {
    return Refusal{};
  }
  std::optional<Refusal> refusal = await_connection(connect_patience(), version);
  if (refusal && refusal->closed && !accepts(address)) {
    refusal->closed = false;  // no broker did: of a machine far away Paho tells both alike
    refusal->nobody = true;
  }
  if (refusal && refusal->code < 0 && broker.tls) {
    if (std::string why = mistake_of_tls(); !why.empty()) {
      return Refusal{.why = std::move(why)};
    }
  }
  return refusal;
}

std::chrono::milliseconds Publisher::connect_patience() {
  const bool returns = rotation_.at() == 0 && homecoming_.is_arriving();  // which was tried before
  if (!hurries() || returns) {
    return settings_.client.connect_timeout + kPahoDelay;
  }
  if (turn_by_ == Clock::time_point::max()) {
    return settings_.hurried;
  }
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(turn_by_ - Clock::now());
  const auto share = left / static_cast<std::chrono::milliseconds::rep>(candidate().attempts.untried() + 1);
  return std::min({std::max<std::chrono::milliseconds>(share, kShortestPatience), settings_.hurried,
                   std::max<std::chrono::milliseconds>(left, kLeastPatience)});
}

bool Publisher::accepts(const std::string& address) {
  const Candidate& tried = candidate();
  const auto addresses = tried.broker.tls ? tried.addresses.known() : std::vector<std::string>{address};
  return connect_to(addresses, tried.broker.port, Clock::now() + kAcceptPatience).descriptor >= 0;
}

std::optional<Refusal> Publisher::await_connection(std::chrono::milliseconds patience, int version) {
  Lock lock(mutex_);
  wake_.wait_for(lock, patience, [this] { return line_.state != Line::State::connecting || finishing_; });
  if (!line_.stood()) {
    line_.give_up();
    return line_.refusal;
  }
  traffic_.begin(line_.limits, version, Clock::now());
  pulse_.heard(Clock::now());
  return std::nullopt;
}

std::string Publisher::mistake_of_tls() {
  if (is_finishing()) {
    return {};
  }
  return tls_mistake(candidate().broker, candidate().addresses.known(), settings_.client.tls,
                     is_one_of_several() ? kTlsPatienceOfSeveral : kTlsPatience);
}

bool Publisher::is_finishing() const {
  const Guard lock(mutex_);
  return finishing_;
}

}  // namespace mqtt

#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace mqtt::test {

/// A broker made of a few bytes, for what no real one does on demand. Serves one connection at a time.
class TinyBroker {
 public:
  struct Manners {
    bool speaks_5 = false;             ///< Else it refuses MQTT 5 as 3.1.1 prescribes.
    bool mute = false;                 ///< Accepts the connection and says nothing at all.
    int refusal = 0;                   ///< CONNACK code for everybody.
    bool closes_on_5 = false;          ///< Closes where it should refuse MQTT 5.
    bool closes_on_subscribe = false;  ///< Closes the connection instead of a SUBACK.
    std::string hates{};               ///< Closes the connection on each PUBLISH there.
    /// Takes so many of a connection; on the next it says that it shuts down, and closes. Each fourth connection it
    /// closes without a word, after half as many. 0: any number.
    std::size_t patience = 0;
    bool by_hand = false;   ///< Takes a PUBLISH only when take_one() asks for it, or take_all().
    std::size_t flood = 0;  ///< Behind a SUBACK so many messages `run`, and then one `stop`. Of 3.1.1.
  };

  explicit TinyBroker(Manners manners);
  ~TinyBroker();
  TinyBroker(const TinyBroker&) = delete;
  TinyBroker& operator=(const TinyBroker&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  /// Protocol levels of the CONNECTs seen: 5, 4.
  [[nodiscard]] std::vector<int> levels() const;
  /// How many UNSUBSCRIBEs were seen.
  [[nodiscard]] int unsubscribes() const noexcept { return unsubscribes_; }
  /// How many PINGREQs were seen.
  [[nodiscard]] int pings() const noexcept { return pings_; }
  /// `topic=payload` of every PUBLISH seen.
  [[nodiscard]] std::vector<std::string> published() const;
  /// Takes the next PUBLISH and acknowledges it; false where none comes within 20 s. Only with by_hand.
  [[nodiscard]] bool take_one();
  /// Takes whatever comes, until take_by_hand(). Only with by_hand.
  void take_all();
  void take_by_hand();
  /// Sends a PUBLISH (QoS 0) to who is connected, of less than 125 bytes.
  void deliver(const std::string& topic, const std::string& payload) const;
  /// Sends DISCONNECT with this code (MQTT 5) to who is connected, and closes the connection.
  void disconnect(int code) { kick_ = code; }
  /// The client has acknowledged the last message of the flood. Once.
  [[nodiscard]] std::future<void> flood_taken() { return flood_taken_.get_future(); }

 private:
  void serve();
  void serve_client(int client);
  /// False: this packet ends the connection.
  bool answer(int client, std::uint8_t type, const std::vector<std::uint8_t>& body);
  bool answer_connect(int client, const std::vector<std::uint8_t>& body);
  void flood(int client) const;
  bool take_publish(int client, std::uint8_t type, const std::vector<std::uint8_t>& body);

  Manners manners_;
  int server_;
  std::uint16_t port_ = 0;
  std::atomic<bool> stopping_ = false;
  std::atomic<int> kick_ = 0;
  std::atomic<int> level_ = 0;  ///< Of the connection.
  std::size_t taken_ = 0;       ///< Likewise.
  std::atomic<int> unsubscribes_ = 0;
  std::atomic<int> pings_ = 0;
  std::atomic<int> connected_ = 0;  ///< The socket of the connection.
  mutable std::mutex mutex_;
  std::vector<int> levels_;
  std::vector<std::string> published_;
  std::size_t may_take_ = 0;        ///< With by_hand, since the start.
  std::condition_variable taking_;  ///< Of may_take_ and published_.
  std::promise<void> flood_taken_;
  std::thread thread_;
};

}  // namespace mqtt::test

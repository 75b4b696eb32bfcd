#pragma once

#include <string>

// The parts of the benchmark. Each prints its ratios; throws std::runtime_error where it cannot measure.

namespace bench {

/// Frames per second from a SocketCAN interface to the process image, against a bare recvmmsg loop.
void frames(const std::string& interface);
/// Time a frame takes from the link to the process image, with one, two and four buses of 126 drives each.
void buses();
/// What the survey of a bus of 126 drives adds to a frame on that way.
void survey();
/// The same time with one bus, with and without the recorder.
void recorder();
/// Requests per second with 1 and 8 clients, against a bare libmodbus reply loop.
void modbus();
/// Messages per second at a subscriber, against bare Paho publishing the same messages.
void mqtt();
/// Time from a frame on the in-process bus to a subscriber, at 1000 frames a second and idle.
void latency();
/// Round trips of Modbus reads and set-points beside a storm of emergencies, against those just before it.
void storm();
/// Round trips of Modbus reads with slow readers of the live stream, of the trace and of the control socket's trace,
/// against those without, beside a full bus.
void readers();

}  // namespace bench

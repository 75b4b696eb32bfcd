#include <cstdio>
#include <exception>
#include <string_view>

#include "tests/bench/parts.h"

// gateway_bench modbus | mqtt | latency | storm | readers | buses | survey | recorder | frames INTERFACE
int main(int argc, char** argv) {
  const std::string_view part = argc > 1 ? argv[1] : "";
  try {
    if (part == "modbus" && argc == 2) {
      bench::modbus();
    } else if (part == "mqtt" && argc == 2) {
      bench::mqtt();
    } else if (part == "latency" && argc == 2) {
      bench::latency();
    } else if (part == "storm" && argc == 2) {
      bench::storm();
    } else if (part == "readers" && argc == 2) {
      bench::readers();
    } else if (part == "buses" && argc == 2) {
      bench::buses();
    } else if (part == "survey" && argc == 2) {
      bench::survey();
    } else if (part == "recorder" && argc == 2) {
      bench::recorder();
    } else if (part == "frames" && argc == 3) {
      bench::frames(argv[2]);
    } else {
      std::fputs(
          "usage: gateway_bench modbus | mqtt | latency | storm | readers | buses | survey | recorder | frames "
          "INTERFACE\n",
          stderr);
      return 2;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gateway_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}

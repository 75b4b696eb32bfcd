// Paho C 1.3.12 leaks some commands and their tokens when a connection breaks with work under way. What our own code
// leaks is still told.
extern "C" const char* __lsan_default_suppressions();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libpaho-mqtt3as\n";
}

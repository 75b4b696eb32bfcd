# Everything that comes from outside, all of it Debian 12 packages (scripts/install-packages installs them).
# Imported targets are SYSTEM includes: our warnings do not look into them.
#   deps::asio     Boost.Asio, compiled once        Boost::json   deps::metrics   deps::modbus   deps::paho   spdlog::spdlog
#   tomlplusplus::tomlplusplus   CLI11::CLI11   deps::systemd   deps::crypto   deps::ssl   GTest::gtest_main GTest::gmock   benchmark::benchmark
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Boost 1.81 REQUIRED CONFIG COMPONENTS json)
find_package(spdlog 1.10 REQUIRED CONFIG)
find_package(tomlplusplus 3.3 REQUIRED CONFIG)
find_package(CLI11 2.1 REQUIRED CONFIG)
find_package(PahoMqttCpp REQUIRED CONFIG)
pkg_check_modules(metrics REQUIRED IMPORTED_TARGET prometheus-cpp-core>=1.0)
pkg_check_modules(modbus REQUIRED IMPORTED_TARGET libmodbus>=3.1.6)
pkg_check_modules(systemd REQUIRED IMPORTED_TARGET libsystemd)
pkg_check_modules(crypto REQUIRED IMPORTED_TARGET libcrypto>=3.0)
pkg_check_modules(ssl REQUIRED IMPORTED_TARGET libssl>=3.0)
add_library(deps::metrics ALIAS PkgConfig::metrics)
add_library(deps::modbus ALIAS PkgConfig::modbus)
add_library(deps::systemd ALIAS PkgConfig::systemd)
add_library(deps::crypto ALIAS PkgConfig::crypto)
add_library(deps::ssl ALIAS PkgConfig::ssl)
add_library(deps::paho ALIAS PahoMqttCpp::paho-mqttpp3)

# Asio's own sources are compiled once instead of in every file that includes it.
add_library(asio STATIC "${CMAKE_CURRENT_LIST_DIR}/asio.cpp")
target_compile_features(asio PUBLIC cxx_std_20)
target_compile_definitions(asio PUBLIC BOOST_ASIO_SEPARATE_COMPILATION BOOST_ASIO_NO_DEPRECATED)
target_link_libraries(asio PUBLIC Boost::headers Threads::Threads)
# g++ 12 inlines one of the two sides of Asio's own coroutine allocator and then calls the pair mismatched: a false alarm
# about Asio's code, raised in every optimised file with a coroutine it happens to do that in.
target_compile_options(asio PUBLIC $<$<CXX_COMPILER_ID:GNU>:-Wno-mismatched-new-delete>)
add_library(deps::asio ALIAS asio)

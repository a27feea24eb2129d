# The real server under kill -9.
fascicle_test(server_kill_test SOURCES server_kill_test.cc DEPS fascicle_service_fixture TIMEOUT 300)
add_dependencies(server_kill_test fascicled)

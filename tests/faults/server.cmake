# The real server under kill -9.
fascicle_test(server_kill_test SOURCES server_kill_test.cc DEPS fascicle_service_fixture TIMEOUT 300)
add_dependencies(server_kill_test fascicled)
# Damaged data behind the service.
fascicle_test(damage_service_test SOURCES damage_service_test.cc DEPS fascicle_service_fixture server/store TIMEOUT 180)
# Busy with solving and streaming.
fascicle_test(busy_server_test SOURCES busy_server_test.cc DEPS fascicle_service_fixture TIMEOUT 600)
add_dependencies(busy_server_test fascicled)

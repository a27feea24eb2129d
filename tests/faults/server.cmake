# The real server under kill -9.
fascicle_test(server_kill_test SOURCES server_kill_test.cc DEPS fascicle_service_fixture TIMEOUT 300)
add_dependencies(server_kill_test fascicled)
# The same at named calls on files. A preloaded library has no place before that of the address sanitizer.
if(NOT FASCICLE_SANITIZE)
  add_library(fail_at SHARED fail_at.cc)
  target_link_libraries(fail_at PRIVATE fascicle_settings)
  fascicle_test(failpoint_test SOURCES failpoint_test.cc DEPS fascicle_service_fixture TIMEOUT 300)
  target_compile_definitions(failpoint_test PRIVATE FAIL_AT_LIBRARY="$<TARGET_FILE:fail_at>")
  add_dependencies(failpoint_test fascicled fail_at)
endif()
# Damaged data behind the service.
fascicle_test(damage_service_test SOURCES damage_service_test.cc DEPS fascicle_service_fixture server/store TIMEOUT 180)
# Busy with solving and streaming.
fascicle_test(busy_server_test SOURCES busy_server_test.cc DEPS fascicle_service_fixture TIMEOUT 600)
add_dependencies(busy_server_test fascicled)
# Under attack.
fascicle_test(hostile_test SOURCES hostile_test.cc DEPS fascicle_service_fixture TIMEOUT 600)
add_dependencies(hostile_test fascicled)
# Cut streams and lost replies.
fascicle_test(stream_contract_test SOURCES stream_contract_test.cc DEPS fascicle_service_fixture TIMEOUT 900)
add_dependencies(stream_contract_test fascicled)
# Mixed use for a long time.
fascicle_test(soak_test SOURCES soak_test.cc DEPS fascicle_service_fixture LABELS slow TIMEOUT 6000)
add_dependencies(soak_test fascicled)

# Steered jobs under kill -9.
fascicle_test(steering_kill_test SOURCES steering_kill_test.cc DEPS fascicle_service_fixture TIMEOUT 300)
add_dependencies(steering_kill_test fascicled fascicle)

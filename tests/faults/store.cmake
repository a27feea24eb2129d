# The store under kill -9.
add_executable(store_crash_writer store_crash_writer.cc lossy_disk.cc)
target_link_libraries(store_crash_writer PRIVATE fascicle_settings Threads::Threads SQLite::SQLite3)
fascicle_link(store_crash_writer PRIVATE tests/support server/store)

fascicle_test(store_crash_test SOURCES store_crash_test.cc DEPS server/store TIMEOUT 180)
add_dependencies(store_crash_test store_crash_writer)

# A flipped bit anywhere in a data folder.
fascicle_test(bit_flip_test SOURCES bit_flip_test.cc DEPS server/store core/base TIMEOUT 180)

# The store when the power fails.
fascicle_test(power_loss_test SOURCES power_loss_test.cc DEPS server/store TIMEOUT 180)
add_dependencies(power_loss_test store_crash_writer)

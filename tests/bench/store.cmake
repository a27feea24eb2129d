# The store: frames in and out, submissions against raw SQLite.
add_executable(store_bench ${CMAKE_CURRENT_LIST_DIR}/store_bench.cc)
target_link_libraries(store_bench PRIVATE fascicle_settings SQLite::SQLite3 Threads::Threads)
fascicle_link(store_bench PRIVATE server/store tests/store)

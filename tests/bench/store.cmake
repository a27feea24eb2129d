# The store: frames in and out, submissions against raw SQLite.
fascicle_bench(store_bench SOURCES store_bench.cc DEPS server/store SQLite::SQLite3 Threads::Threads)
# Submissions over gRPC against raw SQLite.
fascicle_bench(submit_bench SOURCES submit_bench.cc
               DEPS fascicle_service_fixture GTest::gtest SQLite::SQLite3 Threads::Threads)

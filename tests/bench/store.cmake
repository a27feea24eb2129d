# The store: frames in and out, submissions against raw SQLite.
fascicle_bench(store_bench SOURCES store_bench.cc DEPS server/store SQLite::SQLite3 Threads::Threads)

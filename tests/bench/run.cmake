# What the service costs: the same scene through an embedded server and a watching client, and through the core alone.
fascicle_bench(run_vs_core SOURCES run_vs_core.cc DEPS client/lib core/base core/sim server/translate
               fascicle_server_embedded)

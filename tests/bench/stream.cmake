# Streaming stored frames against a raw gRPC stream, and a unary call against a raw echo.
fascicle_bench(stream_bench SOURCES stream_bench.cc
               DEPS server/rpc server/jobs server/store server/translate core/base proto spdlog::spdlog)

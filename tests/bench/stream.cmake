# Streaming stored frames against a raw gRPC stream, and a unary call against a raw echo.
add_executable(stream_bench ${CMAKE_CURRENT_LIST_DIR}/stream_bench.cc)
target_link_libraries(stream_bench PRIVATE fascicle_settings spdlog::spdlog)
fascicle_link(stream_bench PRIVATE server/rpc server/jobs server/store server/translate core/base proto)

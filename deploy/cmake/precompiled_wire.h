// Headers that nearly every source with wire messages includes; see fascicle_settings.cmake.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/grpcpp.h>

#include "fascicle/v1/simulation_service.grpc.pb.h"

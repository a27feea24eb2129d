fascicle_fuzz(wire_fuzz SOURCES wire_fuzz.cc DEPS client/lib server/rpc core/base proto)

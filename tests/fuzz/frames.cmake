fascicle_fuzz(frames_fuzz SOURCES frames_fuzz.cc DEPS proto/frames core/base)

fascicle_fuzz(volume_fuzz SOURCES volume_fuzz.cc DEPS core/imaging core/base)

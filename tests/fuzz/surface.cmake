fascicle_fuzz(surface_fuzz SOURCES surface_fuzz.cc DEPS core/geometry)

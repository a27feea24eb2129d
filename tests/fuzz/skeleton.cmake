fascicle_fuzz(skeleton_fuzz SOURCES skeleton_fuzz.cc DEPS client/import core/skeleton proto/rules)

fascicle_fuzz(scene_fuzz SOURCES scene_fuzz.cc DEPS client/lib server/translate)

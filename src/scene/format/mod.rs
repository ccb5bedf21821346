//! Scenes from files: Mitsuba 3 XML, Wavefront OBJ, PLY.

// Only with sanitizers: OpenGL drivers stay loaded, or else what they still hold when they are
// unloaded counts as leaked, by nobody that a report could name.

extern "C" int dlclose(void* /*library*/) { return 0; }

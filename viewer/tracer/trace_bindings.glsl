// The bindings of both kernels.
#ifndef XRDS_TRACE_BINDINGS_GLSL
#define XRDS_TRACE_BINDINGS_GLSL
#include "viewer/tracer/trace_parameters.h"

layout(local_size_x = kTraceGroupWidth, local_size_y = kTraceGroupHeight) in;
layout(push_constant) uniform Push { TraceParams p; };
layout(binding = 0) uniform samplerBuffer nodes;
layout(binding = 1) uniform samplerBuffer triangles;
layout(binding = 2) uniform samplerBuffer materials;
layout(binding = 3) uniform samplerBuffer textures;
layout(binding = 4) uniform samplerBuffer sky;
layout(binding = 5) uniform samplerBuffer lights;
layout(binding = 6) uniform samplerBuffer energy;
layout(binding = 7) uniform samplerBuffer view;
layout(binding = 8, std430) buffer Sums { vec4 sums[]; };
layout(binding = 9, std430) writeonly buffer Picture { vec4 picture[]; };

#endif

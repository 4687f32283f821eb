// activate(kind, v): the activations of activation.h on four channels; `kind` is a specialization constant.
#ifndef XRDS_SHADERS_COMMON_ACTIVATION_GLSL
#define XRDS_SHADERS_COMMON_ACTIVATION_GLSL
#include "shaders/common/activation.h"

// erf as an odd rational function, fitted for the least largest error: |error| < 2e-7 in fp32, beyond the bound it is 1
// to 6e-8. No exp, which costs a CPU device more than all of this.
vec4 erf4(vec4 x) {
  const vec4 v = clamp(x, -3.83, 3.83), t = v * v;
  const vec4 above = 1.12837906 + t * (0.189212023 + t * (5.26647689e-2 +
                     t * (3.7341389e-3 + t * (2.87726977e-4 + t * 2.10705741e-6))));
  const vec4 below = 1.0 + t * (0.501016916 + t * (0.113683119 +
                     t * (1.49036896e-2 + t * (1.16146468e-3 + t * 3.88269287e-5))));
  return v * above / below;
}

vec4 activate(uint kind, vec4 v) {
  if (kind == kActivationRelu) return max(v, 0.0);
  if (kind == kActivationLeakyRelu) return max(v, 0.01 * v);
  if (kind == kActivationGelu) return 0.5 * v * (1.0 + erf4(v * 0.70710678118654752));
  return v;
}

#endif
